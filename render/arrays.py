"""What arrays hold, as annotations say it; what shape they have, docstrings do."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating]
"""Of any precision."""
Floats32 = NDArray[np.float32]
Floats64 = NDArray[np.float64]
Indices = NDArray[np.int64]
Image = NDArray[np.uint8]
"""A picture in bytes, sRGB."""
