"""Who drives: a face followed, its rest found and kept, and what makes it hard to follow."""
