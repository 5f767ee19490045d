"""What a subject's file agrees on: subject.py writes it, the studio reads it."""

DELTA_M = 1e-5
"""Metres of one unit of the stored shapes."""
SHEEN_RANGE = 2.0
"""What 255 means in the map of sheen."""
EYES_PART_U = 0.478
"""The person's left eye lies in the map where u is larger, the right one where it is smaller."""
