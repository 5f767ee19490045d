"""Everything that produces splats: the GEM, its file, its driver, and how they are made."""
