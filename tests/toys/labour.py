"""What workers are given in tests: they find it here by name, wherever the tests are run from."""

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numba
import torch
from gemheads.models.train.workers import Workers

LONG = 60.0
"""Seconds at least that whoever goes on is at work, unless stopped."""


def square(advance: Callable[[], None], number: int, last: float = 0) -> tuple[int, int]:
    time.sleep(last)
    advance()
    return number * number, os.getpid()


def threads(advance: Callable[[], None], _: int) -> tuple[int, int, int]:
    return torch.get_num_threads(), numba.get_num_threads(), cv2.getNumThreads()


def troubled(advance: Callable[[], None], how: str) -> None:
    if how == "dies":
        os._exit(1)
    if how == "fails":
        raise ValueError("more than it can bear")
    for _ in range(round(10 * LONG)):
        time.sleep(0.1)
        advance()


def told(advance: Callable[[], None], note: str) -> None:
    Path(note).with_suffix(f".{os.getpid()}").touch()
    troubled(advance, "goes on")


if __name__ == "__main__":
    with Workers(2) as workers:
        workers.each(told, [(sys.argv[1],)] * 2)
