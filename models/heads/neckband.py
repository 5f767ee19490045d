"""The T-shirt's neckband: small splats along the neckline, where the large ones of cloth and skin meet raggedly."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .collar import collar_height, level_line
from .shading import EXPOSURE, Shader, cloth, tone
from .skin import points_of
from .soup import SKIN
from .splats import Rider, joined, ride

ROWS = (-5.2e-3, -3.7e-3, -2.2e-3, -0.7e-3, 0.8e-3)
"""Metres above the neckline, along the skin, at which the band's rows lie; every other is shifted by half a step."""
STEP = 4.0e-3
"""Metres from one splat of a row to the next."""
SIGMA = np.array([2.7e-3, 1.0e-3, 0.15e-3])
"""Along the neckline, across it, and of the cloth's thickness, metres."""
LIFT = 0.8e-3
"""Metres that the band stands off the skin."""
SEAM = 0.72
"""What is left of the light in the seam, the lowest row."""


def neckband_rider(shader: Shader, seen: NDArray[np.bool_]) -> Rider:
    """The band on those skin triangles that are ``seen`` [F]."""
    head = shader.head
    faces = np.flatnonzero(seen & (head.parts == SKIN))
    corners = head.vertices[head.triangles[faces]].astype(float)
    heights = collar_height(corners.reshape(-1, 3)).reshape(-1, 3)
    rows = []
    for number, height in enumerate(ROWS):
        chosen, weights, along = level_line(corners, heights, STEP, shift=0.5 * (number % 2))
        face = faces[chosen]
        triangle = head.triangles[face]
        weights = weights + _weights_up(corners[chosen], heights[chosen], along, height)
        _, canvas, _ = points_of(head, face, weights)
        light = (shader.light[triangle] * weights[..., None]).sum(1)
        color = tone(EXPOSURE * cloth(shader.person, canvas) * light * (SEAM if number == 0 else 1))
        rows.append(
            ride(
                head.vertices,
                triangle,
                weights,
                along,
                np.tile(SIGMA, (len(face), 1)),
                np.full(len(face), 0.98),
                color,
                np.full(len(face), SKIN),
                lift=LIFT,
            )
        )
    return joined(rows)


def _weights_up(corners: Floats, heights: Floats, along: Floats, distance: float) -> Floats:
    """What to add to barycentric weights [N, 3] to move ``distance`` up in the planes of triangles [N, 3, 3], at right
    angles to the unit vectors ``along`` [N, 3] in them; points may leave their triangles."""
    e1, e2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(e1, e2)
    across = np.cross(normal / np.linalg.norm(normal, axis=1, keepdims=True), along)
    g11, g12, g22 = (e1 * e1).sum(1), (e1 * e2).sum(1), (e2 * e2).sum(1)
    p, q = (across * e1).sum(1), (across * e2).sum(1)
    det = g11 * g22 - g12**2
    v, w = (p * g22 - q * g12) / det, (q * g11 - p * g12) / det
    rises = (heights[:, 1] - heights[:, 0]) * v + (heights[:, 2] - heights[:, 0]) * w > 0
    step = np.where(rises, distance, -distance)[:, None]
    return step * np.stack([-v - w, v, w], 1)
