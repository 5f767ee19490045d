"""Whose face a result shows: the badge in its corner, and content credentials (C2PA), signed offline with a key of this computer."""
