"""Whose face a result shows: its badge, and content credentials (C2PA), signed offline with this computer's key."""
