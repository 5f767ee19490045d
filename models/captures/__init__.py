"""Multi-view captures on disk: the folder's layout, reading it with every fault named, and writing it."""
