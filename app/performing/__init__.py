"""A performance as it goes on: who plays, from a delivered picture to a shot, and what the machine can bear."""
