"""What engines draw, as bytes: over a background, or with straight alpha."""

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from .compiling import DEEP, FLAT, compile_ahead


def over(image: NDArray[np.float32], background: ArrayLike, out: NDArray[np.uint8] | None = None) -> NDArray[np.uint8]:
    """A premultiplied picture [H, W, 4] over one colour (sRGB-encoded RGB in [0, 1]), as bytes [H, W, 3]."""
    if out is None:
        out = np.empty((*image.shape[:2], 3), np.uint8)
    _over(image, np.asarray(background, np.float32), out)
    return out


def to_rgba8(image: NDArray[np.float32]) -> NDArray[np.uint8]:
    """A premultiplied picture [H, W, 4] as bytes [H, W, 4] with straight alpha, as PNG wants it."""
    alpha = np.clip(image[..., 3:], 0, 1)
    color = np.where(alpha > 0, image[..., :3] / np.maximum(alpha, 1e-6), 0)
    return (np.concatenate([np.clip(color, 0, 1), alpha], -1) * 255 + 0.5).astype(np.uint8)


def warm() -> None:
    """Compile what lays pictures over a background, or load it from disk, without running it."""
    compile_ahead(_over, DEEP, FLAT, numba.types.Array(numba.uint8, 3, "C"))


@numba.njit(cache=True, parallel=True)
def _over(image: NDArray[np.float32], background: NDArray[np.float32], out: NDArray[np.uint8]) -> None:
    for y in numba.prange(image.shape[0]):
        for x in range(image.shape[1]):
            rest = np.float32(1) - image[y, x, 3]
            for c in range(3):
                value = (image[y, x, c] + rest * background[c]) * np.float32(255) + np.float32(0.5)
                out[y, x, c] = np.uint8(min(max(value, np.float32(0)), np.float32(255)))
