"""A number in the pixels of a picture: what left a source is recognised where it arrives."""

import numpy as np
from numpy.typing import NDArray

BITS = 16
NUMBERS = 1 << BITS
CELLS = BITS + 4
"""White, black, the bits from the highest on, the parity that makes the count of ones even, black."""
ACROSS = 32
"""A cell's side is this part of the picture's width: it survives scaling."""


def stamp(image: NDArray[np.uint8] | NDArray[np.float32], number: int) -> None:
    """Draws ``number`` modulo NUMBERS into the top left corner of a picture [H, W, 3|4], opaque.

    Bytes in 0..255 or floats in 0..1. Raises ValueError for pictures narrower than ACROSS pixels.
    """
    side = image.shape[1] // ACROSS
    if side < 1:
        raise ValueError(f"a picture {image.shape[1]} pixels wide is too narrow for a stamp; give {ACROSS} or more")
    full = 255 if np.issubdtype(image.dtype, np.integer) else 1
    row = np.repeat(np.array(cells_of(number)) * full, side)
    image[:side, : CELLS * side, :3] = row[None, :, None]
    image[:side, : CELLS * side, 3:] = full


def cells_of(number: int) -> list[int]:
    """The CELLS of a number, 0 black and 1 white."""
    bits = [number >> shift & 1 for shift in reversed(range(BITS))]
    return [1, 0, *bits, sum(bits) % 2, 0]


def cell_centres(left: float, top: float, width: float, mirrored: bool = False) -> tuple[NDArray[np.int64], int]:
    """Where to look on a screen that shows the picture ``width`` pixels wide: columns [CELLS], and the row."""
    along = (np.arange(CELLS) + 0.5) / ACROSS * width
    return np.floor(left + (width - along if mirrored else along)).astype(np.int64), int(top + width / ACROSS / 2)


def read(lumas: NDArray[np.generic]) -> int | None:
    """The number of CELLS brightnesses in 0..255; None when they are no stamp."""
    bits = (np.asarray(lumas, np.float64) > 127).astype(int).tolist()
    number = sum(bit << shift for bit, shift in zip(bits[2 : 2 + BITS], reversed(range(BITS)), strict=True))
    return number if bits == cells_of(number) else None
