"""``gemheads evaluate``: who is judged, on which pictures, driven by whom, and how steady that is."""
