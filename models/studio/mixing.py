"""What lies between the corners of a triangle, for compiled loops.

Written into the loop: a function that is called there with a tuple of arrays takes longer than what it does.
"""

from typing import Any, NamedTuple

import numba
import numpy as np


class Spot(NamedTuple):
    """A place on a triangle, and how it is looked at."""

    triangle: Any
    corners: Any
    """[3] vertices."""
    shares: Any
    """[3] how much of the place is each corner's."""
    u: Any
    """In the map of the part, as is ``v``."""
    v: Any
    point: Any
    """[3] metres."""
    normal: Any
    """[3] unit."""
    to_eye: Any
    """[3] unit."""


@numba.njit(cache=True, inline="always")
def mixed(values, corners, shares, channel):
    """One channel of ``values`` [V, n] at three corners, of each as much as its share."""
    return (
        values[corners[0], channel] * shares[0]
        + values[corners[1], channel] * shares[1]
        + values[corners[2], channel] * shares[2]
    )


@numba.njit(cache=True, inline="always")
def mixed_vector(values, corners, shares):
    """The same of three channels."""
    return mixed(values, corners, shares, 0), mixed(values, corners, shares, 1), mixed(values, corners, shares, 2)


@numba.njit(cache=True, inline="always")
def unit(vector, least):
    """The vector at length 1; one shorter than ``least`` stays short."""
    x, y, z = vector
    scale = 1 / max(np.sqrt(x * x + y * y + z * z), least)
    return x * scale, y * scale, z * scale


@numba.njit(cache=True, inline="always")
def dot(one, other):
    """Of two vectors."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
