"""The animatable head: one triangle soup of skin, eyes, teeth, tongue, lashes and hair, posed by ARKit weights."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .body import cut_skin, load_body
from .eyeballs import eyeballs_of
from .fitting import fitted_surfaces
from .ingredients import Ingredients
from .lips import CORNER, LOWER, MIDDLE, mouth_light
from .mesh import vertex_normals
from .people import Person
from .puppet import Puppet
from .soup import EYES, SKIN, TEETH, joined


@dataclass(frozen=True)
class Head(Puppet):
    """A person's head with all its surfaces."""

    triangles: NDArray[np.int64]
    """[F, 3]"""
    texture: NDArray[np.float32]
    """[F, 3, 2] u, v of the corners in the part's own map."""
    parts: NDArray[np.uint8]
    """[F] index into PARTS."""
    canvas: NDArray[np.float32]
    """[V, 3] the vertex on the average MakeHuman head, metres from between its eyes: where detail is painted."""
    lip_rim: NDArray[np.int64]
    """[3] vertices: the left corner of the mouth, the middles of the upper and of the lower lip's edge."""

    def mouth_light(self, posed: Floats) -> float:
        """Share in [0, 1] of the light outside that reaches the incisors of a pose [V, 3]."""
        return mouth_light(posed[self.lip_rim], self._incisors)

    @cached_property
    def _incisors(self) -> float:
        """How far forward the teeth reach at rest, metres."""
        return float(self.vertices[np.unique(self.triangles[self.parts == TEETH]), 2].max())

    @cached_property
    def normals(self) -> NDArray[np.float32]:
        """[V, 3] smooth normals of the neutral face."""
        return vertex_normals(self.vertices.astype(float), self.triangles).astype(np.float32)


def build_head(person: Person, ingredients: Ingredients) -> Head:
    """The head of ``person``."""
    body = load_body(person, ingredients)
    skin, used = cut_skin(body)
    eyes, *others = fitted_surfaces(body, person, ingredients)
    eyeballs = eyeballs_of(eyes)
    between_eyes, origin = body.between_eyes(), body.between_ears(ingredients)
    soup = joined([skin, eyes, *others, eyeballs.glints(between_eyes)])
    eye_of_vertex = soup.marked(EYES, eyeballs.side)
    axes = eyeballs.aimed(soup.vertices, soup.triangles[soup.parts <= EYES], eye_of_vertex)
    return Head(  # decimetres become metres
        vertices=((soup.vertices - origin) / 10).astype(np.float32),
        deltas=(soup.deltas / 10).astype(np.float32),
        triangles=soup.triangles,
        texture=soup.texture.astype(np.float32),
        parts=soup.parts,
        canvas=((soup.average - between_eyes) / 10).astype(np.float32),
        eye_centers=((eyeballs.centers - origin) / 10).astype(np.float32),
        eye_axes=axes.astype(np.float32),
        eye_radius=eyeballs.radius / 10,
        eye_of_vertex=eye_of_vertex,
        lid_of_vertex=soup.marked(SKIN, eyeballs.lids(skin.vertices)),
        lip_rim=np.searchsorted(used, (CORNER, MIDDLE, LOWER)),
    )
