"""Colours that make the splats look like the mesh: the picture is linear in them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import sparse

from ...render.arrays import Floats
from ...render.camera import Camera, orbit
from ...render.gaussians import RawGaussians, activate
from ...render.projection import ALPHA_MAX, ALPHA_MIN, DILATION
from ...render.rotations import matrix_from_wxyz
from ..captures.meshview import see
from .expressions import weights_of
from .performance import gaze
from .shading import Shader
from .soup import EYES, SKIN, TEETH, TONGUE
from .splats import Rider, posed

STEP = 1.6
"""Over-relaxation of the diagonal-preconditioned descent."""
PRIOR = 1.0
"""Pixels that speak for the colour a splat had before. What the views hardly see would take on any colour to mend a
trace of somebody else's mistake."""


@dataclass(frozen=True)
class View:
    """One picture of the mesh to be matched."""

    raw: RawGaussians
    camera: Camera
    target: NDArray[np.float32]
    """[H, W, 3]"""
    covered: NDArray[np.bool_]
    """[H, W] where the mesh is."""


def views_of(shader: Shader, rider: Rider, size: int = 400, supersample: int = 2) -> list[View]:
    """Pictures of the surfaces, without strands, from all around and in telling expressions."""
    smile = weights_of(mouthSmile=0.9, jawOpen=0.18, mouthUpperUp=0.6, mouthLowerDown=0.4)
    shots: list[tuple[Floats, float, float, float]] = [
        (weights_of(), yaw, pitch, 19)
        for yaw, pitch in ((0, 0), (25, 8), (-25, -8), (50, 0), (-50, 0), (90, 0), (-90, 0))
    ]
    shots += [(weights_of(), yaw, pitch, 9) for yaw, pitch in ((0, 0), (20, -12), (-20, 12))]
    shots += [(weights_of(eyeBlink=1), yaw, 0, 9) for yaw in (0, 18)]
    # what lies behind the lids at rest comes out when the eyes turn or widen
    shots += [
        (gaze(*toward), 0, 0, 9) for toward in ((-0.9, 0), (0.9, 0), (0, 0.9), (0, -0.9), (-0.6, 0.6), (0.6, -0.6))
    ]
    shots += [(weights_of(eyeWide=1) + gaze(0, up), 0, 0, 9) for up in (0, -0.5)]
    shots += [(smile, yaw, 0, 9) for yaw in (0, 25, -25)]
    shots += [(weights_of(jawOpen=0.8), yaw, pitch, 9) for yaw, pitch in ((0, 0), (-20, -8), (20, 10))]
    views = []
    head = shader.head
    solid = np.flatnonzero(np.isin(head.parts, (SKIN, EYES, TEETH, TONGUE)))
    middle = (head.eye_centers.mean(0) + np.array([0, -0.035, -0.05])).tolist()
    fine = size * supersample
    for weights, yaw, pitch, fov in shots:
        vertices = head.pose(weights)
        seen, where, _ = see(vertices, head.triangles[solid], orbit(middle, 1.1, yaw, pitch, fov, fine, fine))
        hit = seen >= 0
        picture = np.zeros((fine, fine, 4), np.float32)
        picture[hit, :3] = shader.color(solid[seen[hit]], where[hit].astype(float))
        picture[hit, 3] = 1
        picture = picture.reshape(size, supersample, size, supersample, 4).mean((1, 3))
        views.append(
            View(
                posed(rider, vertices),
                orbit(middle, 1.1, yaw, pitch, fov, size, size),
                picture[..., :3],
                picture[..., 3] > 0.999,
            )
        )
    return views


def refined(colors: Floats, views: Sequence[View], reach: Floats, steps: int = 8) -> NDArray[np.float32]:
    """Colours [N, 3] after ``steps`` of c += STEP (W^T residual + PRIOR (c_0 - c)) / (W^T 1 + PRIOR), W the splats'
    weights in all views.

    No colour ends further than ``reach`` [N] from where it began.
    """
    colors = colors.astype(np.float64)
    before = colors.copy()
    low, high = np.clip(colors - reach[:, None], 0, 1), np.clip(colors + reach[:, None], 0, 1)
    blends = [_weights(view) for view in views]
    targets = [view.target[view.covered].astype(np.float64) for view in views]
    mass = np.sum([np.asarray(blend.sum(0)).ravel() for blend in blends], axis=0)
    for _ in range(steps):
        push = PRIOR * (before - colors)
        for blend, target in zip(blends, targets, strict=True):
            push += blend.T @ (target - blend @ colors)
        colors = np.clip(colors + STEP * push / (mass[:, None] + PRIOR), low, high)
    return colors.astype(np.float32)


def _weights(view: View) -> sparse.csr_matrix:
    """[covered pixels, N] how much of each splat's colour each pixel shows (EWA, blended front to back)."""
    camera, splats = view.camera, activate(view.raw)
    rotation = camera.world_to_camera[:3, :3]
    points = splats.positions @ rotation.T + camera.world_to_camera[:3, 3]
    x, y, z = points.T
    axes = rotation @ (matrix_from_wxyz(splats.wxyz) * splats.scales[:, None, :])
    across = camera.fx * (axes[:, 0] / z[:, None] - axes[:, 2] * (x / z**2)[:, None])
    down = camera.fy * (axes[:, 1] / z[:, None] - axes[:, 2] * (y / z**2)[:, None])
    a, b, c = (across**2).sum(1) + DILATION, (across * down).sum(1), (down**2).sum(1) + DILATION
    det = a * c - b * b
    reach = np.sqrt(2 * np.log(np.maximum(splats.opacities / ALPHA_MIN, 1)))
    center = np.stack([camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy], 1)
    inverse = np.stack([c / det, -b / det, a / det], 1)
    half = np.stack([reach * np.sqrt(a), reach * np.sqrt(c)], 1)
    order = np.argsort(z, kind="stable")
    pixel = np.where(view.covered, np.cumsum(view.covered).reshape(view.covered.shape) - 1, -1)
    room = int((4 * half[:, 0] * half[:, 1] + 2 * half.sum(1) + 4).sum())
    rows, columns, values = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room, np.float32)
    used = _list(order, center, inverse, half, splats.opacities, pixel, rows, columns, values)
    shape = (int(view.covered.sum()), len(order))
    return sparse.csr_matrix((values[:used], (rows[:used], columns[:used])), shape=shape)


@njit(cache=True)
def _list(order, center, inverse, half, opacity, pixel, rows, columns, values):
    height, width = pixel.shape
    clear = np.ones((height, width))
    used = 0
    for i in order:
        left, right = max(0, int(center[i, 0] - half[i, 0])), min(width, int(center[i, 0] + half[i, 0]) + 1)
        for row in range(max(0, int(center[i, 1] - half[i, 1])), min(height, int(center[i, 1] + half[i, 1]) + 1)):
            for column in range(left, right):
                if clear[row, column] < 2e-3:
                    continue
                dx, dy = column + 0.5 - center[i, 0], row + 0.5 - center[i, 1]
                power = inverse[i, 0] * dx * dx + 2 * inverse[i, 1] * dx * dy + inverse[i, 2] * dy * dy
                alpha = min(ALPHA_MAX, opacity[i] * np.exp(-0.5 * power))
                if alpha < ALPHA_MIN:
                    continue
                weight = alpha * clear[row, column]
                clear[row, column] -= weight
                if pixel[row, column] >= 0:
                    rows[used], columns[used], values[used] = pixel[row, column], i, weight
                    used += 1
    return used
