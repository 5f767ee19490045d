"""The constants that every engine shares (docs/conventions.md)."""

import numpy as np

DILATION = np.float32(0.3)
"""Added to both diagonal entries of a splat's covariance in the picture, square pixels."""
ALPHA_MAX = np.float32(0.99)
"""No splat hides all that is behind it."""
ALPHA_MIN = np.float32(1 / 255)
"""Contributions under this are skipped; it also bounds a splat's extent."""
TRANSMITTANCE_MIN = np.float32(1e-4)
"""Front to back, nothing is drawn behind this little light."""
NEAR = np.float32(0.01)
"""Splats nearer to the camera's plane than this are left out, metres."""
POSITION_MAX = np.float32(1e4)
"""Centres beyond this in any coordinate are refused, metres."""
LOG_SCALE_MIN, LOG_SCALE_MAX = np.float32(-20), np.float32(5)
"""Log scales outside are refused."""
VIEW_MARGIN = np.float32(0.15)
"""The slope of a splat's line of sight is clamped to the picture widened by this fraction of its size on every side
when the projection is linearised (as the 3DGS reference does)."""
