"""Splatting that gradients flow through: the picture of the other engines, for training and fitting. Needs torch."""
