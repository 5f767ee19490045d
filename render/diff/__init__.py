"""Splatting that gradients flow through: the picture of the other engines, for training and fitting. Needs torch."""

import os

# Before torch comes: its idle threads and those of the kernels would spin against each other (31 -> 205 ms a step).
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
