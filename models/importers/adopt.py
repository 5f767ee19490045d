"""From somebody else's avatar to a GEM of our own."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from math import ceil, sqrt
from shutil import disk_usage

import numpy as np
from numpy.typing import NDArray

from ...render.gaussians import RawGaussians
from ..distill import Distilled, distill
from ..gem import CHANNELS, CLAMP_SIGMAS, MAX_COMPONENTS, MAX_SPLATS, Basis, Gem
from ..gemlayout import MAX_EXPANDED_BYTES
from ..heads.atlas import lay_out
from .source import Source

Progress = Callable[[str, int, int], None]
"""Told the stage, how many frames of it are done, and how many there are."""
_FRAME_BYTES = 4 * sum(CHANNELS.values())


class TooLargeError(ValueError):
    """More splats, frames or components than can be distilled: says how many can."""


def adopt(
    source: Source,
    name: str,
    components: int = 50,
    about: Mapping[str, str] | None = None,
    progress: Progress = lambda stage, done, total: None,
) -> tuple[Gem, Distilled]:
    """Distil a source into an avatar, in bounded memory: its frames are asked for twice, and wait on the disk once.

    Args:
        source: what an importer read.
        name: what people call the avatar.
        components: how many to keep of each modality, 1 to MAX_COMPONENTS.
        about: author, licence, consent, source.
        progress: is told after each frame.

    Raises:
        TooLargeError: before anything is computed.
        ValueError: where the importer's frames are unfit.
    """
    _check_size(source, components)
    distilled = distill(_told(source, "read", progress), components)
    side = ceil(sqrt(source.splats)) if source.uv_index is None else source.uv_size
    texels = source.uv_index
    if texels is None:
        texels = lay_out(source.rest.positions, np.zeros(source.splats, int), side)
    gem = Gem(
        name=name,
        bases=distilled.bases,
        colors=np.ascontiguousarray(distilled.colors, np.float32),
        neck_weights=source.neck_weights,
        neck_pivot=source.neck_pivot,
        uv_index=texels,
        uv_size=side,
        viewing=source.viewing,
        about=dict(about or {}),
    )
    rest = gem.project(source.rest)
    gem = replace(gem, bases=_reaching(gem, rest))
    if source.performance is None:
        return replace(gem, rest=rest), distilled
    change = np.stack([gem.project(frame) - rest for frame in _told(source, "answer", progress)])
    arkit = _least_squares(source.performance, change)
    return replace(gem, rest=rest, arkit_weights=arkit), distilled


def _reaching(gem: Gem, rest: NDArray[np.float32]) -> dict[str, Basis]:
    """The bases, their sigma so large that the expression at rest is within three of them: coefficients are clamped
    there, and a rest that was seen in few of many frames lies farther out."""
    bases = {}
    for name, basis in gem.bases.items():
        needed = np.abs(rest[gem.slices[name]]) / np.float32(0.999 * CLAMP_SIGMAS)
        bases[name] = Basis(basis.rows, np.maximum(basis.sigma, needed))
    return bases


def _told(source: Source, stage: str, progress: Progress) -> Iterator[RawGaussians]:
    for done, frame in enumerate(source.frames(), 1):
        yield frame
        progress(stage, done, source.count)


def _check_size(source: Source, components: int) -> None:
    if not 1 <= components <= MAX_COMPONENTS:
        raise TooLargeError(f"{components} components cannot be kept; choose from 1 to {MAX_COMPONENTS}")
    if source.splats > MAX_SPLATS:
        raise TooLargeError(f"{source.splats} splats are more than the {MAX_SPLATS} of an avatar")
    most = MAX_EXPANDED_BYTES // (_FRAME_BYTES * source.splats) - 1
    if min(components, max(1, source.count - 1)) > most:  # frames have no more than that
        raise TooLargeError(f"{source.splats} splats can have {most} components at most; give --components {most}")
    needed, free = _FRAME_BYTES * source.splats * source.count, disk_usage(tempfile.gettempdir()).free
    if needed > 0.9 * free:
        raise TooLargeError(
            f"{source.count} frames of {source.splats} splats take {needed / 1e9:.1f} GB in {tempfile.gettempdir()},"
            f" where {free / 1e9:.1f} GB are free; give fewer frames, or set TMPDIR to a larger place"
        )


def _least_squares(weights: NDArray[np.float32], change: NDArray[np.float32]) -> NDArray[np.float32]:
    """[52, coefficients] minimising |weights @ map - change|^2; zero for weights that are never used."""
    known = weights.astype(np.float64)
    gram = known.T @ known + 1e-3 * np.eye(known.shape[1])
    return np.linalg.solve(gram, known.T @ change).astype(np.float32)
