"""The head's pose on top of its expression: the head turns about the neck, the shoulders stay."""

import numba
import numpy as np
from numpy.typing import NDArray

from ..render.arrays import Floats32
from ..render.compiling import FLAT, WIDE, compile_ahead
from ..render.gaussians import RawGaussians

NECK_PIVOT = (0.0, -0.075, -0.02)
"""The point a head nods and turns about where it has none of its own, metres, canonical space."""


def pose_head(
    raw: RawGaussians,
    neck_weights: Floats32,
    pivot: Floats32,
    rotvec: NDArray[np.floating],
    translation: NDArray[np.floating],
    out: RawGaussians | None = None,
) -> RawGaussians:
    """Turns and moves every splat by its share of the head's pose, means and rotations alike.

    Args:
        raw: canonical splats, not changed.
        neck_weights: [N] share of the pose in [0, 1].
        pivot: [3] the point the head turns about, metres.
        rotvec: [3] axis times angle, radians; a share w of it turns by w times the angle.
        translation: [3] metres.
        out: the answer of an earlier call, to be overwritten.

    Raises:
        ValueError: where the pose is not finite.
    """
    turn, move = np.asarray(rotvec, np.float32), np.asarray(translation, np.float32)
    if turn.shape != (3,) or move.shape != (3,) or not (np.isfinite(turn).all() and np.isfinite(move).all()):
        raise ValueError(f"a head pose is three finite angles and three finite lengths, got {rotvec} and {translation}")
    if out is None:
        out = RawGaussians(
            np.empty_like(raw.positions), np.empty_like(raw.wxyz), raw.log_scales, raw.opacity_logits, raw.colors
        )
    pivot = np.asarray(pivot, np.float32)
    pose_splats(raw.positions, raw.wxyz, neck_weights, pivot, turn, move, out.positions, out.wxyz)
    return out


def warm() -> None:
    """Compile what posing heads needs, or load it from disk, without running it."""
    compile_ahead(pose_splats, WIDE, WIDE, FLAT, FLAT, FLAT, FLAT, WIDE, WIDE)


@numba.njit(cache=True, parallel=True, fastmath=True)
def pose_splats(
    positions: Floats32,
    wxyz: Floats32,
    weights: Floats32,
    pivot: Floats32,
    turn: Floats32,
    move: Floats32,
    moved: Floats32,
    turned: Floats32,
) -> None:
    """``pose_head`` on plain arrays: [N, 3], [N, 4], [N], three of [3], and the answers [N, 3] and [N, 4]."""
    angle = np.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2])
    scale = 0.0 if angle < 1e-9 else 1.0 / angle
    ax, ay, az = turn[0] * scale, turn[1] * scale, turn[2] * scale
    for i in numba.prange(len(positions)):
        half = 0.5 * weights[i] * angle
        w, s = np.cos(half), np.sin(half)
        x, y, z = ax * s, ay * s, az * s
        px, py, pz = positions[i, 0] - pivot[0], positions[i, 1] - pivot[1], positions[i, 2] - pivot[2]
        # v + 2 w (u x v) + 2 u x (u x v)
        cx, cy, cz = y * pz - z * py, z * px - x * pz, x * py - y * px
        moved[i, 0] = px + 2 * (w * cx + y * cz - z * cy) + pivot[0] + weights[i] * move[0]
        moved[i, 1] = py + 2 * (w * cy + z * cx - x * cz) + pivot[1] + weights[i] * move[1]
        moved[i, 2] = pz + 2 * (w * cz + x * cy - y * cx) + pivot[2] + weights[i] * move[2]
        a, b, c, d = wxyz[i, 0], wxyz[i, 1], wxyz[i, 2], wxyz[i, 3]
        turned[i, 0] = w * a - x * b - y * c - z * d
        turned[i, 1] = w * b + x * a + y * d - z * c
        turned[i, 2] = w * c - x * d + y * a + z * b
        turned[i, 3] = w * d + x * c - y * b + z * a
