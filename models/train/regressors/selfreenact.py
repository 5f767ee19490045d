"""Self-reenactment: a person's avatar driven by pictures of that person that nothing was learned from."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....render.arrays import Floats32
from ...captures.reader import Capture
from ...captures.standin import StandIn
from ...driver.regressor import Regressor
from ...gem import Gem
from ...metrics.pixels import psnr
from ...metrics.structure import ssim
from ..deck import spaced
from ..synthesis.fit import error_map
from ..synthesis.fitcapture import fit_moments
from .sightings import Neutral, Sightings, frontal_cameras, see

MOMENTS = 24
"""Held-out moments that are judged, spaced over all."""
STRIP = 8
"""Of them, in the picture."""
ROWS = ("rest", "driven", "fitted")
"""The avatar at rest, by its regressor, and fitted to the pictures: the floor, the figure, the ceiling."""


@dataclass(frozen=True)
class SelfReenactment:
    """Figures of pictures that the tracker saw; the head stands as the capture's tracking says, for all rows."""

    psnr: dict[str, float]
    """Row -> decibels."""
    ssim: dict[str, float]
    missed: float
    """Share of the fitted coefficients' motion (position, about rest) that the regressor misses: 0 is perfect, 1 is
    what staying at rest gets."""
    pictures: int
    unseen: int
    """Pictures in which the tracker saw no face; they are not counted."""
    strip: NDArray[np.uint8]
    """[5 H, STRIP W, 3] from above: the person, at rest, driven, fitted, and where driven differs from the person."""


def self_reenactment(
    gem: Gem,
    capture: Capture,
    neutral: Neutral,
    progress: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> SelfReenactment:
    """Drives ``gem``, which has a regressor, with the frontal cameras of the test split.

    Raises ValueError where it shows no face, or the avatar has no regressor.
    """
    regressor = Regressor.of(gem)
    cameras = frontal_cameras(capture, "test")
    shots = [shot for shot in capture.shots("test") if shot.camera_index in cameras]
    front = next((c for c in cameras if any(shot.camera_index == c for shot in shots)), -1)
    judged = {shot.timestep for shot in spaced([shot for shot in shots if shot.camera_index == front], MOMENTS)}
    shots = [shot for shot in shots if shot.timestep in judged]
    seen = see(capture, shots, neutral, lambda done, total: progress("held out", done, total))
    if not len(seen):
        raise ValueError(f"the tracker sees no face in the test pictures of {capture.folder}")
    driven = [
        np.asarray(regressor(f, r).coefficients, np.float32) for f, r in zip(seen.features, seen.rotations, strict=True)
    ]
    fitted: dict[int, Floats32] = {}
    for moment in fit_moments(gem, capture, shots):
        fitted[moment.timestep] = moment.fit.coefficients
        progress("fit", len(fitted), len(judged))
    return _judged(gem, capture, seen, driven, fitted)


def _judged(
    gem: Gem, capture: Capture, seen: Sightings, driven: list[Floats32], fitted: dict[int, Floats32]
) -> SelfReenactment:
    standin = StandIn(capture)
    values: dict[str, list[tuple[float, float]]] = {row: [] for row in ROWS}
    columns: list[NDArray[np.uint8]] = []
    in_front = next(c for c in frontal_cameras(capture, "test") if any(shot.camera_index == c for shot in seen.shots))
    shown = {shot.picture for shot in spaced([s for s in seen.shots if s.camera_index == in_front], STRIP)}
    for shot, coefficients in zip(seen.shots, driven, strict=True):
        truth = standin.truth(shot)
        images = [truth]
        for row, k in zip(ROWS, (gem.rest_coefficients, coefficients, fitted[shot.timestep]), strict=True):
            image = standin.draw(gem.compose(k), gem.neck_weights, gem.neck_pivot, shot)
            values[row].append((psnr(image, truth), ssim(image, truth)))
            images.append(image)
        if shot.picture in shown:
            cells = [np.round(255 * image).astype(np.uint8) for image in images]
            columns.append(np.concatenate([*cells, error_map(images[2], truth)]))
    means = {row: np.mean(pairs, 0) for row, pairs in values.items()}
    part = gem.slices["position"]
    wanted = np.stack([fitted[shot.timestep][part] for shot in seen.shots])
    got = np.stack([k[part] for k in driven])
    moved = np.square(wanted - gem.rest_coefficients[part]).sum()
    return SelfReenactment(
        {row: float(pair[0]) for row, pair in means.items()},
        {row: float(pair[1]) for row, pair in means.items()},
        float(np.square(got - wanted).sum() / max(moved, 1e-12)),
        len(driven),
        seen.unseen,
        np.concatenate(columns, 1),
    )
