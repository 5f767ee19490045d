"""Avatars of other programs: one file per format, each giving frames of RawGaussians in the canonical space."""
