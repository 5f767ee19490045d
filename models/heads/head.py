"""The animatable head: one triangle soup of skin, eyes, teeth, tongue, lashes and hair, posed by ARKit weights."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...render.camera import Camera
from ..arkit import NAMES
from ..captures.meshview import see
from .ingredients import Ingredients
from .lips import CORNER, LOWER, MIDDLE, PURSES, arching, hollowed, mouth_light, pursed
from .maps import load_map, sample_map
from .mesh import QuadMesh, load_base, load_target, subdivide, triangulate, vertex_normals
from .people import Person
from .proxies import Proxy, load_proxy
from .puppet import Puppet
from .teeth import carried, make_arches

Floats = NDArray[np.floating]

PARTS = ("skin", "eyes", "teeth", "tongue", "lashes", "hair", "glints")
SKIN, EYES, TEETH, TONGUE, LASHES, HAIR, GLINTS = range(7)
CROP_BELOW_CROWN = 3.75
"""Decimetres of body kept below the crown: head, neck and the top of the shoulders."""
GLINTS_TOWARD = ((-0.20, 0.17, 1.0), (0.24, -0.10, 1.0))
"""Where on an eyeball the key and the fill lamp are mirrored; they stay when the eye turns."""
GAIN = {
    "browInnerUp": 1.6,
    "browOuterUpLeft": 1.25,
    "browOuterUpRight": 1.25,
    "mouthPucker": 1.2,
    "mouthFunnel": 1.2,
    "mouthUpperUpLeft": 1.25,
    "mouthUpperUpRight": 1.25,
    "eyeWideLeft": 1.4,
    "eyeWideRight": 1.4,
}
"""Factors on shapes that are timid: measured on the face tracker, whose scores of people they should reach."""
SMILE = {"mouthSmile": 0.8, "mouthStretch": 0.7, "mouthDimple": 0.4}
"""What a smile is made of. MakeHuman's lifts the corners more than it draws them apart: .7 and 1.0 cm wider than at
rest, .5 and .95 cm higher, where people to whom the tracker gives .63 and .87 of a smile have 1.0 and 1.6, .4 and .8.
``tests/bench/smiles.py`` measures people, and the avatars that this makes."""
LID_FOLLOWS = {"eyeLookUp": ("eyeWide", 0.6)}
"""Shape -> what it borrows, and how much: eyes that look up raise the lids, which MakeHuman's shape hardly does."""
UPPER_TEETH_DROP, LOWER_TEETH_DROP = 0.034, 0.042
TONGUE_SHIFT = np.array([0.0, -0.05, -0.03])
"""Decimetres: MakeHuman's teeth hide behind the upper lip; incisors should reach just below where the lips meet."""

LID_PIXELS = 400
"""Pixels a decimetre in the picture in which the middle of the open lids is looked for."""
SLIT = 0.3
"""Where lids stand open by less than this share of their greatest opening, they are a corner."""
ASIDE = 0.6
"""Share of the way to the middle of the lids that eyes are turned aside: an iris sits a little to the nose of it."""


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


def build_head(person: Person, ingredients: Ingredients, blink: float = 1.0) -> Head:
    """The head of ``person``.

    ``blink`` scales the eyeBlink shapes, which close some faces further than shut.
    """
    base, groups = load_base(ingredients.mpfb / "3dobjs" / "base.obj")
    count = len(base.vertices)
    body = base.vertices + sum(
        weight * load_target(ingredients.mpfb / "targets" / f"{path}.target.gz", count)
        for path, weight in person.targets.items()
    )
    units = (
        np.stack([load_target(ingredients.face_units / f"{name}.target", count) for name in NAMES])
        * np.array([GAIN.get(name, 1.0) * person.gain.get(name, 1.0) for name in NAMES])[:, None, None]
    )
    is_flesh = np.zeros(count, bool)
    is_flesh[np.unique(base.quads[groups == "body"])] = True
    for side in ("Left", "Right"):
        units[NAMES.index(f"eyeBlink{side}")] *= blink
        for name, (lent, share) in LID_FOLLOWS.items():
            units[NAMES.index(name + side)] += share * units[NAMES.index(lent + side)]
    jaw_open = units[NAMES.index("jawOpen")]
    arch = np.where(is_flesh[:, None], arching(body, jaw_open), 0)
    jaw_open = units[NAMES.index("jawOpen")] = jaw_open + arch
    units[NAMES.index("mouthClose")] -= arch
    for name, shape in PURSES.items():
        unit = units[NAMES.index(name)]
        units[NAMES.index(name)] = np.where(is_flesh[:, None], pursed(shape, unit, body, jaw_open), unit)
    rest = sum(weight * units[NAMES.index(name)] for name, weight in person.rest.items())
    for side in ("Left", "Right"):  # at rest the corners are lifted, not drawn apart
        smile = sum(share * units[NAMES.index(name + side)] for name, share in SMILE.items())
        units[NAMES.index(f"mouthSmile{side}")] = smile

    is_body = groups == "body"
    crown = body[np.unique(base.quads[is_body]), 1].max()
    kept = is_body & (body[base.quads].mean(1)[:, 1] > crown - CROP_BELOW_CROWN)
    used, index = np.unique(base.quads[kept], return_inverse=True)
    coarse = QuadMesh(body[used], base.texture, index.reshape(-1, 4), base.texture_quads[kept])
    matrix, fine = subdivide(coarse)

    flesh = hollowed(body + rest, base, _inside_mouth(base, is_flesh, ingredients))
    proxy_root = ingredients.makehuman / "proxies"
    proxies: list[tuple[int, Proxy]] = [
        (EYES, _without_cornea(load_proxy(proxy_root / "eyes/HighPolyEyes/HighPolyEyes.json"), proxy_root)),
        (TEETH, load_proxy(proxy_root / "teeth/Teeth_Base/Teeth_Base.json")),
        (TONGUE, load_proxy(proxy_root / "tongue/tongue01/tongue01.json")),
        (LASHES, load_proxy(proxy_root / "eyelashes/eyelashes02/eyelashes02.json")),
        (HAIR, load_proxy(proxy_root / f"hair/{person.hair.proxy}/{person.hair.proxy}.json")),
    ]
    vertices = [matrix @ flesh[used]]
    deltas = [np.stack([matrix @ unit[used] for unit in units])]
    average = [matrix @ base.vertices[used]]
    triangles = [triangulate(fine.quads)]
    texture = [fine.texture[triangulate(fine.texture_quads)]]
    parts = [np.full(len(triangles[0]), SKIN)]
    start = len(vertices[0])
    eye_start = start
    for part, proxy in proxies:
        binding = proxy.binding(count)
        rigid = part in (EYES, HAIR)
        moves = np.zeros((len(NAMES), len(proxy.refs), 3)) if rigid else np.stack([binding @ u for u in units])
        fitted = proxy.fit(body if rigid else flesh)
        jaw = np.linalg.norm(moves[NAMES.index("jawOpen")], axis=1) > 1e-3
        if part == TEETH:
            fitted[:, 1] -= np.where(jaw, LOWER_TEETH_DROP, UPPER_TEETH_DROP)
        elif part == TONGUE:
            fitted += TONGUE_SHIFT
        faces, paint, typical = proxy.triangles, proxy.texture, proxy.fit(base.vertices)
        if part == TEETH:
            arches = make_arches(fitted, jaw)
            moves = carried(fitted, moves, jaw, arches)
            fitted, faces, paint = arches.vertices, arches.triangles, arches.texture
            typical = make_arches(typical, jaw).vertices
        vertices.append(fitted)
        deltas.append(moves)
        average.append(typical)
        triangles.append(faces + start)
        texture.append(paint)
        parts.append(np.full(len(faces), part))
        start += len(fitted)
    points = np.concatenate(vertices)
    eye_count = len(proxies[0][1].refs)
    faces = np.concatenate(triangles)
    eye_of_vertex = np.full(len(points), -1, np.int8)
    in_eye = slice(eye_start, eye_start + eye_count)
    eye_of_vertex[in_eye] = (points[in_eye, 0] < 0).astype(np.int8)
    part_of = np.concatenate(parts)
    side_of = eye_of_vertex[np.unique(faces[part_of == EYES])]
    centers = np.stack([_sphere_center(points[in_eye][eye_of_vertex[in_eye] == side]) for side in (0, 1)])
    radius = float(np.median(np.linalg.norm(points[np.unique(faces[part_of == EYES])] - centers[side_of], axis=1)))
    origin = _between_ears(base, body, is_body, ingredients)
    lid = np.full(len(points), -1, np.int8)
    for side, center in enumerate(centers):
        reach = np.linalg.norm(points[:eye_start] - center, axis=1)
        in_front = points[:eye_start, 2] > center[2]
        lid[:eye_start][(reach > radius) & (reach < 1.6 * radius) & in_front] = side
    average_eyes = base.vertices[np.unique(base.quads[np.char.endswith(groups, "-eye")])].mean(0)
    glints = _glint_triangles(centers, radius)
    points = np.concatenate([points, glints])
    faces = np.concatenate([faces, start + np.arange(len(glints)).reshape(-1, 3)])
    part_of = np.concatenate([part_of, np.full(len(glints) // 3, GLINTS)])
    texture.append(np.zeros((len(glints) // 3, 3, 2)))
    deltas.append(np.zeros((len(NAMES), len(glints), 3)))
    eye_of_vertex = np.append(eye_of_vertex, np.full(len(glints), -1, np.int8))
    lid = np.append(lid, np.full(len(glints), -1, np.int8))
    average.append(np.tile(average_eyes, (len(glints), 1)))
    all_average = np.concatenate(average)
    axes = _aimed_eyes(points, faces[part_of <= EYES], eye_of_vertex, centers, radius)
    return Head(
        vertices=((points - origin) / 10).astype(np.float32),
        deltas=(np.concatenate(deltas, 1) / 10).astype(np.float32),
        triangles=faces,
        texture=np.concatenate(texture).astype(np.float32),
        parts=part_of.astype(np.uint8),
        canvas=((all_average - average_eyes) / 10).astype(np.float32),
        eye_centers=((centers - origin) / 10).astype(np.float32),
        eye_axes=axes.astype(np.float32),
        eye_radius=radius / 10,
        eye_of_vertex=eye_of_vertex,
        lid_of_vertex=lid,
        lip_rim=np.searchsorted(used, (CORNER, MIDDLE, LOWER)),
    )


def _between_ears(base: QuadMesh, body: Floats, is_body: NDArray[np.bool_], ingredients: Ingredients) -> Floats:
    """The middle of the ears as MakeHuman's mask marks them."""
    mask = load_map(ingredients.mpfb / "textures" / "mpfb_ears.jpg")
    quads = np.flatnonzero(is_body)
    marked = sample_map(mask, base.texture[base.texture_quads[quads]].mean(1))[:, 0] > 0.5
    ears = body[np.unique(base.quads[quads[marked]])]
    return np.array([0.0, *ears.mean(0)[1:]])


def _inside_mouth(base: QuadMesh, is_flesh: NDArray[np.bool_], ingredients: Ingredients) -> Floats:
    """[V] in [0, 1]: the walls of the mouth as MakeHuman's mask marks them."""
    mask = load_map(ingredients.mpfb / "textures" / "mpfb_inside-mouth.jpg")
    inside = np.zeros(len(base.vertices))
    inside[base.quads] = sample_map(mask, base.texture[base.texture_quads].reshape(-1, 2))[:, 0].reshape(-1, 4)
    return inside * is_flesh


def _without_cornea(eyes: Proxy, proxy_root: Path) -> Proxy:
    """The eye proxy without its clear outer shell, whose texture is transparent."""
    alpha = sample_map(load_map(proxy_root / "eyes/HighPolyEyes/textures/brown_eye.png"), eyes.texture.mean(1))[:, 3]
    return replace(eyes, triangles=eyes.triangles[alpha > 0.5], texture=eyes.texture[alpha > 0.5])


def _sphere_center(points: Floats) -> Floats:
    """Centre [3] of the sphere nearest to ``points`` [P, 3] (linear least squares)."""
    system = np.concatenate([2 * points, np.ones((len(points), 1))], 1)
    return np.linalg.lstsq(system, (points**2).sum(1), rcond=None)[0][:3]


def _glint_triangles(centers: Floats, radius: float) -> Floats:
    """Corners [2 eyes x 2 lamps x 3, 3] of small triangles that touch the eyeballs where the lamps are mirrored."""
    corners = []
    for center in centers:
        for toward in np.array(GLINTS_TOWARD):
            unit = toward / np.linalg.norm(toward)
            x = np.cross([0, 1.0, 0], unit)
            y = np.cross(unit, x)
            middle = center + 1.015 * radius * unit
            corners += [middle + 0.01 * (np.cos(a) * x + np.sin(a) * y) for a in (0, 2 * np.pi / 3, 4 * np.pi / 3)]
    return np.array(corners)


def _aimed_eyes(
    points: Floats, faces: NDArray[np.int64], eye_of_vertex: NDArray[np.int8], centers: Floats, radius: float
) -> Floats:
    """Directions [2, 3] from the eyeballs' centres towards the middle of the open lids, seen from the front.

    Some identities droop or widen the lids away from the eyeballs' middles; pupils that stayed level would look up, and
    such that look straight ahead would squint at one's nose.
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
    level = np.array([0, centers[0, 1], 0])
    seen, _, _ = see(points - level, faces, camera)
    side_of_face = np.where(seen >= 0, eye_of_vertex[faces[np.maximum(seen, 0), 0]], -1)
    axes = []
    for side, center in enumerate(centers - level):
        shown = side_of_face == side
        if not shown.any():
            axes.append([0.0, 0, 1])
            continue
        # the corners taper to slits that no iris fills
        open_columns = np.flatnonzero(shown.sum(0) > SLIT * shown.sum(0).max())
        rows = np.flatnonzero(shown.any(1))
        across = 0.5 * (open_columns[0] + open_columns[-1] + 1) - 256
        height = 128 - 0.5 * (rows[0] + rows[-1] + 1)
        turn = np.clip(ASIDE * (across / LID_PIXELS - center[0]) / radius, -0.15, 0.15)
        tilt = np.clip(0.8 * (height / LID_PIXELS - center[1]) / radius + 0.02, -0.3, 0.3)
        axis = np.array([np.sin(turn), np.sin(tilt), 1.0])
        axes.append(axis / np.linalg.norm(axis))
    return np.array(axes)
