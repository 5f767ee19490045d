"""The head's pose in tracked meshes: taken out where it is known, estimated where it is not."""

import numpy as np

from ...render.arrays import Floats
from ...render.rotations import rotvec_from_matrix

_ROUNDS = 12
_FLOOR_M = 2e-4


def posed(vertices: Floats, neck_weights: Floats, pivot: Floats, rotation: Floats, translation: Floats) -> Floats:
    """Vertices [V, 3] turned and moved by their shares [V] of the head's pose, as ``posing.pose_head`` does."""
    return _turned(vertices - pivot, neck_weights, rotation) + pivot + neck_weights[:, None] * translation


def unposed(vertices: Floats, neck_weights: Floats, pivot: Floats, rotation: Floats, translation: Floats) -> Floats:
    """The exact inverse of ``posed``."""
    return _turned(vertices - pivot - neck_weights[:, None] * translation, neck_weights, -rotation) + pivot


def estimated(vertices: Floats, template: Floats, neck_weights: Floats, pivot: Floats) -> tuple[Floats, Floats]:
    """Rotation [3] and translation [3] that take the template [V, 3] rigidly to where most of the head [V, 3] is.

    What moves by itself (lips, jaw, lids) counts little: the fit is repeated with each vertex weighted down by how
    far off it was left (Cauchy weights). Vertices count as the fourth power of their share of the pose.
    """
    share = np.asarray(neck_weights, np.float64) ** 4
    source, target = np.asarray(template, np.float64) - pivot, np.asarray(vertices, np.float64) - pivot
    weights = share
    turn, move = np.eye(3), np.zeros(3)
    for _ in range(_ROUNDS):
        turn, move = rigid(source, target, weights)
        off = np.linalg.norm(source @ turn.T + move - target, axis=1)
        middle = float(np.median(off[share > 0.5])) if (share > 0.5).any() else float(np.median(off))
        weights = share / (1 + (off / max(middle, _FLOOR_M)) ** 2)
    return rotvec_from_matrix(turn).astype(np.float32), move.astype(np.float32)


def _turned(offsets: Floats, shares: Floats, rotation: Floats) -> Floats:
    """Rodrigues' formula with a share of the angle for each point."""
    axis = np.asarray(rotation, np.float64)
    angle = float(np.linalg.norm(axis))
    if angle < 1e-9:
        return offsets
    axis = axis / angle
    cos, sin = np.cos(shares * angle)[:, None], np.sin(shares * angle)[:, None]
    return offsets * cos + np.cross(axis, offsets) * sin + axis * (offsets @ axis)[:, None] * (1 - cos)


def rigid(source: Floats, target: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Rotation and translation with the least weighted squared distance (Kabsch)."""
    share = weights / max(float(weights.sum()), 1e-12)
    here, there = share @ source, share @ target
    u, _, vt = np.linalg.svd((source - here).T @ ((target - there) * share[:, None]))
    turn = vt.T @ np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    return turn, there - turn @ here
