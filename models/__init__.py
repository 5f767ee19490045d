"""Everything that produces splats: the GEM, its file, its driver, and how they are made."""

from .. import render as render  # it says how numba shall compile, before anything here is compiled
