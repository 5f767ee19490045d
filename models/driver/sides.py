"""What of a face is believed to be on one side only.

Who turns his head seems to raise the brow on the side that turns away, and to press his lips and dimple his cheek on
the other, whatever his face does: some people several times as much as the avatars of which networks learn what a turn
adds. Lips and cheeks that do that on one side only are rare, and read so by chance. A single brow is raised often, and
read well from the front. ``tests/bench/sides.py`` measures all that.

A turn shifts what the network says of a score, before it becomes a share of 0 to 1, up on one side and down on the
other. So the sides' mean is taken there: of lips that read as pressed by .02 on both sides, and by .15 and .02 as the
head turns, the mean of the shares would say .09, which a photoreal head did by turning alone; this says .06.
"""

import numpy as np
from numpy.typing import NDArray

from .points import SCORES

FRONTAL_RAD = np.radians(5.0)
"""Of a head that is turned aside so far, half of what distinguishes its brows is believed; of one that is turned by
twice as much, a fifth."""
_FAINTEST = 1e-4
"""Scores below it, and as near to 1, count as that, for their logits would be without end."""


def _halves(*names: str) -> NDArray[np.intp]:
    return np.array([[SCORES.index(name + side) for side in ("Left", "Right")] for name in names])


_TOGETHER = _halves("mouthPress", "mouthDimple")
_BROWS = _halves("browOuterUp")


def believed_sides(scores: NDArray[np.float32], yaw: float) -> NDArray[np.float32]:
    """Scores [52] of a head turned aside by ``yaw`` (radians, against the camera), on the left and on the right side as
    far as they are believed to differ."""
    believed = scores.copy()
    for halves, share in ((_TOGETHER, 0.0), (_BROWS, 1 / (1 + (yaw / FRONTAL_RAD) ** 2))):
        both = _of_both(scores[halves])
        believed[halves] = both + share * (scores[halves] - both)
    return believed


def _of_both(scores: NDArray[np.float32]) -> NDArray[np.float32]:
    """[N, 1] the mean of scores [N, 2], by their logits."""
    shares = np.clip(scores, _FAINTEST, 1 - _FAINTEST)
    return 1 / (1 + np.exp(-np.log(shares / (1 - shares)).mean(1, keepdims=True)))
