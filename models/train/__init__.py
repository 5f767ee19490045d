"""How models are learned (needs the extra ``gemheads[train]``: torch)."""
