"""The ARKit weights of a capture's training moments: those of all, or none and the reason."""

import numpy as np
from numpy.typing import NDArray

from .reader import Capture

_UNDRIVEN = "so only tracks and a regressor drive it"


def training_weights(capture: Capture) -> tuple[NDArray[np.float32] | None, tuple[str, ...]]:
    """[F, 52] in order of time, without a note; None where a moment has none, with a note that says which one.

    Raises CaptureError where a file changed since the capture was opened.
    """
    weights = {moment: capture.tracked(moment).arkit for moment in capture.timesteps("train")}
    known = [row for row in weights.values() if row is not None]
    lacking = [capture.meshes[moment].name for moment, row in weights.items() if row is None]
    if not lacking:
        return np.stack(known), ()
    if not known:
        return None, (f"it has no ARKit weights, {_UNDRIVEN}",)
    more = f" and {len(lacking) - 1} more have" if len(lacking) > 1 else " has"
    return None, (f"{lacking[0]}{more} no ARKit weights as the other meshes do, {_UNDRIVEN}",)
