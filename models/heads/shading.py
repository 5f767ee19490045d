"""Colour of every point of the head: albedo, baked light, sheen, eyes, teeth, cloth."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial import cKDTree

from ...render.arrays import Floats
from .brows import BrowMap, paint_brows
from .collar import collar_height
from .expressions import weights_of
from .eyelight import light_eyes
from .head import Head
from .ingredients import Ingredients
from .light import KEY, bake, part_of_vertex
from .maps import encoded, linear, load_map, sample_map
from .noise import value_noise
from .people import Person
from .sides import Sides, around_eyes, sides_of
from .skin import SkinMaps, albedo, load_skin_maps, mouth_shade, points_of
from .soup import EYES, HAIR, SKIN, TEETH, TONGUE
from .teeth import paint_teeth

EXPOSURE = 0.92
IRIS_RAD = 0.405
"""Half angle of the iris, from the eyeball's centre."""
SCALP_BLUR = 4e-3
"""Metres over which the skin under the hair takes on its colour: hairs root less and less densely there."""
PUPIL_RAD = 0.155
IRIS_COLORS = {
    "green": (0.33, 0.36, 0.22),
    "lightblue": (0.37, 0.45, 0.51),
    "brown": (0.25, 0.135, 0.07),
    "darkbrown": (0.20, 0.115, 0.06),
    "blue": (0.24, 0.36, 0.52),
}


@dataclass(frozen=True)
class Shader:
    """Everything that decides the colours of one person."""

    head: Head
    person: Person
    maps: SkinMaps
    brows: BrowMap
    light: NDArray[np.floating]
    """[V, 3] irradiance after subsurface scattering."""
    scalp: NDArray[np.floating]
    """[V] in [0, 1]: skin under the hair."""
    teeth_map: NDArray[np.floating]
    tongue_map: NDArray[np.floating]

    def color(self, faces: NDArray[np.int64], weights: Floats) -> Floats:
        """sRGB [N, 3] of points given by triangle [N] and barycentric weights [N, 3]; not for hair and lashes."""
        color = self._lit(faces, weights)
        if not self.person.even_eyes:
            return color
        _, canvas, _ = points_of(self.head, faces, weights)
        even = self.person.even_eyes * around_eyes(canvas) * (self.head.parts[faces] == SKIN)
        on = even > 1e-3
        across = self._lit(*self._sides.across(faces[on], weights[on]))
        color[on] += even[on, None] / 2 * (across - color[on])
        return color

    @cached_property
    def _sides(self) -> Sides:
        return sides_of(self.head.canvas, self.head.triangles)

    def _lit(self, faces: NDArray[np.int64], weights: Floats) -> Floats:
        """As ``color``, each side of the face by itself."""
        head = self.head
        _, canvas, normal = points_of(head, faces, weights)
        light = (self.light[head.triangles[faces]] * weights[..., None]).sum(1)
        base, sheen = self.surface(faces, weights)
        bump = np.stack([value_noise(canvas, 1.6e-3, self.person.seed + 40 + k) for k in range(3)], 1)
        bent = normal + 0.05 * bump * (head.parts[faces] == SKIN)[:, None]
        bent /= np.linalg.norm(bent, axis=1, keepdims=True)
        shine = sheen * _sheen(bent) * np.clip(light.mean(1) / 1.2, 0, 1)
        return np.clip(tone(EXPOSURE * base * light + shine[:, None] * np.array([1.0, 0.97, 0.94])), 0, 1)

    def surface(self, faces: NDArray[np.int64], weights: Floats) -> tuple[Floats, Floats]:
        """Linear albedo [N, 3] and sheen [N] of points given as for ``color``: what they are like before any light."""
        head = self.head
        uv, canvas, _ = points_of(head, faces, weights)
        corners = head.triangles[faces]
        position = (head.vertices[corners] * weights[..., None]).sum(1)
        part = head.parts[faces]
        base = np.full((len(faces), 3), 0.2)
        sheen = np.zeros(len(faces))
        on = part == SKIN
        if on.any():
            scalp = (self.scalp[corners[on]] * weights[on]).sum(1)
            base[on], sheen[on] = albedo(self.person, self.maps, uv[on], canvas[on], scalp, self.brows.at(canvas[on]))
            below = (collar_height(position[on]) < 0).astype(float)
            base[on] += below[:, None] * (cloth(self.person, canvas[on]) - base[on])
            sheen[on] *= 1 - below
        on = part == EYES
        base[on] = self._eyes(faces[on], weights[on])
        on = part == TEETH
        base[on], sheen[on] = sample_map(self.teeth_map, uv[on]), 0.12
        on = part == TONGUE
        base[on] = linear(sample_map(self.tongue_map, uv[on])[:, :3]) * np.array([0.50, 0.40, 0.42])
        base[on] *= mouth_shade(canvas[on])[:, None]
        sheen[on] = 0.25
        return base, sheen

    def _eyes(self, faces: NDArray[np.int64], weights: Floats) -> Floats:
        """Linear albedo of sclera, iris and pupil."""
        head = self.head
        corners = head.triangles[faces]
        side = head.eye_of_vertex[corners[:, 0]]
        offset = (head.vertices[corners] * weights[..., None]).sum(1) - head.eye_centers[side]
        offset /= np.maximum(np.linalg.norm(offset, axis=1, keepdims=True), 1e-9)
        axis = head.eye_axes[side]
        angle = np.arccos(np.clip((offset * axis).sum(1), -1, 1))
        upright = np.cross(axis, [1.0, 0, 0])
        around = np.arctan2((offset * upright).sum(1), offset[:, 0])
        ring = np.stack([np.cos(around), np.sin(around), 0 * around], 1)
        fibre = value_noise(ring * 3.2 + 7 * side[:, None], 0.35, self.person.seed) * 0.6
        fibre += 0.5 * value_noise(
            ring * 3.2 + np.stack([0 * angle, 0 * angle, 5 * angle], 1), 0.16, self.person.seed + 1
        )
        across = angle / IRIS_RAD
        iris = linear(np.array(IRIS_COLORS[self.person.eye])) * 1.25
        glow = np.exp(-(((across - 0.55) / 0.22) ** 2))
        tint = iris * (1 + 0.35 * fibre[:, None]) * (0.75 + 0.6 * glow[:, None])
        limbal = np.clip((across - 0.70) / 0.25, 0, 1)[:, None]
        tint = tint * (1 - 0.85 * limbal)
        pupil = np.clip((PUPIL_RAD + 0.03 - angle) / 0.05, 0, 1)[:, None]
        tint = tint + pupil * (0.006 - tint)
        outward = np.clip((angle - 0.55) / 0.7, 0, 1)[:, None]
        veins = np.clip(value_noise(ring * 2 + offset * 6, 0.5, self.person.seed + 2), 0, 1)[:, None]
        sclera = np.array(self.person.sclera) * (1 - outward * np.array([0.12, 0.26, 0.28]))
        sclera = sclera * (1 - veins * outward * np.array([0.02, 0.14, 0.14]))
        edge = np.clip((angle - IRIS_RAD) / 0.05 + 0.5, 0, 1)[:, None]
        return tint + edge * (sclera - tint)


def tone(light: Floats) -> Floats:
    """Linear light to sRGB with a soft shoulder above 0.7."""
    soft = np.where(light > 0.7, 0.7 + 0.3 * np.tanh((light - 0.7) / 0.45), light)
    return encoded(soft)


def _sheen(normal: Floats) -> Floats:
    """Highlights of the key lamp seen from the front: a broad and a narrow lobe (Blinn 1977)."""
    half = KEY + np.array([0, 0, 1.0])
    half /= np.linalg.norm(half)
    facing = np.clip(normal @ half, 0, 1)
    return 0.055 * facing**10 + 0.09 * facing**48


def cloth(person: Person, canvas: Floats) -> Floats:
    """Linear albedo [N, 3] of the T-shirt."""
    weave = value_noise(canvas, 1.2e-3, 3) * 0.10 + value_noise(canvas, 30e-3, 4) * 0.08
    return linear(np.array(person.shirt)) * (1 + weave[:, None])


def make_shader(person: Person, head: Head, ingredients: Ingredients) -> Shader:
    """Bake the light and read the maps of ``person``."""
    maps = load_skin_maps(person, ingredients)
    part = part_of_vertex(head)
    uv = np.zeros((len(head.vertices), 2))
    uv[head.triangles] = head.texture
    skin = (part == SKIN).astype(float)
    regions = (maps.mouth, maps.lids, maps.lips, maps.ears)
    mouth, lids, lips, ears = (sample_map(m, uv)[:, 0] * skin for m in regions)
    hair_map = load_map(hair_texture(person, ingredients))
    cards = (head.parts == HAIR) & (sample_map(hair_map, head.texture.mean(1))[:, 3] > 0.6)
    light = bake(
        head,
        (
            head.pose(weights_of(jawOpen=0.75, mouthUpperUp=0.3, mouthLowerDown=0.3)),
            head.pose(weights_of(eyeBlink=1.0)),
            head.pose(weights_of(mouthPucker=0.6, mouthFunnel=0.4)),
        ),
        cards,
        mouth,
        lids,
        lips,
    )
    light_eyes(head, cards, light)
    proxies = ingredients.makehuman / "proxies"
    return Shader(
        head=head,
        person=person,
        maps=maps,
        brows=paint_brows(person, ingredients),
        light=light,
        scalp=_under_hair(head, ears, cards),
        teeth_map=paint_teeth(person.enamel),
        tongue_map=load_map(proxies / "tongue/tongue01/textures/tongue01_diffuse.png"),
    )


def hair_texture(person: Person, ingredients: Ingredients) -> Path:
    """The picture on the person's hair cards."""
    return min((ingredients.makehuman / "proxies/hair" / person.hair.proxy / "textures").glob("*.png"))


def _under_hair(head: Head, ears: Floats, cards: NDArray[np.bool_]) -> Floats:
    """[V] how much of the sky just above each skin vertex is hair within 1.4 cm."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    TriangleMesh(scene, np.ascontiguousarray(head.vertices[head.triangles[cards]], np.float32))
    start = (head.vertices - 2e-3 * head.normals).astype(np.float32)
    covered = np.zeros(len(head.vertices))
    for tilt in np.concatenate([np.zeros((1, 3)), 0.45 * np.eye(3), -0.45 * np.eye(3)]):
        toward = head.normals + tilt.astype(np.float32)
        toward /= np.maximum(np.linalg.norm(toward, axis=1, keepdims=True), 1e-6)
        distance = scene.run(start, toward.astype(np.float32), query="DISTANCE")
        covered += distance < 0.014
    covered = np.clip(covered / 7 * 1.6 - 0.5, 0, 1)
    from_ear, _ = cKDTree(head.canvas[ears > 0.5]).query(head.canvas)  # the map of the ears ends at their rims
    y, z = head.canvas[:, 1], head.canvas[:, 2]
    grows = np.clip((y + 0.085 - 0.5 * np.clip(z + 0.09, 0, 1)) / 0.015, 0, 1)  # rises from the nape to the sideburns
    scalp = covered * grows * np.clip(from_ear / 5e-3 - 1, 0, 1) * (part_of_vertex(head) == SKIN)
    return blurred(scalp, head.vertices, SCALP_BLUR)


def blurred(values: Floats, points: Floats, sigma: float) -> Floats:
    """[V] means over the neighbourhood of each of ``points`` [V, 3], weighted by a Gaussian of ``sigma`` metres."""
    return nearness(points, sigma) @ values


def nearness(points: Floats, sigma: float) -> sparse.csr_matrix:
    """What makes means [V, V] of values at ``points`` [V, 3], weighted by a Gaussian of ``sigma`` metres."""
    near = cKDTree(points).sparse_distance_matrix(cKDTree(points), 2.5 * sigma, output_type="coo_matrix")
    weights = sparse.coo_matrix((np.exp(-0.5 * (near.data / sigma) ** 2), (near.row, near.col)), near.shape).tocsr()
    return sparse.csr_matrix(sparse.diags(1 / np.asarray(weights.sum(1)).ravel()) @ weights)
