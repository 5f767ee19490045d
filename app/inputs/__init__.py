"""Live sources: cameras, players of videos, pictures and tracks, and face data over the network."""
