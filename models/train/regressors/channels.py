"""What training compares between a person and the avatar: scores, gaze and distances, in units of tolerance."""

import numpy as np
from numpy.typing import NDArray
from torch import Tensor, cat

from ...driver.features import BLOCKS, DIMENSION, SCORE_NAMES, SCORES
from ...driver.gaze import GAZE
from ...driver.measures import MEASURES

GAZE_TOLERANCE = 0.05
"""Radians; twice the noise of the irises under a shift of the crop."""
MEASURE_TOLERANCE = 0.12
"""Centimetres; the spread of the distances under a shift of the crop and a small turn."""
BROW_TOLERANCE = 0.05
"""The same for heights of brows: they follow the brows where the scores hardly move."""
LIP_TOLERANCE, PARTED, AGAPE_TOLERANCE = 1 / 30, 0.3, 0.08
"""The same for the distance of lips that part: one sees at once whether they do, and the score of the jaw wakes only
when a mouth is well open. What is beyond so many centimetres counts less: how far a mouth is open is said by the jaw as
well, and avatars do not show as much of their teeth as people."""
SCORE_TOLERANCE = 0.06
"""Share of a full expression."""
CLOSE = {
    **dict.fromkeys(("browDownLeft", "browDownRight"), 0.005),
    **dict.fromkeys(("browInnerUp", "mouthPucker"), 0.008),
    **dict.fromkeys(("eyeBlinkLeft", "eyeBlinkRight"), 0.01),
    "jawOpen": 0.004,
    **dict.fromkeys(("mouthSmileLeft", "mouthSmileRight"), 0.02),
    "mouthFunnel": 0.025,
    **dict.fromkeys(("mouthLowerDownLeft", "mouthLowerDownRight"), 0.02),
    **dict.fromkeys((f"eyeLook{way}{side}" for way in ("Out", "In", "Up", "Down") for side in ("Left", "Right")), 0.03),
}
"""The same for what people look at first when they judge whether an avatar follows: brows and pucker move little on any
face, and all of these would lose against the many landmarks that contradict them a little. The jaw's score is next to
nothing until lips part by 3 mm: only counted as finely as this, small jaws outvote lips that stay closed. The score of
a lowered lower lip wakes late, too: avatars parted their lips for a grin by the jaw and the upper lip."""
UNTRUSTED_SCORES = (
    "mouthClose",
    "mouthShrugUpper",
    "mouthRollUpper",
    "mouthRollLower",
    "cheekSquintLeft",
    "cheekSquintRight",
)
"""These read the resting shape of the lips more than what they do."""
TRUSTED_MEASURES = ("lip_gap", "mouth_width", "right_lid_gap", "left_lid_gap", "right_inner_brow", "left_inner_brow",
                    "right_middle_brow", "left_middle_brow", "right_outer_brow", "left_outer_brow", "mouth_side",
                    "right_corner_height", "left_corner_height")  # fmt: skip


def channel_indices() -> NDArray[np.int64]:
    """[T] the places in a feature vector of the T compared channels."""
    scores = [SCORES.start + i for i, name in enumerate(SCORE_NAMES) if name not in UNTRUSTED_SCORES]
    gaze = [BLOCKS["gaze"].start + i for i in range(len(GAZE))]
    measures = [BLOCKS["measures"].start + MEASURES.index(name) for name in TRUSTED_MEASURES]
    return np.array(scores + gaze + measures)


def mouth_channels() -> NDArray[np.bool_]:
    """[T] which of them say what the mouth and the jaw do."""
    names = np.array([*SCORE_NAMES, *MEASURES])
    places = np.r_[np.arange(SCORES.start, SCORES.stop), np.arange(BLOCKS["measures"].start, BLOCKS["measures"].stop)]
    of_mouth = [name.startswith(("jaw", "mouth", "lip", "left_corner", "right_corner")) for name in names]
    return np.isin(channel_indices(), places[of_mouth])


def channel_tolerances() -> NDArray[np.float32]:
    """[T] how far apart two channels may be before it counts, in the unit of each."""
    tolerances = np.full(DIMENSION, SCORE_TOLERANCE, np.float32)
    for name, tolerance in CLOSE.items():
        tolerances[SCORES.start + SCORE_NAMES.index(name)] = tolerance
    tolerances[BLOCKS["gaze"]] = GAZE_TOLERANCE
    brows = ["brow" in name for name in MEASURES]
    tolerances[BLOCKS["measures"]] = np.where(brows, BROW_TOLERANCE, MEASURE_TOLERANCE)
    tolerances[BLOCKS["measures"].start + MEASURES.index("lip_gap")] = LIP_TOLERANCE
    return tolerances[channel_indices()]


def felt(channels: Tensor) -> Tensor:
    """Channels [..., T], in tolerances, as far as each counts: distances of lips beyond PARTED less."""
    lips = channels[..., _LIPS : _LIPS + 1]
    near = lips.clamp(-PARTED / LIP_TOLERANCE, PARTED / LIP_TOLERANCE)
    counted = near + LIP_TOLERANCE / AGAPE_TOLERANCE * (lips - near)
    return cat([channels[..., :_LIPS], counted, channels[..., _LIPS + 1 :]], -1)


_LIPS = int(np.flatnonzero(channel_indices() == BLOCKS["measures"].start + MEASURES.index("lip_gap"))[0])
"""The place of the lips' distance among the channels."""
