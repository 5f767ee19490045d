"""Splats as PLY files, which other viewers open: one expression, or a performance frame by frame."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..models import arkit
from ..models.gem import Gem
from ..models.ply import save_ply, save_ply_sequence
from ..models.posing import pose_head
from ..models.wholefile import file_sha256
from ..render.gaussians import RawGaussians
from .errors import InputError, UsageError, cannot_write
from .files.claim import claimed_folder
from .files.leftovers import take_over
from .files.outputs import keep_inputs
from .performing.casting import check_components, check_track, open_avatar
from .performing.performance import Pose
from .performing.tracks import load_track


def export_expression(avatar: Path, out: Path, weights: list[str], components: int | None = None) -> None:
    """One PLY of the expression with these ``name=value`` ARKit weights; without any, at rest. Raises CommandError."""
    if out.suffix.lower() != ".ply":
        raise UsageError(f"-o {out}: one expression is a .ply file; name one, or give a --track")
    keep_inputs([out], [avatar])
    opened = open_avatar(avatar)
    check_components(opened, components)
    gem = opened.gem
    coefficients = gem.rest_coefficients
    if weights:
        if gem.arkit_weights is None:
            raise InputError(f"{avatar}: knows no ARKit shapes, so --set cannot be used; export a track instead")
        coefficients = gem.clamped(gem.arkit_coefficients(read_weights(weights)))
    splats = _shown(gem, Pose(coefficients, np.zeros(3, np.float32)), components)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        save_ply(splats, out)
    except OSError as error:
        raise cannot_write(out, error) from error


def export_track(avatar: Path, track: Path, out: Path, components: int | None = None) -> None:
    """A folder of numbered PLYs, the head's pose included. Raises CommandError."""
    if out.suffix.lower() == ".ply" and not out.is_dir():
        raise UsageError(f"-o {out}: with --track it is a folder of .ply files; name one, or give no --track")
    keep_inputs([out], [avatar, track])
    opened = open_avatar(avatar)
    check_components(opened, components)
    performance = load_track(track)
    check_track(opened, performance, track)
    made_of = {"avatar": opened.sha256, "track": file_sha256(track), "components": str(components)}
    with claimed_folder(out):
        take_over(out, ".ply", made_of)
        try:
            save_ply_sequence((_shown(opened.gem, pose, components) for pose in performance.poses), out)
        except OSError as error:
            raise cannot_write(out, error) from error


def read_weights(words: list[str]) -> NDArray[np.float32]:
    """[52] ARKit weights of ``name=value`` words; the others are 0. Raises UsageError."""
    weights = np.zeros(len(arkit.NAMES), np.float32)
    for word in words:
        name, _, value = word.partition("=")
        if name not in arkit.NAMES:
            raise UsageError(f"--set {word}: no ARKit shape is called {name!r}; such as jawOpen or mouthSmileLeft")
        try:
            weight = float(value)
        except ValueError:
            weight = float("nan")
        if not -2 <= weight <= 2:
            raise UsageError(f"--set {word}: the weight must be a number from -2 to 2, such as {name}=0.5")
        weights[arkit.NAMES.index(name)] = weight
    return weights


def _shown(gem: Gem, pose: Pose, components: int | None) -> RawGaussians:
    """The splats of an expression, its head where the pose has it."""
    splats = gem.compose(pose.coefficients, components)
    return pose_head(splats, gem.neck_weights, gem.neck_pivot, pose.turn, pose.translation)
