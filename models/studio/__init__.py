"""A synthetic multi-view performance: a subject, a ring of cameras, light, and what the tracker would say."""
