"""gemheads: live photoreal 3D heads (Gaussian Eigen Models) driven by a face in a video, offline.

The repository root is the package; the layers are ``app`` -> ``models`` -> ``render`` (see pyproject.toml).
"""

import os

__version__ = "0.1.0"

# onnxruntime 1.31 writes a device id into the home folder and reports to its maker; this is read when it is loaded.
os.environ["ORT_DISABLE_TELEMETRY"] = "1"
# A picture of kilobytes may claim gigabytes; this many pixels, 8192 x 8192, are decoded. OpenCV reads it when loaded.
os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", str(2**26))
