"""Driving people never seen: an avatar repeats a clip of a stranger, and what is read off both is compared."""
