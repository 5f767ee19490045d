"""Colours that make the splats look like the mesh: the picture is linear in them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...render.camera import Camera, orbit
from ...render.gaussians import RawGaussians, activate
from ...render.rotations import matrix_from_wxyz
from .expressions import weights_of
from .head import EYES, SKIN, TEETH, TONGUE
from .meshview import see
from .shading import Shader
from .splats import Rider, posed

Floats = NDArray[np.floating]

STEP = 1.6
"""Over-relaxation of the diagonal-preconditioned descent."""
ALPHA_LEAST = 1 / 255


@dataclass(frozen=True)
class View:
    """One picture of the mesh to be matched."""

    raw: RawGaussians
    camera: Camera
    target: NDArray[np.float32]
    """[H, W, 3]"""
    covered: NDArray[np.bool_]
    """[H, W] where the mesh is."""


def views_of(shader: Shader, rider: Rider, size: int = 512, supersample: int = 2) -> list[View]:
    """Pictures of the surfaces, without strands, from all around and in telling expressions."""
    smile = weights_of(mouthSmile=0.9, jawOpen=0.18, mouthUpperUp=0.6, mouthLowerDown=0.4)
    shots: list[tuple[Floats, float, float, float]] = [
        (weights_of(), yaw, pitch, 19) for yaw, pitch in ((0, 0), (25, 8), (-25, -8), (50, 0), (-50, 0), (90, 0), (-90, 0))
    ]
    shots += [(weights_of(), yaw, pitch, 9) for yaw, pitch in ((0, 0), (20, -12), (-20, 12))]
    shots += [(weights_of(eyeBlink=1), yaw, 0, 9) for yaw in (0, 18)]
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


def refined(colors: Floats, views: Sequence[View], steps: int = 8) -> NDArray[np.float32]:
    """Colours [N, 3] after ``steps`` of c += 1.6 W^T residual / W^T 1, W the splats' weights in all views."""
    colors = colors.astype(np.float64)
    plans = [_plan(view.raw, view.camera) for view in views]
    for _ in range(steps):
        push = np.zeros_like(colors)
        mass = np.zeros(len(colors))
        for view, plan in zip(views, plans, strict=True):
            picture = _blend(*plan, colors, *view.covered.shape)
            residual = np.where(view.covered[..., None], view.target - picture, 0)
            _gather(*plan, residual, view.covered, push, mass)
        seen = mass > 1e-3
        colors[seen] = np.clip(colors[seen] + STEP * push[seen] / mass[seen, None], 0, 1)
    return colors.astype(np.float32)


def _plan(raw: RawGaussians, camera: Camera) -> tuple[NDArray[np.int64], Floats, Floats, Floats, Floats]:
    """Order front to back, centres, inverse covariances, half sizes, opacities of the splats on the picture (EWA)."""
    splats = activate(raw)
    rotation = camera.world_to_camera[:3, :3]
    points = splats.positions @ rotation.T + camera.world_to_camera[:3, 3]
    x, y, z = points.T
    axes = rotation @ (matrix_from_wxyz(splats.wxyz) * splats.scales[:, None, :])
    across = camera.fx * (axes[:, 0] / z[:, None] - axes[:, 2] * (x / z**2)[:, None])
    down = camera.fy * (axes[:, 1] / z[:, None] - axes[:, 2] * (y / z**2)[:, None])
    a, b, c = (across**2).sum(1) + 0.3, (across * down).sum(1), (down**2).sum(1) + 0.3
    det = a * c - b * b
    reach = np.sqrt(2 * np.log(np.maximum(splats.opacities / ALPHA_LEAST, 1)))
    center = np.stack([camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy], 1)
    inverse = np.stack([c / det, -b / det, a / det], 1)
    half = np.stack([reach * np.sqrt(a), reach * np.sqrt(c)], 1)
    return np.argsort(z, kind="stable"), center, inverse, half, splats.opacities.astype(np.float64)


@njit(cache=True)
def _blend(order, center, inverse, half, opacity, colors, height, width):
    picture = np.zeros((height, width, 3))
    clear = np.ones((height, width))
    for i in order:
        for row in range(max(0, int(center[i, 1] - half[i, 1])), min(height, int(center[i, 1] + half[i, 1]) + 1)):
            for column in range(max(0, int(center[i, 0] - half[i, 0])), min(width, int(center[i, 0] + half[i, 0]) + 1)):
                dx, dy = column + 0.5 - center[i, 0], row + 0.5 - center[i, 1]
                power = inverse[i, 0] * dx * dx + 2 * inverse[i, 1] * dx * dy + inverse[i, 2] * dy * dy
                alpha = min(0.99, opacity[i] * np.exp(-0.5 * power))
                if alpha < ALPHA_LEAST:
                    continue
                weight = alpha * clear[row, column]
                clear[row, column] -= weight
                for k in range(3):
                    picture[row, column, k] += weight * colors[i, k]
    return picture


@njit(cache=True)
def _gather(order, center, inverse, half, opacity, residual, covered, push, mass):
    height, width = covered.shape
    clear = np.ones((height, width))
    for i in order:
        for row in range(max(0, int(center[i, 1] - half[i, 1])), min(height, int(center[i, 1] + half[i, 1]) + 1)):
            for column in range(max(0, int(center[i, 0] - half[i, 0])), min(width, int(center[i, 0] + half[i, 0]) + 1)):
                dx, dy = column + 0.5 - center[i, 0], row + 0.5 - center[i, 1]
                power = inverse[i, 0] * dx * dx + 2 * inverse[i, 1] * dx * dy + inverse[i, 2] * dy * dy
                alpha = min(0.99, opacity[i] * np.exp(-0.5 * power))
                if alpha < ALPHA_LEAST:
                    continue
                weight = alpha * clear[row, column]
                clear[row, column] -= weight
                if covered[row, column]:
                    mass[i] += weight
                    for k in range(3):
                        push[i, k] += weight * residual[row, column, k]
