"""About which axes a portrait's head has to turn, so that its turn is read as its driver's is.

The face tracker reads the turn of a face against its line of sight, and a face stands below the middle of its portrait:
whoever turns aside seems to tilt a little as well, whoever tilts, to turn. That is the turn about axes that lean
forward: to one side and by a few degrees on each of five heads, so a matter of the tracker and the portrait.
``tests/bench/nodding.py --heads`` prints by how much on which; here are the means.

How a driver turns is read about the axes of the driver's own head (``features.relative_rotation``), since nobody says
how that camera stands. These lean, too, as far as the tracker reads a head that looks straight ahead as looking up or
down: the two that were made of people's faces, and six clips of people in the mean, as far as a portrait does.
"""

import cv2
import numpy as np

from ...render.arrays import Floats

LEAN_DEG = 3.2
"""By which the axes lean: who looks aside by 20 degrees seems to tilt by 1.1."""
YAW_LOST = 0.17
"""How much less of a yaw is read for a radian by which the head looks down, more where it looks up."""
MOST_LOST = 0.05
"""No pitch takes more of a yaw: that of 17 degrees, so far as heads were turned when that was measured."""
_UPRIGHT = np.asarray(cv2.Rodrigues(np.array([-np.radians(LEAN_DEG), 0, 0]))[0], np.float64)


def drawn_turn(read: Floats) -> Floats:
    """The turn [3] with which to draw a head, so that ``read`` [3] is read on it; rotation vectors in radians."""
    drawn = _UPRIGHT @ np.asarray(read, np.float64)
    drawn[1] *= 1 + np.clip(YAW_LOST * drawn[0], -MOST_LOST, MOST_LOST)
    return drawn
