"""A performance: who plays, what is done at each moment, kept or shown, and how fast that has to go."""
