"""Compiling kernels before they are needed, without running one: safe in a thread while others draw."""

import contextlib
from typing import Any

import numba

FLAT, WIDE, DEEP = (numba.types.Array(numba.float32, dimensions, "C") for dimensions in (1, 2, 3))
"""Types of arrays of float32, of one to three dimensions."""


def compile_ahead(kernel: Any, *types: Any) -> None:
    """Compile what njit returned for arguments of these types, or load it from disk."""
    # what cannot be kept, on a full disk, is compiled all the same
    with contextlib.suppress(OSError):
        kernel.compile(types)  # what njit returns has no type that a checker knows
