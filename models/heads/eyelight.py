"""Light on eyeballs, which turn under their lids: each point has one colour, wherever the eye looks."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .head import Head
from .light import irradiance, part_of_vertex
from .performance import gaze
from .soup import EYES, SKIN

GLANCES = tuple((across / 3, up / 2) for across in range(-3, 4) for up in range(-1, 2))
"""Where the eyes look (see ``performance.gaze``) while it is seen what light reaches them."""
AHEAD = 8.0
"""Glances straight ahead count as so many others: eyes are looked at most when they look back."""
VIEWERS = np.array([(0.0, 0.0, 1.0), (0.5, 0.0, 0.87), (-0.5, 0.0, 0.87), (0.0, 0.3, 0.95), (0.0, -0.3, 0.95)])
"""Directions from which a point must be seen for its light to matter."""
UNSEEN = 0.02
"""Points that nobody sees in a glance count by so much: those hidden in all of them need some light, too."""
DEEPENING = (0.5, 1.0)
"""Bounds of the factor by which light is deepened where there is little: a wet ball mirrors the dark of its socket."""
LEAST = 0.28
"""Irradiance everywhere."""


def light_eyes(head: Head, cards: NDArray[np.bool_], light: Floats) -> None:
    """Sets the irradiance ``light`` [V, 3] on eyeballs to what reaches them in the glances that show them.

    Lit as they lie at rest, with their sides in the dark behind lids, whites would be half grey in every glance aside,
    with an edge where the lids were. ``cards`` [F] is opaque hair.
    """
    eyes = np.flatnonzero(part_of_vertex(head) == EYES)
    total, shares = np.zeros((len(eyes), 3)), np.zeros(len(eyes))
    for across, up in GLANCES:
        vertices = head.pose(gaze(across, up))
        share = (UNSEEN + _seen(head, vertices, eyes)) * (AHEAD if across == up == 0 else 1)
        total += share[:, None] * irradiance(head, vertices, cards, of=eyes)
        shares += share
    lit = total / shares[:, None]
    light[eyes] = np.maximum(lit * np.clip(lit.mean(1, keepdims=True), *DEEPENING), LEAST)


def _seen(head: Head, vertices: Floats, members: NDArray[np.int64]) -> Floats:
    """[M] share of the VIEWERS who see each of the vertices ``members`` [M], past the skin."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    skin = EmbreeScene()
    TriangleMesh(skin, np.ascontiguousarray(vertices[head.triangles[head.parts == SKIN]], np.float32))
    side = head.eye_of_vertex[members]
    outward = vertices[members] - head.eye_centers[side]
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    start = (vertices[members] + 4e-4 * outward).astype(np.float32)
    seen = np.zeros(len(members))
    for viewer in VIEWERS:
        toward = np.broadcast_to(viewer, outward.shape).astype(np.float32)
        seen += (skin.run(start, toward, query="OCCLUDED") < 0) & (outward @ viewer > 0)
    return seen / len(VIEWERS)
