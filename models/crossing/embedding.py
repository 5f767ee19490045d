"""How alike expressions are by an embedding: the columns of Table 3 of the paper, on the tracker's own embedding.

The paper takes EmoNet's features; here it is what the landmark network of the face tracker knows of a picture [512],
each person's relative to that person's own neutral. Figures of the two are not comparable.
"""

from dataclasses import dataclass

import numpy as np

from ...render.arrays import Floats

_LEAST = 1e-12


@dataclass(frozen=True)
class Agreement:
    """Of a driver's and an avatar's embeddings over F frames."""

    cosine: float
    """Mean over frames of the cosine between both, in [-1, 1]: larger is better. Frames in which the driver's is zero,
    as at his own neutral, have no direction to follow and are left out; an avatar's that is zero counts as 0."""
    chance: float
    """The same, of the same frames, each of the driver paired with every one of the avatar: what is no merit."""
    l1: float
    """Mean over frames and values of the absolute difference, in the network's own units: smaller is better."""
    frechet: float
    """Fréchet distance between both as clouds, frames unpaired: smaller is better."""


def agreement(driver: Floats, avatar: Floats) -> Agreement:
    """Compares embeddings [F, E] of the same frames, each relative to its own neutral. Raises ValueError for none."""
    if not len(driver) or driver.shape != avatar.shape:
        raise ValueError(
            f"embeddings {list(driver.shape)} and {list(avatar.shape)}: the same frames of both are needed"
        )
    driver, avatar = np.asarray(driver, np.float64), np.asarray(avatar, np.float64)
    somewhere = np.linalg.norm(driver, axis=1) > _LEAST
    a, b = _directions(driver[somewhere]), _directions(avatar[somewhere])
    count = max(len(a), 1)
    return Agreement(
        cosine=float((a * b).sum() / count),
        chance=float(a.sum(0) @ b.sum(0) / count**2),
        l1=float(np.abs(driver - avatar).mean()),
        frechet=frechet(driver, avatar),
    )


def frechet(one: Floats, other: Floats) -> float:
    """Fréchet distance between normal distributions of the means and covariances of two clouds [F, E] and [G, E].

    |m - m'|^2 + tr(C + C' - 2 (C C')^(1/2)), Heusel et al. 2017. With X and X' centred and scaled so that C = X^T X,
    the last trace is the sum of the singular values of X X'^T: no root of an E x E matrix, and exact with few frames.
    Of many frames the triangles of X = QR and X' = Q'R' are enough, since Q and Q' change no singular value.
    """
    x, y = (np.asarray(cloud, np.float64) for cloud in (one, other))
    apart = ((x.mean(0) - y.mean(0)) ** 2).sum()
    x, y = ((cloud - cloud.mean(0)) / np.sqrt(max(len(cloud) - 1, 1)) for cloud in (x, y))
    common = np.linalg.svd(np.linalg.qr(x, "r") @ np.linalg.qr(y, "r").T, compute_uv=False).sum()
    return float(max(apart + (x**2).sum() + (y**2).sum() - 2 * common, 0.0))


def _directions(embeddings: Floats) -> Floats:
    return embeddings / np.maximum(np.linalg.norm(embeddings, axis=1, keepdims=True), _LEAST)
