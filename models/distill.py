"""Distillation: an ensemble of Gaussians of one head becomes a linear basis per modality (section 3.2 of the paper)."""

import tempfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..render.gaussians import RawGaussians
from ..render.rotations import sign_aligned
from .gem import CHANNELS, MODALITIES, Basis

BLOCK_BYTES = 32 * 2**20
"""How much of the ensemble is in memory at a time; short sums also keep float32 products exact enough."""
SIGMA_FLOOR = 5e-4
"""Components whose spread is below this share of the first one's are left out: the Gram matrix is of float32 products,
whose rounding (1e-7 of the variance) shows as spreads up to 3e-4."""


@dataclass(frozen=True)
class Distilled:
    """What an ensemble of frames was reduced to."""

    bases: dict[str, Basis]
    """One Basis per modality of MODALITIES; a modality that does not move has no component."""
    variance_kept: dict[str, NDArray[np.float64]]
    """Modality -> [K] share of the variance that the first 1, 2, ... K components keep, cumulative."""
    frames: int
    """F, how many frames there were."""
    colors: NDArray[np.float32]
    """[N, 3] the mean colour of each splat."""


def distill(frames: Iterable[RawGaussians], components: int | Mapping[str, int] = 50) -> Distilled:
    """PCA per modality in raw space, in bounded memory.

    The frames go once, in turn, into memory-mapped files in the temporary folder. Each modality's F x F Gram matrix is
    summed over blocks of columns; its eigenvectors give the components of the plain SVD (method of snapshots).
    Quaternions q and -q are one rotation: each is given the sign nearest to its splat's in the first frame.

    Args:
        frames: F frames of the same N splats, from any source; consumed once.
        components: how many to keep, for all modalities or for each.

    Raises:
        ValueError: without a frame, or where a frame has another number of splats or a value that is not finite.
    """
    wanted: Mapping[str, int] = components if isinstance(components, Mapping) else dict.fromkeys(MODALITIES, components)
    with tempfile.TemporaryDirectory(prefix="gemheads-distill-") as folder:
        # a function of its own: a folder with files that are still mapped cannot be removed on Windows
        return _distilled(iter(frames), wanted, Path(folder))


def _distilled(frames: Iterator[RawGaussians], wanted: Mapping[str, int], folder: Path) -> Distilled:
    ensembles, colors, count = _written(frames, folder)
    bases: dict[str, Basis] = {}
    kept: dict[str, NDArray[np.float64]] = {}
    for name in MODALITIES:
        bases[name], kept[name] = _principal(ensembles[name], count, wanted[name])
    return Distilled(bases, kept, count, colors)


def _written(
    frames: Iterator[RawGaussians], folder: Path
) -> tuple[dict[str, NDArray[np.float32]], NDArray[np.float32], int]:
    first: RawGaussians | None = None
    colors = np.zeros((0, 3))
    files = {name: (folder / name).open("wb") for name in MODALITIES}
    count = 0
    try:
        for frame in frames:
            if first is None:
                first, colors = frame, np.zeros((len(frame), 3))
            if len(frame) != len(first):
                raise ValueError(f"frame {count} has {len(frame)} splats, the first has {len(first)}")
            wxyz = sign_aligned(frame.wxyz, first.wxyz)
            values = (frame.positions, wxyz, frame.log_scales, frame.opacity_logits)
            for name, value in zip(MODALITIES, values, strict=True):
                block = np.ascontiguousarray(value, np.float32)
                if not np.isfinite(block).all():
                    raise ValueError(f"frame {count} has a {name} that is not finite")
                files[name].write(block.tobytes())
            colors += frame.colors
            count += 1
    finally:
        for file in files.values():
            file.close()
    if first is None:
        raise ValueError("nothing to distill: there is no frame")
    ensembles: dict[str, NDArray[np.float32]] = {
        name: np.memmap(folder / name, np.float32, "r", shape=(count, len(first) * CHANNELS[name]))
        for name in MODALITIES
    }
    return ensembles, (colors / count).astype(np.float32), count


def _principal(ensemble: NDArray[np.float32], frames: int, wanted: int) -> tuple[Basis, NDArray[np.float64]]:
    width = ensemble.shape[1]
    step = max(1, BLOCK_BYTES // (4 * frames))
    blocks = [slice(start, min(width, start + step)) for start in range(0, width, step)]
    mean = np.empty(width, np.float32)
    gram = np.zeros((frames, frames))
    for block in blocks:
        columns = np.asarray(ensemble[:, block])
        mean[block] = columns.mean(0, dtype=np.float64)
        centred = columns - mean[block]
        gram += centred @ centred.T
    values, vectors = np.linalg.eigh(gram)
    values, vectors = np.maximum(values[::-1], 0), vectors[:, ::-1]
    sigma = np.sqrt(values / max(1, frames - 1))
    # the noise floor of float32 products, so that a modality that never moves has no component at all
    floor = max(SIGMA_FLOOR * float(sigma[0]), 1e-6 * float(np.sqrt(np.mean(mean.astype(np.float64) ** 2)) + 1e-12))
    used = int(min(wanted, frames - 1, np.count_nonzero(sigma > floor)))
    share = np.cumsum(values[:used]) / max(float(values.sum()), 1e-30)
    rows = np.empty((used + 1, width), np.float32)
    rows[0] = mean
    lift = (vectors[:, :used] / np.sqrt(values[:used])).T.astype(np.float32)
    for block in blocks:
        rows[1:, block] = lift @ (np.asarray(ensemble[:, block]) - mean[block])
    _orthonormalise(rows[1:], blocks)
    for row in rows[1:]:
        # eigenvectors have no sign of their own: with the largest entry positive the same data gives the same file
        row *= np.sign(row[np.abs(row).argmax()])
    return Basis(rows, sigma[:used].astype(np.float32)), share


def _orthonormalise(components: NDArray[np.float32], blocks: list[slice]) -> None:
    """Gram-Schmidt in place, by the Cholesky factor of the components' own Gram matrix: removes float32 rounding."""
    gram = np.zeros((len(components), len(components)))
    for block in blocks:
        columns = components[:, block].astype(np.float64)
        gram += columns @ columns.T
    if len(components):
        inverse = np.linalg.inv(np.linalg.cholesky(gram))
        for block in blocks:
            components[:, block] = inverse @ components[:, block].astype(np.float64)
