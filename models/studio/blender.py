"""Blender as a Python module, where it is installed: found, imported and run without its chatter."""

import importlib
import importlib.util
import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class BlenderError(Exception):
    """Blender that is missing or does not start: what, and the cure."""


CURE = "run pip install bpy==5.0.1 on Python 3.11 (other versions of bpy are for other Pythons), or --renderer studio"


def require_blender() -> None:
    """Raises BlenderError where ``bpy`` is not installed; imports nothing."""
    if importlib.util.find_spec("bpy") is None:
        raise BlenderError(f"--renderer cycles: Blender's module bpy is not installed; {CURE}")


def blender() -> Any:
    """The module ``bpy``. Raises BlenderError where it is missing or broken."""
    require_blender()
    try:
        # its sound module, which is not needed here, complains about NumPy 2 in many lines
        with interruptible(), quiet(), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return importlib.import_module("bpy")
    except ImportError as error:
        raise BlenderError(f"--renderer cycles: bpy does not start ({error}); {CURE}") from error


@contextmanager
def interruptible() -> Iterator[None]:
    """Ctrl-C inside raises KeyboardInterrupt at the end: raised within Blender's own Python it would be swallowed."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heard: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _: heard.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before or signal.default_int_handler)
    if heard:
        raise KeyboardInterrupt


@contextmanager
def quiet() -> Iterator[None]:
    """Stdout and stderr go nowhere: Blender reports each step from C, past ``sys.stdout``."""
    kept: list[tuple[int, int]] = []
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for stream, number in ((sys.stdout, 1), (sys.stderr, 2)):
            stream.flush()
            kept.append((number, os.dup(number)))
            os.dup2(nowhere, number)
        yield
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        for number, copy in kept:
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)
