"""What poses a head: its vertices, the ARKit shapes, and eyeballs that turn under lids which slide over them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..arkit import NAMES

GAZE_DEG = {"Out": 30.0, "In": 30.0, "Up": 21.0, "Down": 25.0}
"""Degrees an eyeball turns at weight 1; further up or down the lids would hide the iris."""
LID_CLEARANCE = 1.035
"""Lids ride at this multiple of the eyeball's radius."""


@dataclass(frozen=True)
class Puppet:
    """Vertices that ARKit weights move, metres, canonical space."""

    vertices: NDArray[np.float32]
    """[V, 3] the neutral face."""
    deltas: NDArray[np.float32]
    """[52, V, 3] what one unit of each ARKit weight adds."""
    eye_centers: NDArray[np.float32]
    """[2, 3] left, right (the person's)."""
    eye_axes: NDArray[np.float32]
    """[2, 3] where the pupils point at rest: through the middle of the open lids."""
    eye_radius: float
    """Metres."""
    eye_of_vertex: NDArray[np.int8]
    """[V] 0 or 1 for vertices of the left or right eyeball, else -1."""
    lid_of_vertex: NDArray[np.int8]
    """[V] 0 or 1 for skin that slides over that eyeball, else -1."""

    def pose(self, weights: Floats) -> NDArray[np.float32]:
        """Vertices [V, 3] of the face with ARKit ``weights`` [52]."""
        active = np.flatnonzero(weights)
        posed = self.vertices + np.tensordot(np.asarray(weights, np.float32)[active], self.deltas[active], 1)
        for side, center in enumerate(self.eye_centers):
            ball = self.eye_of_vertex == side
            posed[ball] = (self.vertices[ball] - center) @ gaze_turn(weights, side).T + center
            lid = self.lid_of_vertex == side
            offset = posed[lid] - center
            reach = np.linalg.norm(offset, axis=1, keepdims=True)
            posed[lid] = center + offset * np.maximum(1, self.eye_radius * LID_CLEARANCE / np.maximum(reach, 1e-6))
        return posed.astype(np.float32)


def gaze_turn(weights: Floats, side: int) -> Floats:
    """Rotation [3, 3] of the left (0) or right (1) eyeball."""
    name = ("Left", "Right")[side]
    w = {d: float(weights[NAMES.index(f"eyeLook{d}{name}")]) * np.radians(GAZE_DEG[d]) for d in GAZE_DEG}
    yaw = (w["Out"] - w["In"]) * (1 if side == 0 else -1)  # The person's left is +x.
    pitch = w["Down"] - w["Up"]
    about_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]])
    return about_y @ about_x
