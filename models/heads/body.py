"""A person on MakeHuman's base mesh, and the skin of the head that is cut out of it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..arkit import NAMES
from .cheeks import LIFTED, lifted
from .ingredients import Ingredients
from .lips import hollowed
from .maps import load_map, sample_map
from .mesh import QuadMesh, load_base, load_target, subdivide, triangulate, vertex_normals
from .people import Person
from .soup import SKIN, Surface
from .units import face_units

CROP_BELOW_CROWN = 3.75
"""Decimetres of body kept below the crown: head, neck and the top of the shoulders."""


@dataclass(frozen=True)
class Body:
    """The whole body, decimetres."""

    base: QuadMesh
    """The average person's."""
    groups: NDArray[np.str_]
    """[Q] the group of each quad: the body's own, or a helper's that holds eyes, hair or clothes."""
    vertices: Floats
    """[V, 3] the person's."""
    flesh: Floats
    """[V, 3] the same with the face at rest and the walls of the mouth drawn back."""
    units: Floats
    """[52, V, 3] what one unit of each ARKit weight adds."""

    @property
    def is_skin(self) -> NDArray[np.bool_]:
        """[Q] which quads are the body's own."""
        return self.groups == "body"

    def between_eyes(self) -> Floats:
        """[3] of the average person."""
        return self.base.vertices[np.unique(self.base.quads[np.char.endswith(self.groups, "-eye")])].mean(0)

    def between_ears(self, ingredients: Ingredients) -> Floats:
        """The middle of the ears as MakeHuman's mask marks them."""
        base = self.base
        mask = load_map(ingredients.mpfb / "textures" / "mpfb_ears.jpg")
        quads = np.flatnonzero(self.is_skin)
        marked = sample_map(mask, base.texture[base.texture_quads[quads]].mean(1))[:, 0] > 0.5
        ears = self.vertices[np.unique(base.quads[quads[marked]])]
        return np.array([0.0, *ears.mean(0)[1:]])


def load_body(person: Person, ingredients: Ingredients) -> Body:
    """The body of ``person``."""
    base, groups = load_base(ingredients.mpfb / "3dobjs" / "base.obj")
    count = len(base.vertices)
    vertices = base.vertices + sum(
        weight * load_target(ingredients.mpfb / "targets" / f"{path}.target.gz", count)
        for path, weight in person.targets.items()
    )
    is_flesh = np.zeros(count, bool)
    is_flesh[np.unique(base.quads[groups == "body"])] = True
    units, rest = face_units(person, vertices, is_flesh, ingredients)
    flesh = hollowed(vertices + rest, base, _inside_mouth(base, is_flesh, ingredients))
    return Body(base, groups, vertices, flesh, units)


def cut_skin(body: Body) -> tuple[Surface, NDArray[np.int64]]:
    """The skin of the head, once subdivided; and which vertices of the body its first ones are, in rising order."""
    base = body.base
    crown = body.vertices[np.unique(base.quads[body.is_skin]), 1].max()
    kept = body.is_skin & (body.vertices[base.quads].mean(1)[:, 1] > crown - CROP_BELOW_CROWN)
    used, index = np.unique(base.quads[kept], return_inverse=True)
    coarse = QuadMesh(body.vertices[used], base.texture, index.reshape(-1, 4), base.texture_quads[kept])
    matrix, fine = subdivide(coarse)
    vertices, average = matrix @ body.flesh[used], matrix @ base.vertices[used]
    triangles = triangulate(fine.quads)
    deltas = np.stack([matrix @ unit[used] for unit in body.units])
    cheeks = 10 * lifted((average - body.between_eyes()) / 10, vertex_normals(vertices, triangles))
    for name, share in LIFTED.items():
        for side, sign in (("Left", 1), ("Right", -1)):
            deltas[NAMES.index(name + side)] += share * cheeks * (sign * average[:, :1] > 0)
    skin = Surface(
        SKIN,
        vertices=vertices,
        deltas=deltas,
        average=average,
        triangles=triangles,
        texture=fine.texture[triangulate(fine.texture_quads)],
    )
    return skin, used


def _inside_mouth(base: QuadMesh, is_flesh: NDArray[np.bool_], ingredients: Ingredients) -> Floats:
    """[V] in [0, 1]: the walls of the mouth as MakeHuman's mask marks them."""
    mask = load_map(ingredients.mpfb / "textures" / "mpfb_inside-mouth.jpg")
    inside = np.zeros(len(base.vertices))
    inside[base.quads] = sample_map(mask, base.texture[base.texture_quads].reshape(-1, 2))[:, 0].reshape(-1, 4)
    return inside * is_flesh
