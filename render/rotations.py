"""Rotations as unit quaternions wxyz and as 3x3 matrices."""

import numpy as np

from .arrays import Floats


def normalized(wxyz: Floats) -> Floats:
    """Unit quaternions in the direction of ``wxyz`` [..., 4]; a zero quaternion becomes the identity."""
    length = np.linalg.norm(wxyz, axis=-1, keepdims=True)
    identity = np.zeros_like(wxyz)
    identity[..., 0] = 1
    return np.where(length > 1e-12, wxyz / np.maximum(length, 1e-12), identity)


def matrix_from_wxyz(wxyz: Floats) -> Floats:
    """Rotation matrices [..., 3, 3] of quaternions [..., 4], which are normalised first."""
    w, x, y, z = np.moveaxis(normalized(wxyz), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def wxyz_from_matrix(matrix: Floats) -> Floats:
    """Unit quaternions [..., 4], w >= 0, of rotation matrices [..., 3, 3] (Shepperd: the largest of four pivots)."""
    m = matrix
    trace = m[..., 0, 0] + m[..., 1, 1] + m[..., 2, 2]
    pivots = np.stack([trace, m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]], -1)
    xy, yx, xz = m[..., 0, 1], m[..., 1, 0], m[..., 0, 2]
    zx, yz, zy = m[..., 2, 0], m[..., 1, 2], m[..., 2, 1]
    candidates = np.stack(
        [
            np.stack([1 + trace, zy - yz, xz - zx, yx - xy], -1),
            np.stack([zy - yz, 1 + 2 * m[..., 0, 0] - trace, xy + yx, xz + zx], -1),
            np.stack([xz - zx, xy + yx, 1 + 2 * m[..., 1, 1] - trace, yz + zy], -1),
            np.stack([yx - xy, xz + zx, yz + zy, 1 + 2 * m[..., 2, 2] - trace], -1),
        ],
        -2,
    )
    best = np.take_along_axis(candidates, pivots.argmax(-1)[..., None, None], -2)[..., 0, :]
    best = normalized(best)
    return np.where(best[..., :1] < 0, -best, best)


def wxyz_from_rotvec(rotvec: Floats) -> Floats:
    """Unit quaternions [..., 4] of axis-angle vectors [..., 3] in radians; exact near the identity."""
    angle = np.linalg.norm(rotvec, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), rotvec * 0.5 * np.sinc(angle / (2 * np.pi))], -1)


def rotvec_from_matrix(matrix: Floats) -> Floats:
    """Axis-angle vectors [..., 3] in radians, length <= pi, of rotation matrices [..., 3, 3]."""
    wxyz = wxyz_from_matrix(matrix)
    sine = np.linalg.norm(wxyz[..., 1:], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, wxyz[..., :1])
    return wxyz[..., 1:] * np.where(sine > 1e-9, angle / np.maximum(sine, 1e-9), 2.0)


def sign_aligned(wxyz: Floats, reference: Floats) -> Floats:
    """The quaternions [..., 4] with the sign that points along ``reference`` (q and -q are one rotation)."""
    return np.where((wxyz * reference).sum(-1, keepdims=True) < 0, -wxyz, wxyz)
