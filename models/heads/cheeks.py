"""Cheeks: what a smile does to them beyond MakeHuman's shapes, whose corners slide over a cheek that stays flat."""

import numpy as np

from ...render.arrays import Floats

MM = 1e-3
OUTWARD_MM, UPWARD_MM, GROOVE_MM = 3.4, 1.6, 0.9
"""How far a whole smile pushes the middle of a cheek out and up, and how deep the fold beside it becomes."""
LIFTED = {"mouthSmile": 1.0, "cheekSquint": 0.45, "mouthUpperUp": 0.35, "noseSneer": 0.4}
"""Shape -> share of that which it does, each on its side."""
FOLD = ((-95, -72, -55, -40, -30), (40.0, 35.5, 28.5, 20.5, 17.0))
"""Heights on the canvas, and how far to the side the fold from the wing of the nose past the mouth runs there, mm."""
EDGE_MM, WIDE_MM = 8.0, 27.0
"""From the fold outwards: where the cheek stands out, and where that ends."""
MIDDLE_MM, HIGH_MM = -45.0, 21.0
"""Height of the cheek's middle, and how far it reaches up and down."""


def lifted(canvas: Floats, normals: Floats) -> Floats:
    """[V, 3] metres: what a whole smile adds to both cheeks at points of the canvas [V, 3] with ``normals`` [V, 3]."""
    x, y = np.abs(canvas[:, 0]) / MM, canvas[:, 1] / MM
    beside = x - fold_at(y)
    there = np.exp(-(((y - MIDDLE_MM) / HIGH_MM) ** 4)) * np.clip((canvas[:, 2] / MM + 60) / 20, 0, 1)
    rise = np.clip(beside / EDGE_MM, 0, 1)
    cheek = rise * rise * (3 - 2 * rise) * np.exp(-((np.maximum(beside - EDGE_MM, 0) / WIDE_MM) ** 2)) * there
    groove = np.exp(-(((beside + 0.5) / 2.6) ** 2)) * there
    out = OUTWARD_MM * cheek - GROOVE_MM * groove
    return MM * (out[:, None] * normals + UPWARD_MM * cheek[:, None] * np.array([0, 1.0, 0]))


def fold_at(height_mm: Floats) -> Floats:
    """How far to the side of the middle the fold runs, millimetres."""
    return np.interp(height_mm, *FOLD)
