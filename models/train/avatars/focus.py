"""Where people look: the mouth and the eyes, found on the template and in a picture."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from ....render.camera import Camera
from ...captures.texels import Texels

MOUTH = ("mouth", "lip", "teeth", "tongue")
EYES = ("eye",)
"""A part belongs to them whose name holds one of these words."""
AROUND_M = 0.012
"""Skin so near to them is theirs: lips and lids."""
_SOFT = 0.15
"""The rim is blurred over this share of the region's height."""
_MOST = 400
"""Points of a part are enough to measure distances to it."""

Region = NDArray[np.int64]
"""Indices of texels."""


def regions_of(texels: Texels, part_names: Sequence[str]) -> list[Region]:
    """The mouth, and each eye, with the skin around them; what the template does not name is left out."""
    positions = texels.spread(texels.template.vertices)
    found = []
    for words, sides in ((MOUTH, (0,)), (EYES, (-1, 1))):
        parts = [index for index, name in enumerate(part_names) if any(word in name.lower() for word in words)]
        inside = np.isin(texels.part, parts)
        for side in sides:
            own = np.flatnonzero(inside & (side * positions[:, 0] >= 0))
            if len(own):
                found.append(_with_surroundings(positions, own))
    return found


def _with_surroundings(positions: NDArray[np.floating], own: Region) -> Region:
    middle = positions[own[:: max(1, len(own) // _MOST)]]
    # the front half alone: what lies beside the molars is cheek
    middle = middle[middle[:, 2] >= np.median(middle[:, 2])]
    reach = np.abs(positions - middle.mean(0)).max(1) < 0.1
    near = np.flatnonzero(reach)
    apart = np.linalg.norm(positions[near, None] - middle, axis=-1).min(1)
    return np.union1d(near[apart < AROUND_M], own)


def focus_map(regions: Sequence[Region], positions: NDArray[np.floating], camera: Camera) -> NDArray[np.float32]:
    """[H, W] in [0, 1]: 1 within the outline of a region as the camera sees it, fading at its rim.

    Args:
        regions: indices into ``positions``.
        positions: [N, 3] splats in the world, metres.
    """
    weights = np.zeros((camera.height, camera.width), np.float32)
    turn, move = camera.world_to_camera[:3, :3], camera.world_to_camera[:3, 3]
    for region in regions:
        seen = positions[region] @ turn.T + move
        seen = seen[seen[:, 2] > 1e-3]
        if len(seen) < 3:
            continue
        pixels = seen[:, :2] / seen[:, 2:] * [camera.fx, camera.fy] + [camera.cx, camera.cy]
        pixels = np.clip(pixels, -1e4, 1e4)
        outline = cv2.convexHull(pixels.astype(np.float32)).round().astype(np.int32)
        soft = max(1.0, _SOFT * float(np.ptp(pixels[:, 1])))
        _soften(weights, outline, soft)
    return weights


def _soften(weights: NDArray[np.float32], outline: NDArray[np.int32], soft: float) -> None:
    """Raises the weights [H, W] within an outline of pixels to 1, fading over ``soft`` pixels; touches no more of
    them than that reaches."""
    margin = int(np.ceil(4 * soft)) + 2  # where OpenCV's own window for floats ends
    low = np.clip(outline.min((0, 1)) - margin, 0, weights.shape[::-1])
    high = np.clip(outline.max((0, 1)) + margin + 1, 0, weights.shape[::-1])
    if (high <= low).any():
        return
    near = weights[low[1] : high[1], low[0] : high[0]]
    own = np.zeros_like(near)
    cv2.fillConvexPoly(own, outline - low.astype(np.int32), 1.0)
    np.maximum(near, cv2.GaussianBlur(own, (0, 0), soft), out=near)
