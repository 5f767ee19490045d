"""Eyeballs as spheres: the lids on them, the lamps mirrored in them, and where they look at rest."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.camera import Camera
from ..arkit import NAMES
from ..captures.meshview import see
from .soup import GLINTS, Surface

GLINTS_TOWARD = ((-0.20, 0.17, 1.0), (0.24, -0.10, 1.0))
"""Where on an eyeball the key and the fill lamp are mirrored; they stay when the eye turns."""
LID_REACH = 1.6
"""Skin in front of an eyeball's centre is a lid within so many of its radii."""
LID_PIXELS = 400
"""Pixels a decimetre in the picture in which the middle of the open lids is looked for."""
SLIT = 0.3
"""Where lids stand open by less than this share of their greatest opening, they are a corner."""
ASIDE = 0.6
"""Share of the way to the middle of the lids that eyes are turned aside: an iris sits a little to the nose of it."""


@dataclass(frozen=True)
class Eyeballs:
    """The spheres nearest to both eyes, decimetres."""

    side: NDArray[np.int8]
    """[E] of each vertex of the eyes: 0 left, 1 right (the person's)."""
    centers: Floats
    """[2, 3] left, right."""
    radius: float

    def lids(self, skin: Floats) -> NDArray[np.int8]:
        """[S] of points [S, 3] of the skin: over which eyeball they slide, 0 or 1, else -1."""
        lid = np.full(len(skin), -1, np.int8)
        for side, center in enumerate(self.centers):
            reach = np.linalg.norm(skin - center, axis=1)
            in_front = skin[:, 2] > center[2]
            lid[(reach > self.radius) & (reach < LID_REACH * self.radius) & in_front] = side
        return lid

    def glints(self, average: Floats) -> Surface:
        """Small triangles that touch the eyeballs where the lamps are mirrored; ``average`` [3] is their place on the
        average head."""
        corners = []
        for center in self.centers:
            for toward in np.array(GLINTS_TOWARD):
                unit = toward / np.linalg.norm(toward)
                x = np.cross([0, 1.0, 0], unit)
                y = np.cross(unit, x)
                middle = center + 1.015 * self.radius * unit
                corners += [middle + 0.01 * (np.cos(a) * x + np.sin(a) * y) for a in (0, 2 * np.pi / 3, 4 * np.pi / 3)]
        count = len(corners)
        return Surface(
            GLINTS,
            vertices=np.array(corners),
            deltas=np.zeros((len(NAMES), count, 3)),
            average=np.tile(average, (count, 1)),
            triangles=np.arange(count).reshape(-1, 3),
            texture=np.zeros((count // 3, 3, 2)),
        )

    def aimed(self, points: Floats, faces: NDArray[np.int64], eye_of_vertex: NDArray[np.int8]) -> Floats:
        """Directions [2, 3] from the centres towards the middle of the open lids, seen from the front.

        ``faces`` [F, 3] are skin and eyes of the ``points`` [V, 3]; ``eye_of_vertex`` [V] is 0 or 1 on an eyeball,
        else -1.

        Some identities droop or widen the lids away from the eyeballs' middles; pupils that stayed level would look
        up, and such that look straight ahead would squint at one's nose.
        """
        camera = Camera(
            1e3 * LID_PIXELS,
            1e3 * LID_PIXELS,
            256,
            128,
            512,
            256,
            np.array([[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 1000.0], [0, 0, 0, 1]]),
        )
        level = np.array([0, self.centers[0, 1], 0])
        seen, _, _ = see(points - level, faces, camera)
        side_of_face = np.where(seen >= 0, eye_of_vertex[faces[np.maximum(seen, 0), 0]], -1)
        return np.array([_aim(side_of_face == side, at, self.radius) for side, at in enumerate(self.centers - level)])


def _aim(shown: NDArray[np.bool_], center: Floats, radius: float) -> Floats:
    """Unit vector [3] towards the middle of what is ``shown`` [256, 512] of an eyeball; ahead where nothing is."""
    if not shown.any():
        return np.array([0.0, 0, 1])
    # the corners taper to slits that no iris fills
    open_columns = np.flatnonzero(shown.sum(0) > SLIT * shown.sum(0).max())
    rows = np.flatnonzero(shown.any(1))
    across = 0.5 * (open_columns[0] + open_columns[-1] + 1) - 256
    height = 128 - 0.5 * (rows[0] + rows[-1] + 1)
    turn = np.clip(ASIDE * (across / LID_PIXELS - center[0]) / radius, -0.15, 0.15)
    tilt = np.clip(0.8 * (height / LID_PIXELS - center[1]) / radius + 0.02, -0.3, 0.3)
    axis = np.array([np.sin(turn), np.sin(tilt), 1.0])
    return axis / np.linalg.norm(axis)


def eyeballs_of(eyes: Surface) -> Eyeballs:
    """The spheres of the eyes' surface."""
    side = (eyes.vertices[:, 0] < 0).astype(np.int8)
    centers = np.stack([_sphere_center(eyes.vertices[side == which]) for which in (0, 1)])
    shown = np.unique(eyes.triangles)
    radius = float(np.median(np.linalg.norm(eyes.vertices[shown] - centers[side[shown]], axis=1)))
    return Eyeballs(side, centers, radius)


def _sphere_center(points: Floats) -> Floats:
    """Centre [3] of the sphere nearest to ``points`` [P, 3] (linear least squares)."""
    system = np.concatenate([2 * points, np.ones((len(points), 1))], 1)
    return np.linalg.lstsq(system, (points**2).sum(1), rcond=None)[0][:3]
