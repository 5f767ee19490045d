"""What makes a face hard to follow, in plain sentences that neither flicker nor nag."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from ...render.arrays import Floats
from ..performing.shots import Observed
from .following import TURNED_DEG

Sign = Literal["black", "dark", "backlit", "blurred", "far", "slow", "two faces", "turned", "settling", "makeshift"]

SENTENCES: dict[Sign, str] = {
    "black": "The picture is black: uncover the camera, and switch on the light.",
    "dark": "It is too dark: put a lamp in front of you.",
    "backlit": "The light comes from behind: turn round, or close the curtain.",
    "blurred": "The picture is blurred: wipe the lens, hold still, or give more light.",
    "far": "You are far away: come closer, until your face fills a third of the picture.",
    "slow": "The camera gives few pictures a second: give more light, or choose a smaller picture.",
    "two faces": "Somebody else is in the picture: the first face stays followed, L follows the other.",
    "turned": "You are turned too far: look towards the camera.",
    "settling": "Finding your face at rest: look at the camera, mouth closed, for a moment, or press N.",
    "makeshift": "Your face was not seen at rest: press N, and look at the camera, mouth closed.",
}
SIGNS: tuple[Sign, ...] = get_args(Sign)
HARD_TO_READ: frozenset[Sign] = frozenset({"dark", "backlit", "blurred", "far", "slow"})
"""These also take the smoothing up a notch."""

DARK = 0.16
BLACK = 0.03
"""Luma of a whole picture that somebody covers, or takes without any light."""
BACKLIT = 0.25
"""The face is darker than the picture by more than this, and darker than BACKLIT_FACE."""
BACKLIT_FACE = 0.4
BLURRED = 7e-3
"""In any light sharp clips have .018 to .03, those of 160 pixels .011 to .02; out of focus by 4 of 640 pixels they have
.0045 to .012, by 8 .001 to .004."""
FAR = 0.16
"""Height of the face in heights of the picture."""
SLOW = 14.0
"""Frames a second."""
APPEAR_SECS = 0.7
"""What lasts shorter is not worth a word."""
STAY_SECS = 1.2
"""A sentence stays this long after its reason went, so that it can be read."""


@dataclass(frozen=True)
class Hints:
    """What is shown, and for how long each sign has been there (positive) or gone (negative)."""

    shown: tuple[Sign, ...] = ()
    lasted: Mapping[Sign, float] = field(default_factory=dict)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What is shown, in words."""
        return tuple(SENTENCES[sign] for sign in self.shown)


def update_hints(before: Hints, signs: Iterable[Sign], dt: float) -> Hints:
    """The hints ``dt`` seconds later, when these signs are seen."""
    seen = set(signs)
    lasted: dict[Sign, float] = {}
    for sign in seen | set(before.lasted):
        secs = before.lasted.get(sign, 0.0)
        lasted[sign] = max(secs, 0.0) + dt if sign in seen else min(secs, 0.0) - dt
    shown: tuple[Sign, ...] = tuple(
        sign
        for sign in SIGNS
        if sign in lasted and (lasted[sign] >= APPEAR_SECS or (sign in before.shown and lasted[sign] > -STAY_SECS))
    )
    return Hints(shown, {sign: secs for sign, secs in lasted.items() if secs > -STAY_SECS})


def signs_without_a_face(luma: float) -> set[Sign]:
    """Why nobody may be seen in a picture, by its mean luma in [0, 1]."""
    if luma < BLACK:
        return {"black"}
    return {"dark"} if luma < DARK else set()


def signs_of(observed: Observed, turn: Floats) -> set[Sign]:
    """What can be seen in one picture; ``turn`` [3] is the head's rotation from its neutral in radians."""
    _, top, _, bottom = observed.box_px
    signs: set[Sign] = set()
    if observed.luma < DARK:
        signs.add("dark")
    if observed.luma < BACKLIT_FACE and observed.surround - observed.luma > BACKLIT:
        signs.add("backlit")
    if observed.sharpness < BLURRED:
        signs.add("blurred")
    if bottom - top < FAR * observed.picture_size[1]:
        signs.add("far")
    if observed.faces > 1:
        signs.add("two faces")
    if float(np.degrees(np.hypot(turn[0], turn[1]))) > TURNED_DEG[0]:
        signs.add("turned")
    return signs
