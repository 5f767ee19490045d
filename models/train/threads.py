"""How many threads compute: torch, numba and OpenCV are told together."""

from collections.abc import Iterator
from contextlib import contextmanager

import cv2
import numba
import torch


@contextmanager
def one_thread() -> Iterator[None]:
    """Computes in one thread, and afterwards in as many as before.

    Sums in another order are other sums, and a search follows them: with one thread each, a figure depends neither
    on how many cores a machine has nor on how many processes share the work.
    """
    before = torch.get_num_threads(), numba.get_num_threads(), cv2.getNumThreads()
    _set(1, 1, 1)
    try:
        yield
    finally:
        _set(*before)


@contextmanager
def one_torch_thread() -> Iterator[None]:
    """The same for torch alone, for networks so small that two threads take a fifth longer than one does."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


def _set(of_torch: int, of_numba: int, of_opencv: int) -> None:
    torch.set_num_threads(of_torch)
    numba.set_num_threads(of_numba)
    cv2.setNumThreads(of_opencv)
