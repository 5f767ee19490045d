"""Whether a face can be taken as its rest right now, and if not, what its owner can do about it."""

from dataclasses import dataclass

import numpy as np

from ...models.driver.features import BLOCKS, score
from ...models.driver.measures import MEASURES
from ..performing.shots import Observed
from .hints import BACKLIT, BACKLIT_FACE, BLURRED, DARK

MOST_TURN_DEG = 12.0
"""Of the head to the side, up and down."""
MOST_TILT_DEG = 8.0
FACE_HEIGHT = (0.25, 0.70)
"""Least and most height of the face, in heights of the picture."""
BRIGHT = 0.95
"""Luma of a face that is burnt out."""
LEAST_RATE = 12.0
"""Frames a second; fewer do not fill the moment of collecting."""
LEAST_PRESENCE = 0.7
MOST_LIP_GAP = 0.4
"""Centimetres between the lips; a face at rest has below 0.2."""
MOST_SMILE = 0.6
"""Mean score of both mouth corners: a face at rest has 0 to 0.3."""


@dataclass(frozen=True)
class Coaching:
    """What stands in the way, the most important first."""

    sentences: tuple[str, ...]
    """Each one plain sentence that says what to do."""

    @property
    def green(self) -> bool:
        """Whether nothing does."""
        return not self.sentences


def coach(observed: Observed | None, rate: float) -> Coaching:
    """What to do until this face can be taken; ``rate``: frames a second that the camera delivers."""
    if observed is None:
        return Coaching(("Sit so that the camera sees your face.",))
    return Coaching(tuple(sentence for wrong, sentence in (*_place(observed), *_picture(observed, rate)) if wrong))


def _place(observed: Observed) -> tuple[tuple[bool, str], ...]:
    """Where the face is, and what it does."""
    pitch, yaw, roll = np.degrees(observed.rotation)
    height = (observed.box_px[3] - observed.box_px[1]) / observed.picture_size[1]
    smile = float(score(observed.features, "mouthSmileLeft") + score(observed.features, "mouthSmileRight")) / 2
    return (
        (observed.faces > 1, "Be alone in the picture for a moment."),
        (height < FACE_HEIGHT[0], "Come closer, until your face fills a third of the picture."),
        (height > FACE_HEIGHT[1], "Move back a little: your face fills the picture."),
        (yaw > MOST_TURN_DEG, "Turn your head a little to your right, until it faces the camera."),
        (yaw < -MOST_TURN_DEG, "Turn your head a little to your left, until it faces the camera."),
        (pitch > MOST_TURN_DEG, "Lift your chin a little, or lower the camera."),
        (pitch < -MOST_TURN_DEG, "Lower your chin a little, or raise the camera."),
        (abs(roll) > MOST_TILT_DEG, "Hold your head upright."),
        (_measure(observed, "lip_gap") > MOST_LIP_GAP, "Close your mouth."),
        (smile > MOST_SMILE, "Relax your face: no smile for this one."),
    )


def _picture(observed: Observed, rate: float) -> tuple[tuple[bool, str], ...]:
    """How well the camera sees it."""
    backlit = observed.surround - observed.luma > BACKLIT and observed.luma < BACKLIT_FACE
    return (
        (observed.luma < DARK, "It is too dark: put a lamp in front of you."),
        (observed.luma > BRIGHT, "It is too bright: turn the lamp away from your face."),
        (backlit, "The light comes from behind: turn round, or close the curtain."),
        (observed.sharpness < BLURRED, "The picture is blurred: wipe the lens, or give more light."),
        (observed.presence < LEAST_PRESENCE, "Nothing may cover your face."),
        (rate < LEAST_RATE, "The camera is slow: give more light, or choose a smaller picture."),
    )


def _measure(observed: Observed, name: str) -> float:
    return float(observed.features[BLOCKS["measures"]][MEASURES.index(name)])
