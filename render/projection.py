"""The constants that every engine shares (docs/conventions.md), and the projection itself in float64."""

import numpy as np
from numpy.typing import NDArray

from .camera import Camera
from .gaussians import Gaussians
from .rotations import matrix_from_wxyz

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


def project(
    gaussians: Gaussians, camera: Camera
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """EWA projection (Zwicker et al. 2001, as 3DGS does it).

    Returns:
        Centres [N, 2] in pixels, covariances [N, 2, 2] in square pixels with DILATION added, depths [N] in metres.
        Splats behind NEAR get their depth and otherwise numbers without meaning.
    """
    turn, shift = camera.world_to_camera[:3, :3], camera.world_to_camera[:3, 3]
    x, y, depth = (np.asarray(gaussians.positions, np.float64) @ turn.T + shift).T
    z = np.maximum(depth, NEAR)
    focal = np.array([camera.fx, camera.fy])
    principal = np.array([camera.cx, camera.cy])
    size = np.array([camera.width, camera.height])
    slopes = np.stack([x / z, y / z], -1)
    margin = float(VIEW_MARGIN)
    bounded = np.clip(slopes, (-margin * size - principal) / focal, ((1 + margin) * size - principal) / focal)
    jacobian = np.zeros((len(z), 2, 3))
    jacobian[:, 0, 0], jacobian[:, 1, 1] = camera.fx / z, camera.fy / z
    jacobian[:, :, 2] = -focal * bounded / z[:, None]
    axes = matrix_from_wxyz(np.asarray(gaussians.wxyz, np.float64)) * np.asarray(gaussians.scales, np.float64)[:, None]
    flat = jacobian @ turn @ axes
    return focal * slopes + principal, flat @ flat.transpose(0, 2, 1) + float(DILATION) * np.eye(2), depth
