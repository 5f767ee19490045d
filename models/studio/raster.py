"""Which triangle each sample of a picture sees, and how many fine hairs lie over it."""

import numba
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.camera import Camera

BANDS = 8
NEAR_M = 0.05
CUT = 0.42
"""A point of hair is there where its picture is at least so opaque."""
LASH_OPACITY = 0.85


def projected(vertices: Floats, camera: Camera, finer: int) -> NDArray[np.float32]:
    """x, y in samples and depth in metres [V, 3] of vertices in a picture with ``finer`` samples along a pixel."""
    points = vertices @ camera.world_to_camera[:3, :3].T + camera.world_to_camera[:3, 3]
    depth = np.maximum(points[:, 2], 1e-6)
    x = (camera.fx * points[:, 0] / depth + camera.cx) * finer
    y = (camera.fy * points[:, 1] / depth + camera.cy) * finer
    return np.stack([x, y, points[:, 2]], 1).astype(np.float32)


@numba.njit(cache=True, parallel=True)
def rasterize(points, triangles, cards, card_uv, is_lash, hair, lash, seen, weights, depth, clear):
    """Fill the samples of a picture.

    Args:
        points: [V, 3] x, y in samples, depth.
        triangles: [T, 3] solid surfaces; [L, 3] ``cards`` with ``card_uv`` [L, 3, 2] in the pictures ``hair`` and
            ``lash`` [h, w, 2], whose second channel is how opaque they are; lashes where ``is_lash`` [L].
        seen: [H, W] gets the nearest triangle, cards counted after solids, -1 where there is none.
        weights: [H, W, 2] gets the perspective-correct weights of its second and third corner.
        depth: [H, W] gets its depth.
        clear: [H, W] gets what the lashes in front of it let through.
    """
    height, width = seen.shape
    for band in numba.prange(BANDS):
        low, high = height * band // BANDS, height * (band + 1) // BANDS
        for row in range(low, high):
            for column in range(width):
                seen[row, column] = -1
                depth[row, column] = 1e9
                clear[row, column] = 1.0
        for kind in range(3):  # solids, hair, then lashes over what is there
            count = len(triangles) if kind == 0 else len(cards)
            for t in range(count):
                if kind > 0 and is_lash[t] != (kind == 2):
                    continue
                corner = triangles[t] if kind == 0 else cards[t]
                a, b, c = corner[0], corner[1], corner[2]
                za, zb, zc = points[a, 2], points[b, 2], points[c, 2]
                if za < NEAR_M or zb < NEAR_M or zc < NEAR_M:
                    continue
                xa, ya = points[a, 0], points[a, 1]
                xb, yb = points[b, 0], points[b, 1]
                xc, yc = points[c, 0], points[c, 1]
                top = max(low, int(np.ceil(min(ya, yb, yc) - 0.5)))
                bottom = min(high - 1, int(np.floor(max(ya, yb, yc) - 0.5)))
                if top > bottom:
                    continue
                area = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)
                if abs(area) < 1e-7:
                    continue
                left = max(0, int(np.ceil(min(xa, xb, xc) - 0.5)))
                right = min(width - 1, int(np.floor(max(xa, xb, xc) - 0.5)))
                for row in range(top, bottom + 1):
                    for column in range(left, right + 1):
                        px, py = column + 0.5, row + 0.5
                        v = ((px - xa) * (yc - ya) - (xc - xa) * (py - ya)) / area
                        w = ((xb - xa) * (py - ya) - (px - xa) * (yb - ya)) / area
                        u = 1 - v - w
                        if u < -1e-6 or v < -1e-6 or w < -1e-6:
                            continue
                        z = 1 / (u / za + v / zb + w / zc)
                        if z >= depth[row, column]:
                            continue
                        v *= z / zb
                        w *= z / zc
                        if kind > 0:
                            picture = hair if kind == 1 else lash
                            uu = card_uv[t, 0, 0] * (1 - v - w) + card_uv[t, 1, 0] * v + card_uv[t, 2, 0] * w
                            vv = card_uv[t, 0, 1] * (1 - v - w) + card_uv[t, 1, 1] * v + card_uv[t, 2, 1] * w
                            solid = sampled(picture, uu, vv, 1)
                            if kind == 2:
                                clear[row, column] *= 1 - LASH_OPACITY * solid
                                continue
                            if solid < CUT:
                                continue
                        depth[row, column] = z
                        seen[row, column] = t + (len(triangles) if kind == 1 else 0)
                        weights[row, column, 0] = v
                        weights[row, column, 1] = w


@numba.njit(cache=True, inline="always")
def sampled(image, u, v, channel):
    """Bilinear sample of one channel at u, v in 0..1 (v upwards); beyond the edge the edge goes on."""
    height, width = image.shape[0], image.shape[1]
    x = min(max(u * width - 0.5, 0.0), width - 1.001)
    y = min(max((1 - v) * height - 0.5, 0.0), height - 1.001)
    column, row = int(x), int(y)
    fx, fy = x - column, y - row
    upper = image[row, column, channel] * (1 - fx) + image[row, column + 1, channel] * fx
    lower = image[row + 1, column, channel] * (1 - fx) + image[row + 1, column + 1, channel] * fx
    return upper * (1 - fy) + lower * fy
