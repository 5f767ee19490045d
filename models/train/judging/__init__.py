"""How far an avatar's pictures are from held-out ones, by every metric, on all processes, to be gone on with."""
