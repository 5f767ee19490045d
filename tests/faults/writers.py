"""Everything that the program writes, in two versions each, and how a reader takes it."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from fractions import Fraction
from pathlib import Path

import cv2
import numpy as np
from gemheads.app.desk.settings import Settings, load_settings, save_settings
from gemheads.app.files.pictures import write_png
from gemheads.app.files.sinks import FolderSink, is_whole
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.tracks import Track, load_track, save_track
from gemheads.app.performing.weights import WeightsTrack, load_weights, save_weights
from gemheads.app.person.profiles import load_profile, profile_path, save_profile
from gemheads.app.person.restface import Resting
from gemheads.app.reenacting.reports import write_report
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.neutral import NeutralChoice
from gemheads.models.gem import CHANNELS, MODALITIES, Basis, Gem, Viewing
from gemheads.models.gemfile import load_gem, save_gem
from gemheads.models.ply import load_ply, save_ply
from gemheads.render.gaussians import RawGaussians

SIZE = 4000
"""Splats, frames or pixels: enough that writing takes a while."""
PICTURES = 6


@dataclass(frozen=True)
class Written:
    """One kind of result."""

    name: str
    write: Callable[[Path, int], object]
    """Writes version 0 or 1 of it to a path."""
    read: Callable[[Path], int]
    """The version that is there; raises what the reader raises where it is none."""


def avatar(name: str = "tiny", colour: float = 0.5) -> Gem:
    """A ball of SIZE splats with three components a modality."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(SIZE, 3))
    means = {
        "position": 0.1 * points / np.linalg.norm(points, axis=1, keepdims=True),
        "rotation": np.tile([1.0, 0, 0, 0], (SIZE, 1)),
        "scale": np.full((SIZE, 3), np.log(0.008)),
        "opacity": np.full((SIZE, 1), 3.0),
    }
    bases = {}
    for modality in MODALITIES:
        rows = np.vstack([means[modality].reshape(1, -1), rng.normal(0, 0.01, (3, SIZE * CHANNELS[modality]))])
        bases[modality] = Basis(rows.astype(np.float32), np.full(3, 0.5, np.float32))
    return Gem(
        name=name,
        bases=bases,
        colors=np.full((SIZE, 3), colour, np.float32),
        neck_weights=np.ones(SIZE, np.float32),
        neck_pivot=np.zeros(3, np.float32),
        uv_index=np.zeros((SIZE, 2), np.uint16),
        uv_size=8,
        viewing=Viewing((0.0, 0.0, 0.0), 0.25),
        arkit_weights=np.zeros((52, 12), np.float32),
    )


def _gem(path: Path, version: int) -> None:
    save_gem(avatar(str(version), version), path)


def _read_gem(path: Path) -> int:
    gem = load_gem(path)
    return int(gem.name) if gem.colors.max() == gem.colors.min() == int(gem.name) else -1


def _track(path: Path, version: int) -> None:
    poses = (Pose(np.full(50, version, np.float32), np.zeros(3, np.float32)),) * SIZE
    save_track(Track("tiny", "0", Fraction(1, 30), Fraction(30), np.arange(SIZE), poses), path)


def _read_track(path: Path) -> int:
    values = {int(pose.coefficients[place]) for pose in load_track(path).poses for place in (0, -1)}
    return values.pop() if len(values) == 1 else -1


def _weights(path: Path, version: int) -> None:
    moves = np.full((SIZE, 52), version, np.float32), np.zeros((SIZE, 3), np.float32)
    save_weights(WeightsTrack("nod", Fraction(1, 30), np.arange(SIZE), *moves), path)


def _read_weights(path: Path) -> int:
    weights = load_weights(path).weights
    return int(weights[0, 0]) if (weights == weights[0, 0]).all() else -1


def _ply(path: Path, version: int) -> None:
    parts = (np.full((SIZE, width), version, np.float32) for width in (3, 4, 3))
    colours = np.full((SIZE, 3), version, np.float32)
    save_ply(RawGaussians(*parts, np.full(SIZE, version, np.float32), colours), path)


def _read_ply(path: Path) -> int:
    logits = load_ply(path).opacity_logits
    return int(logits[0]) if (logits == logits[0]).all() else -1


def _settings(path: Path, version: int) -> None:
    said = save_settings(Settings(avatar="x" * 5000, camera=str(version)), path)
    if said:
        raise OSError(said)


def _read_settings(path: Path) -> int:
    settings, complaint = load_settings(path)
    assert not complaint
    return int(settings.camera)


def _profile(path: Path, version: int) -> None:
    choice = NeutralChoice(0, 0.0, np.full(DIMENSION, version, np.float32), np.zeros(3), "", ())
    save_profile("camera", Resting(choice, np.zeros(DIMENSION, np.float32), 0.0, ""), date(2026, 1, 2), path.parent)
    profile_path("camera", path.parent).replace(path)


def _read_profile(path: Path) -> int:
    profile = load_profile("camera", path.parent) if path.name == profile_path("camera").name else None
    assert profile is not None
    assert profile.choice is not None
    return int(profile.choice.features[0])


def _report(path: Path, version: int) -> None:
    write_report(path, {"version": version, "long": "x" * 50_000}, [])


def _read_report(path: Path) -> int:
    return int(json.loads(path.read_text())["settings"]["version"])


def _png(path: Path, version: int) -> None:
    write_png(np.full((400, 400, 3), version, np.uint8), path)


def _read_png(path: Path) -> int:
    image = cv2.imread(str(path))
    assert image is not None
    return int(image[-1, -1, 0])


def _folder(path: Path, version: int) -> None:
    sink = FolderSink(path, Fraction(1, 30), resume=False)
    for index in range(PICTURES):
        sink.write(index, np.full((64, 64, 3), version, np.uint8), index)
    sink.close(True)


def _read_folder(path: Path) -> int:
    if not is_whole(path):
        raise FileNotFoundError(path)
    named = [line.split(",")[0] for line in (path / "times.csv").read_text().splitlines()[1:]]
    versions = {_read_png(path / name) for name in named}
    return versions.pop() if len(versions) == 1 and len(named) == PICTURES else -1


WRITTEN = (
    Written("a.gem", _gem, _read_gem),
    Written("a.track", _track, _read_track),
    Written("a.weights", _weights, _read_weights),
    Written("a.ply", _ply, _read_ply),
    Written("live.toml", _settings, _read_settings),
    Written(profile_path("camera", Path()).name, _profile, _read_profile),
    Written("report.json", _report, _read_report),
    Written("sheet.png", _png, _read_png),
    Written("pictures", _folder, _read_folder),
)
"""All of them; videos have tests of their own."""
