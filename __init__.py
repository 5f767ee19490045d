"""gemheads: live photoreal 3D heads (Gaussian Eigen Models) driven by a face in a video, offline.

The repository root is the package; the layers are ``app`` -> ``models`` -> ``render`` (see pyproject.toml).
"""

__version__ = "0.1.0"
