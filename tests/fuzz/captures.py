"""A small capture of a person, whose list of pictures or template is mutated."""

import io
import zipfile
from pathlib import Path
from random import Random

import numpy as np
from gemheads.models.captures.layout import TEMPLATE, Template, transforms_name
from gemheads.models.captures.reader import open_capture
from gemheads.models.captures.writer import CaptureWriter
from gemheads.render.camera import Camera, look_at

from .damage import damaged

SIDE = 32


def _written(folder: Path) -> Path:
    writer = CaptureWriter(folder)
    corners = np.float32([[0, 0, 0], [0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    uv = np.float32([[0, 0], [1, 0], [0, 1], [1, 1]])
    parts = np.zeros(2, np.uint8)
    template = Template(corners, faces, uv, faces, np.ones(4, np.float32), np.zeros(3, np.float32), parts, ("skin",))
    writer.begin(template)
    camera = Camera(40.0, 40.0, SIDE / 2, SIDE / 2, SIDE, SIDE, look_at([0, 0, 1], [0, 0, 0]))
    shots = [writer.shot(moment, 0, camera) for moment in range(2)]
    for shot in shots:
        writer.write_picture(shot, np.zeros((SIDE, SIDE, 3), np.uint8), np.full((SIDE, SIDE), 255, np.uint8))
        writer.write_mesh(shot.timestep, corners, np.zeros(3), np.zeros(3), np.zeros(52))
    writer.finish({"train": shots}, {"subject": "nobody", "background": [1, 1, 1]})
    return folder


def transforms(folder: Path) -> bytes:
    """The list of pictures of a capture that lies in the folder."""
    return (_written(folder) / transforms_name("train")).read_bytes()


def template(folder: Path) -> bytes:
    """The template of a capture that lies in the folder."""
    return (_written(folder) / TEMPLATE).read_bytes()


def read(path: Path) -> None:
    """The whole capture that ``path`` belongs to."""
    capture = open_capture(path.parent)
    for split in ("train", "val", "test"):
        for shot in capture.shots(split):
            capture.read(shot)
            capture.tracked(shot.timestep)
    assert np.isfinite(capture.viewing().head_height)


def mutated_npz(content: bytes, rng: Random) -> bytes:
    """One mutation: of the bytes, or of arrays in an archive whose checksums fit."""
    if rng.random() < 0.3:
        return damaged(content, rng)
    packed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as old, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as new:
        chosen = rng.choice(old.namelist())
        for name in old.namelist():
            body = old.read(name)
            if name == chosen:
                match rng.randrange(4):
                    case 0:
                        continue
                    case 1:
                        body = body[:128] + body[128:] * rng.choice((0, 2, 1000))
                    case _:
                        body = damaged(body, rng)
            new.writestr(zipfile.ZipInfo(name), body, zipfile.ZIP_DEFLATED)  # of one date: the same bytes again
    return packed.getvalue()
