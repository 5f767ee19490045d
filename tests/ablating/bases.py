"""Linear models of rows: one PCA for each modality, one for all, or one whose coefficients drive all.

All are plain: every frame in memory, double precision, the singular value decomposition of NumPy.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from gemheads.models.gem import CLAMP_SIGMAS
from gemheads.render.arrays import Floats
from numpy.typing import NDArray

from .spaces import Row

FLOOR = 5e-4
"""Components whose spread is below this share of the first one's are left out, as in ``models.distill``."""


@dataclass(frozen=True)
class Linear:
    """x = mean + k @ components for each modality."""

    means: Row
    """[W] of each modality."""
    components: tuple[Floats, ...]
    """[K, W] of each."""
    reading: tuple[Floats, ...]
    """[W, K] of each: what a deviation of this modality says of the coefficients that move it."""
    sigma: tuple[Floats, ...]
    """[K] of each; where coefficients are shared, the same vector four times."""
    shared: bool
    """Whether one vector of coefficients moves all modalities; then what they say of it is summed."""

    def answer(self, row: Row) -> Row:
        """The nearest row that the model knows."""
        told = [(x - mean) @ read for x, mean, read in zip(row, self.means, self.reading, strict=True)]
        if self.shared:
            told = [sum(told[1:], told[0])] * len(told)
        return tuple(mean + k @ basis for mean, k, basis in zip(self.means, told, self.components, strict=True))

    def drawn(self, rng: np.random.Generator) -> Row:
        """A row whose coefficients are drawn evenly from what a regressor may answer: +-3 sigma."""
        told = [CLAMP_SIGMAS * sigma * rng.uniform(-1, 1, len(sigma)) for sigma in self.sigma]
        if self.shared:
            told = told[:1] * len(told)
        return tuple(mean + k @ basis for mean, k, basis in zip(self.means, told, self.components, strict=True))

    @property
    def numbers(self) -> int:
        """Numbers in all components."""
        return sum(basis.size for basis in self.components)

    @property
    def count(self) -> int:
        """Coefficients of a frame."""
        return len(self.sigma[0]) if self.shared else sum(map(len, self.sigma))


def one_each(rows: Sequence[Row], components: int) -> Linear:
    """Equation 1 as the product takes it: a PCA, and coefficients, for each modality."""
    parts = [principal(ensemble, components) for ensemble in _ensembles(rows)]
    means, bases, sigma = zip(*parts, strict=True)
    return Linear(means, bases, tuple(basis.T for basis in bases), sigma, shared=False)


def joint(rows: Sequence[Row], components: int) -> Linear:
    """One PCA over all modalities, each divided by the root mean square of its motion: none counts more by its unit."""
    ensembles = _ensembles(rows)
    spreads = [max(float(np.sqrt(np.mean((x - x.mean(0)) ** 2))), 1e-12) for x in ensembles]
    wide = np.concatenate([x / spread for x, spread in zip(ensembles, spreads, strict=True)], 1)
    mean, basis, sigma = principal(wide, components)
    ends = np.cumsum([x.shape[1] for x in ensembles])[:-1]
    pieces = list(zip(np.split(mean, ends), np.split(basis, ends, axis=1), spreads, strict=True))
    return Linear(
        tuple(piece * spread for piece, _, spread in pieces),
        tuple(piece * spread for _, piece, spread in pieces),
        tuple(piece.T / spread for _, piece, spread in pieces),
        (sigma,) * len(pieces),
        shared=True,
    )


def led_by_positions(rows: Sequence[Row], components: int) -> Linear:
    """The positions' PCA; its coefficients drive the other modalities, too, by least squares over the frames."""
    positions, *others = _ensembles(rows)
    mean, basis, sigma = principal(positions, components)
    told = (positions - mean) @ basis.T
    followers = [np.linalg.lstsq(told, x - x.mean(0), rcond=None)[0] for x in others]
    return Linear(
        (mean, *(x.mean(0) for x in others)),
        (basis, *followers),
        (basis.T, *(np.zeros_like(follower.T) for follower in followers)),
        (sigma,) * (1 + len(others)),
        shared=True,
    )


def principal(ensemble: Floats, components: int) -> tuple[Floats, Floats, Floats]:
    """Mean [W], components [K, W] and their spreads [K] of rows [F, W]; fewer where there is no more motion."""
    mean = ensemble.mean(0)
    _, values, axes = np.linalg.svd(ensemble - mean, full_matrices=False)
    sigma = values / np.sqrt(max(1, len(ensemble) - 1))
    used = min(components, len(ensemble) - 1, int(np.count_nonzero(sigma > FLOOR * max(sigma[0], 1e-12))))
    return mean, axes[:used], sigma[:used]


def off_orthonormal(bases: Sequence[NDArray[np.floating]]) -> float:
    """The largest entry of |B B^T - 1| over bases [K, W]."""
    worst = 0.0
    for basis in bases:
        if len(basis):
            gram = basis.astype(np.float64) @ basis.astype(np.float64).T
            worst = max(worst, float(np.abs(gram - np.eye(len(basis))).max()))
    return worst


def _ensembles(rows: Sequence[Row]) -> list[Floats]:
    return [np.stack(values) for values in zip(*rows, strict=True)]
