"""A person as one small file for the studio: a mesh that ARKit weights pose, a UV map, what its surfaces are like."""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..captures.uvraster import cover
from ..wholefile import write_whole
from .bake import PIVOT, neck_weights, viewing_of
from .creases import creases
from .haircap import capped
from .head import Head, build_head
from .ingredients import Ingredients
from .maps import encoded, linear, load_map
from .noise import value_noise
from .people import Person
from .shading import Shader, hair_texture, make_shader
from .skin import points_of
from .soup import HAIR, LASHES, SKIN
from .strands import LASH_END
from .subjectfile import DELTA_M, SHEEN_RANGE
from .unwrap import Unwrapped, unwrap

MAP_SIZE = 1024
VERTEX_M = 1e-6
JPEG_QUALITY = 90
PART_NAMES = ("skin", "eyes", "teeth", "tongue")


@dataclass(frozen=True)
class _Pieces:
    """Which vertices and triangles go into the file, the tracked ones first."""

    unwrapped: Unwrapped
    loose: NDArray[np.int64]
    """[L] triangles of hair and lashes."""
    vertices: NDArray[np.int64]
    """[V] of the head's vertices."""
    tracked: int
    """So many of them belong to the template."""
    renumbered: NDArray[np.int64]
    """[head's vertices] their new numbers, -1 for those left out."""


def save_subject(person: Person, ingredients: Ingredients, path: Path) -> None:
    """Build a person and write the file that ``models.studio.subject`` reads. Raises OSError."""
    head = build_head(person, ingredients)
    shader = make_shader(person, head, ingredients)
    head = capped(head)
    pieces = _pieces(head)
    arrays: dict[str, Any] = _mesh(head, pieces) | _maps(shader, pieces.unwrapped) | _cards(person, ingredients)
    viewing = viewing_of(head)
    arrays["viewing"] = np.array([*viewing.target, viewing.head_height], np.float32)
    arrays["hair_color"] = np.array([person.hair.color, person.hair.tip], np.float32)
    arrays["brow_color"] = np.array(person.brow_color, np.float32)
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, [packed.getvalue()])


def _pieces(head: Head) -> _Pieces:
    unwrapped = unwrap(head)
    on_canvas = head.canvas[head.triangles].mean(1)
    upper = (head.parts == LASHES) & (on_canvas[:, 1] > 0) & (np.abs(on_canvas[:, 0]) < LASH_END)
    loose = np.flatnonzero(upper | (head.parts == HAIR))
    tracked = np.unique(head.triangles[unwrapped.faces])
    rest = np.setdiff1d(head.triangles[loose], tracked)
    vertices = np.concatenate([tracked, rest])
    renumbered = np.full(len(head.vertices), -1)
    renumbered[vertices] = np.arange(len(vertices))
    return _Pieces(unwrapped, loose, vertices, len(tracked), renumbered)


def _mesh(head: Head, pieces: _Pieces) -> dict[str, NDArray[Any]]:
    chosen = pieces.vertices
    faces = pieces.unwrapped.faces
    triangles = pieces.renumbered[head.triangles[faces]]
    corners = np.round(pieces.unwrapped.uv.reshape(-1, 2) * 2**16).astype(np.int64)
    rows = np.concatenate([triangles.reshape(-1, 1), corners], 1)
    unique, index = np.unique(rows, axis=0, return_inverse=True)
    part = np.zeros(len(head.vertices), np.uint8)
    part[head.triangles] = head.parts[:, None]
    loose = head.parts[pieces.loose]
    return {
        "vertices": (np.round(head.vertices[chosen] / VERTEX_M) * VERTEX_M).astype(np.float32),
        "deltas": np.round(head.deltas[:, chosen] / DELTA_M).astype(np.int16),
        "tracked": np.array(pieces.tracked),
        "triangles": triangles.astype(np.uint16 if len(chosen) < 2**16 else np.int32),
        "uv": (unique[:, 1:] / 2**16).astype(np.float32),
        "uv_triangles": index.reshape(-1, 3).astype(np.int32),
        "parts": head.parts[faces],
        "part_names": np.array(PART_NAMES),
        "neck_weights": neck_weights(head.vertices[chosen], part[chosen]),
        "neck_pivot": PIVOT,
        "eye_centers": head.eye_centers,
        "eye_axes": head.eye_axes,
        "eye_radius": np.array(head.eye_radius),
        "eye_of_vertex": head.eye_of_vertex[chosen],
        "lid_of_vertex": head.lid_of_vertex[chosen],
        "card_triangles": pieces.renumbered[head.triangles[pieces.loose]].astype(np.int32),
        "card_uv": head.texture[pieces.loose].astype(np.float32),
        "card_is_lash": loose == LASHES,
    }


def _maps(shader: Shader, unwrapped: Unwrapped) -> dict[str, NDArray[Any]]:
    """The atlas: sRGB albedo; and sheen, creases, height of pores in the channels of a second picture."""
    corners = unwrapped.uv.reshape(-1, 2)
    owners, places = cover(corners, np.arange(len(corners)).reshape(-1, 3), MAP_SIZE)
    on = owners >= 0
    faces, weights = unwrapped.faces[owners[on]], places[on].astype(float)
    _, canvas, _ = points_of(shader.head, faces, weights)
    base, sheen = shader.surface(faces, weights)
    skin = shader.head.parts[faces] == SKIN
    outside = skin & (shader.head.texture[faces].mean(1)[:, 1] > 0.15)  # not the walls of the mouth
    base = _browed(base, canvas, shader, outside)
    seed = shader.person.seed
    pores = 0.6 * value_noise(canvas, 1.4e-3, seed + 40) + 0.4 * value_noise(canvas, 0.8e-3, seed + 41)
    detail = np.stack([sheen / SHEEN_RANGE, creases(canvas, seed) * outside, 0.5 + 0.5 * pores * skin], 1)
    pictures = []
    for values in (encoded(base), detail):
        flat = np.zeros((MAP_SIZE, MAP_SIZE, 3), np.uint8)
        flat[on] = np.round(255 * np.clip(values, 0, 1))
        pictures.append(_jpeg(_grown(flat, on)))
    return {"albedo": pictures[0], "detail": pictures[1]}


def _browed(base: Floats, canvas: Floats, shader: Shader, skin: NDArray[np.bool_]) -> Floats:
    """Linear albedo [N, 3] with the brows' hairs drawn on the skin."""
    brows, person = shader.brows, shader.person
    double = brows.at(canvas, "direction")
    angle = 0.5 * np.arctan2(double[:, 1], double[:, 0])
    along = np.stack([np.cos(angle), np.sin(angle)], 1)
    x, y = (canvas[:, :2] * along).sum(1), canvas[:, 1] * along[:, 0] - canvas[:, 0] * along[:, 1]
    hairs = value_noise(np.stack([x / 9, y, 0 * x], 1), 0.55e-3, person.seed + 50)
    cover = np.clip(brows.at(canvas), 0, 1) * np.clip(0.62 + 0.5 * hairs, 0, 1) * skin
    return base + cover[:, None] * (linear(np.array(person.brow_color)) - base)


def _cards(person: Person, ingredients: Ingredients) -> dict[str, NDArray[Any]]:
    """The pictures on hair and lashes: how light, and how opaque."""
    hair = load_map(hair_texture(person, ingredients))
    lash = load_map(ingredients.makehuman / "proxies/eyelashes/eyelashes02/textures/eyelashes02.png")
    answer = {}
    for name, image in (("hair", hair), ("lash", lash)):
        gray = image[..., :3].mean(-1)
        solid = image[..., 3] > 0.3
        level = np.clip(gray / max(float(np.median(gray[solid])), 0.02) / 2, 0, 1)
        flat = _grown(np.repeat(np.round(255 * level)[..., None], 3, -1).astype(np.uint8), solid)
        flat[..., 1] = np.round(255 * image[..., 3])
        answer[name] = _jpeg(flat)
    return answer


def _grown(image: NDArray[np.uint8], on: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Pixels that nothing covers take the colour of the nearest that something does, so that seams do not darken."""
    off = (~on).astype(np.uint8)
    _, label = cv2.distanceTransformWithLabels(off, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    label = np.asarray(label, np.int64)
    colors = np.zeros((label.max() + 1, 3), np.uint8)
    colors[label[on]] = image[on]
    return colors[label]


def _jpeg(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    settings = [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]
    settings += [cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444]
    return np.asarray(cv2.imencode(".jpg", np.ascontiguousarray(image[..., ::-1]), settings)[1]).ravel()
