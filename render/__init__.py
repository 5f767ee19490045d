"""Splats and a camera in, pixels out."""

from .vectors import widen

widen()
