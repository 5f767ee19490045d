"""A capture small enough to learn within seconds: a bowl of a face that talks, seen by five cameras."""

from pathlib import Path

import numpy as np
from gemheads.models.captures.headmotion import posed
from gemheads.models.captures.layout import Template
from gemheads.models.captures.texels import texels_of
from gemheads.models.captures.writer import CaptureWriter
from gemheads.models.posing import pose_head
from gemheads.render.camera import Camera, orbit
from gemheads.render.compositing import over
from gemheads.render.software import SoftwareEngine

SIDE = 17
PARTS = ("skin", "eyes", "teeth")
PIVOT = np.float32([0, -0.08, -0.02])
WHITE = (1.0, 1.0, 1.0)


def template() -> Template:
    """Half an ellipsoid that fills its UV map, with an eye to either side and teeth in the middle below."""
    y, x = (value.ravel() for value in np.mgrid[:SIDE, :SIDE] / (SIDE - 1) * 2 - 1)
    vertices = np.column_stack([0.08 * x, 0.1 * y, 0.09 * np.sqrt(np.maximum(1.05 - 0.5 * (x * x + y * y), 0.05))])
    corner = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)[:-1, :-1].ravel()
    first = np.stack([corner, corner + 1, corner + SIDE + 1], 1)
    second = np.stack([corner, corner + SIDE + 1, corner + SIDE], 1)
    triangles = np.concatenate([first, second]).astype(np.int32)
    middle = vertices[triangles].mean(1) / [0.08, 0.1, 0.09]
    parts = np.zeros(len(triangles), np.uint8)
    parts[np.hypot(np.abs(middle[:, 0]) - 0.4, middle[:, 1] - 0.35) < 0.2] = 1
    parts[np.hypot(middle[:, 0] / 2, middle[:, 1] + 0.4) < 0.15] = 2
    uv = (0.05 + 0.45 * np.stack([x + 1, y + 1], 1)).astype(np.float32)
    share = np.ones(len(vertices), np.float32)
    return Template(vertices.astype(np.float32), triangles, uv, triangles, share, PIVOT, parts, PARTS)


def cameras(size: int) -> list[Camera]:
    angles = ((-30, 0), (0, 10), (30, 0), (0, -15), (15, 5))
    return [orbit((0, 0, 0.04), 0.5, yaw, pitch, 30, size, size) for yaw, pitch in angles]


def write_capture(folder: Path, moments: int = 8, size: int = 64, noise: float = 0.0015) -> Path:
    """Moments that open the mouth and raise the brow, the last quarter of them held out; the last camera too.

    What is drawn knows more than the mesh that was tracked: a texture finer than it, a bump where the mouth opens, and
    ``noise`` metres of tracking noise that the pictures do not show.
    """
    rng = np.random.default_rng(5)
    rest = template()
    writer, engine = CaptureWriter(folder), SoftwareEngine()
    writer.begin(rest)
    texels = texels_of(rest, 80)
    splats = texels.splats(_texture(texels.splats(np.zeros((len(texels), 3))).positions, texels.part))
    shots = {"train": [], "val": [], "test": []}
    for moment in range(moments):
        held_out = moment >= 3 * moments // 4
        jaw, brow = rng.uniform(0, 1, 2)
        still = _expression(rest.vertices, jaw, brow)
        rotation = rng.normal(0, 0.05, 3).astype(np.float32)
        translation = rng.normal(0, 0.002, 3).astype(np.float32)
        drawn = texels.carried(splats, still + _bump(rest.vertices, jaw))
        drawn = pose_head(drawn, texels.spread(rest.neck_weights).astype(np.float32), PIVOT, rotation, translation)
        tracked = still + noise * _smooth_noise(rest.vertices, rng)
        arkit = np.zeros(52, np.float32)
        arkit[[17, 2]] = jaw, brow
        writer.write_mesh(moment, _posed(tracked, rotation, translation), rotation, translation, arkit)
        for index, camera in enumerate(cameras(size)):
            shot = writer.shot(moment, index, camera)
            image = engine.draw(drawn, camera)
            alpha = np.round(255 * image[..., 3]).astype(np.uint8)
            writer.write_picture(shot, over(image, WHITE).copy(), alpha)
            split = "test" if held_out else "val" if index == len(cameras(size)) - 1 else "train"
            shots[split].append(shot)
    writer.finish(shots, {"subject": "toy", "background": WHITE})
    return folder


def _texture(positions: np.ndarray, parts: np.ndarray) -> np.ndarray:
    wave = np.sin(150 * positions[:, :1]) * np.sin(130 * positions[:, 1:2])
    colors = np.array([0.75, 0.55, 0.45]) + 0.12 * wave * [1, 0.5, -0.5]
    colors = np.where((parts == 1)[:, None], [0.2, 0.3, 0.5], colors)
    return np.where((parts == 2)[:, None], [0.9, 0.9, 0.85], colors).astype(np.float32)


def _expression(vertices: np.ndarray, jaw: float, brow: float) -> np.ndarray:
    moved = vertices.astype(np.float64).copy()
    moved[:, 1] += 0.25 * jaw * np.minimum(vertices[:, 1] + 0.03, 0)
    moved[:, 2] += 0.01 * brow * np.exp(-(((vertices[:, 1] - 0.07) / 0.02) ** 2))
    return moved


def _bump(vertices: np.ndarray, jaw: float) -> np.ndarray:
    height = 0.008 * jaw * np.exp(-(((vertices[:, :2] - [0, -0.02]) / 0.02) ** 2).sum(1))
    return height[:, None] * np.array([0, 0, 1.0])


def _smooth_noise(vertices: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    waves = rng.normal(0, 25, (4, 3))
    return np.sin(vertices @ waves.T + rng.uniform(0, 6, 4)) @ rng.normal(0, 0.5, (4, 3))


def _posed(vertices: np.ndarray, rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    return posed(vertices, np.ones(len(vertices)), PIVOT, rotation, translation)
