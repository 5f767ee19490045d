"""An avatar learned from a capture: the paper's UV-space CNN and its rivals, their training, and the run's folder."""
