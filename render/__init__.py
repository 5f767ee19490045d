"""Splats and a camera in, pixels out."""
