"""What ``gemheads distill`` can be given, and which importer reads it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...models.captures.layout import transforms_name
from ...models.captures.reader import Capture, open_capture
from ...models.heads.performance import perform
from ...models.importers.adopt import Progress
from ...models.importers.baremesh import capture_source
from ...models.importers.foreign import ForeignFormatError
from ...models.importers.gaussianavatars import SPLATS, is_bound, open_bound
from ...models.importers.lam import MESH, load_lam
from ...models.importers.plysequence import MAX_FRAMES, open_sequence, ply_files
from ...models.importers.source import Source
from ..errors import InputError, TrainingExtra, UsageError
from ..words import refuse
from .opencapture import is_capture, is_run, is_unfinished, tell_of_rooms

LEAST_MAPS, MOST_MAPS = 16, 512
FRAMES, MAPS = 600, 128
LEAST_FRAMES = 150
"""A performance shorter than this leaves out single shapes."""


@dataclass(frozen=True)
class Wanted:
    """What the avatar shall be."""

    name: str | None = None
    """None takes the name of the file that is written."""
    components: int = 50
    frames: int | None = None
    """How many expressions a source that ARKit weights drive is asked for; None is FRAMES."""
    seed: int = 0
    """Of the performance."""
    scale: float | None = None
    """Metres of one unit of PLY files; None is 1."""
    maps: int | None = None
    """Texels along a side of the UV map that a capture's splats lie in; None is MAPS."""
    moments: Path | None = None
    """Where to write what the avatar does at each moment of its capture."""
    meshes: Path | None = None
    """Where the mesh of a GaussianAvatars PLY is frame by frame; None looks beside it."""
    about: Mapping[str, str] = field(default_factory=dict)
    """author, licence, consent; empty texts are not stated."""


@dataclass(frozen=True)
class Opened:
    """What is distilled."""

    source: Source
    capture: Capture | None = None
    """Where its frames were taken, when that is known."""


def open_source(place: str, wanted: Wanted, progress: Progress = lambda stage, done, total: None) -> Opened:
    """Read what is there: a capture's bare mesh, a training run, or what the fitting importer reads.

    A folder with ``skin.glb`` (or one folder that has it) is a LAM avatar, a PLY whose splats are bound to triangles
    one of GaussianAvatars, all else a sequence of PLY files.

    Raises UsageError, InputError and ForeignFormatError; CaptureError where a capture changes meanwhile.
    """
    path = Path(place)
    if is_capture(path):
        return _bare_mesh(path, wanted, progress)
    if is_unfinished(path):
        what = f"is an unfinished capture, without {transforms_name('train')}"
        raise InputError(f"{place}: {what}; give the command that makes it again, and it goes on")
    if wanted.moments is not None and not is_run(path):
        raise UsageError(f"{place}: is no capture and no training run, so there are no --moments to write")
    if is_run(path):
        refuse("a training run", frames=wanted.frames, scale=wanted.scale, meshes=wanted.meshes, maps=wanted.maps)
        return _run(path)
    return Opened(_foreign(path, wanted))


def _bare_mesh(path: Path, wanted: Wanted, progress: Progress) -> Opened:
    refuse("a capture", frames=wanted.frames, scale=wanted.scale, meshes=wanted.meshes)
    maps = MAPS if wanted.maps is None else wanted.maps
    if not LEAST_MAPS <= maps <= MOST_MAPS:
        raise UsageError(f"--maps {maps}: choose from {LEAST_MAPS} to {MOST_MAPS}")
    capture = open_capture(path)
    tell_of_rooms(capture)
    return Opened(capture_source(capture, maps, progress), capture)


def _run(path: Path) -> Opened:
    with TrainingExtra("a training run"):
        from ...models.train.avatars.run_source import run_source
        from ...models.train.avatars.runs import RunError, open_run
    try:
        run = open_run(path)
        return Opened(run_source(run), run.capture)
    except RunError as error:
        raise InputError(str(error)) from error


def _foreign(path: Path, wanted: Wanted) -> Source:
    frames = FRAMES if wanted.frames is None else wanted.frames
    scale = 1.0 if wanted.scale is None else wanted.scale
    if not LEAST_FRAMES <= frames <= MAX_FRAMES:
        raise UsageError(f"--frames {frames}: choose from {LEAST_FRAMES} to {MAX_FRAMES}")
    if not 1e-6 <= scale <= 1e6:
        raise UsageError(f"--scale {scale}: give the metres of one of its units, such as 0.01 for centimetres")
    inner = [path, *(sub for sub in sorted(path.iterdir()) if sub.is_dir())] if path.is_dir() else []
    lams = [folder for folder in inner if (folder / MESH).exists()]
    if len(lams) == 1:
        refuse("a LAM avatar", scale=wanted.scale, meshes=wanted.meshes, maps=wanted.maps)
        return load_lam(lams[0]).source(perform(np.random.default_rng(wanted.seed), frames))
    if lams:
        raise UsageError(f"{path}: holds {len(lams)} avatars; give one, such as {lams[0]}")
    deeper = sorted(path.glob(f"*/*/{MESH}")) if path.is_dir() else []
    if deeper and not any(file.suffix.lower() == ".ply" for file in path.iterdir()):
        raise UsageError(f"{path}: holds avatars, but farther down; give one, such as {deeper[0].parent}")
    if path.suffix in (".zip", ".glb", ".gem"):
        raise UsageError(f"{path}: give a folder with {MESH} and offset.ply (unpack a .zip first), or PLY files")
    if path.exists():
        refuse("PLY files", frames=wanted.frames, maps=wanted.maps)
    splats = path / SPLATS if path.is_dir() else path
    if wanted.meshes is not None or (splats.suffix.lower() == ".ply" and splats.is_file() and is_bound(splats)):
        return open_bound(splats, wanted.meshes, scale)
    first = ply_files(path)[0]
    if is_bound(first):
        raise ForeignFormatError(first, "its splats ride on a mesh (GaussianAvatars)", "give this file by itself")
    return open_sequence(path, scale)
