"""Making a basis small for its file: splats that hardly move left out, components as int8 or fp16."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .gem import CHANNELS, CLAMP_SIGMAS, Basis

UNSEEN = {"position": 20e-6, "rotation": 0.01, "scale": 0.02, "opacity": 0.05}
"""A splat that moves less than this at three sigma of every component together (m, quaternion, ln m, logit) is taken
to stand still: a fiftieth of a pixel, one degree, two per cent of its size, one per cent of its opacity."""
_STEPS = 127


@dataclass(frozen=True)
class Compact:
    """The components of one modality as they are stored."""

    kept: NDArray[np.uint32]
    """[M] the splats that move, rising."""
    values: NDArray[Any]
    """[K, M, C] int8 or float16."""
    scale: NDArray[np.float32]
    """[K] what one unit of each component's values means; 1 for float16."""


def compact(modality: str, basis: Basis, kind: str) -> Compact:
    """The components of a basis as ``kind`` "int8" or "fp16".

    Compacting what ``expand`` gives changes nothing: the splats kept are those that move visibly after rounding, and
    scales have 16 significant bits, so that 127 of them are an exact float32.

    Raises ValueError where a component is not finite.
    """
    if not np.isfinite(basis.components).all():
        raise ValueError(f"the {modality} basis has components that are not finite")
    splats = basis.rows.shape[1] // CHANNELS[modality]
    components = basis.components.reshape(len(basis), splats, CHANNELS[modality])
    kept = np.flatnonzero(_moves(modality, components, basis.sigma))
    while True:
        values, scale = _rounded(components[:, kept], kind)
        seen = _moves(modality, _restored(values, scale), basis.sigma)
        if seen.all():
            return Compact(kept.astype(np.uint32), values, scale)
        kept = kept[seen]


def expand(stored: Compact, out: NDArray[np.float32]) -> None:
    """Writes components into ``out`` [K, N * C], which holds zeros."""
    channels = stored.values.shape[2]
    target = out.reshape(len(out), out.shape[1] // channels, channels)
    for row, values, scale in zip(target, stored.values, stored.scale, strict=True):
        row[stored.kept] = values.astype(np.float32) * scale


def _moves(modality: str, components: NDArray[np.float32], sigma: NDArray[np.float32]) -> NDArray[np.bool_]:
    """[N] whether each splat moves visibly. Summed component by component: the same for any choice of other splats."""
    motion = np.zeros(components.shape[1])
    for row, spread in zip(components, sigma, strict=True):
        step = CLAMP_SIGMAS * float(spread) * row.astype(np.float64)
        for channel in range(step.shape[1]):
            motion += step[:, channel] ** 2
    return motion >= UNSEEN[modality] ** 2


def _rounded(components: NDArray[np.float32], kind: str) -> tuple[NDArray[Any], NDArray[np.float32]]:
    count = len(components)
    if kind == "fp16":
        return components.astype(np.float16), np.ones(count, np.float32)
    flat = components.reshape(count, components.shape[1] * components.shape[2])
    scale = _sixteen_bits(np.abs(flat).max(1, initial=0).astype(np.float64) / _STEPS)
    return np.rint(components / scale[:, None, None]).astype(np.int8), scale


def _sixteen_bits(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """The next number at or above each that has 16 significant bits; 1 for those too small for a normal float32."""
    mantissa, exponent = np.frexp(values)
    rounded = np.ldexp(np.ceil(mantissa * 2**16) / 2**16, exponent)
    return np.where(values < 1e-30, 1, rounded).astype(np.float32)


def _restored(values: NDArray[Any], scale: NDArray[np.float32]) -> NDArray[np.float32]:
    return values.astype(np.float32) * scale[:, None, None]
