"""Following one face: who it is, what it does relative to its neutral, smoothed; what ``live.drive`` is made of."""

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...models.driver.answer import Answer, Express
from ...models.driver.detector import Detection
from ...models.driver.face import Box, FaceObservation
from ...models.driver.features import feature_vector, head_rotation, relative_rotation
from ...models.driver.neutral import NeutralChoice
from ...models.driver.smoothing import OneEuro, Smoothed, step
from ...models.gem import Gem
from ..files.frames import Frame, is_cut, thumbnail
from ..performing.presence import HOLD_SECS, Attention, update
from .holding import Moment, held, kept

Floats = NDArray[np.floating]
EXPRESSION_FILTER = OneEuro(min_cutoff_hz=2.0, beta=1.0, together=True)
"""On coefficients in units of their sigma. On a talking face it takes 30 % of the tremble (second differences) and
keeps a correlation of .98 to .996 for smile, jaw and blink; with one cutoff a coefficient the smile falls to .86."""
TURN_FILTER = OneEuro(min_cutoff_hz=2.0, beta=10.0, together=True)
"""On the head's rotation in radians."""
MISREAD_FILTER = OneEuro(min_cutoff_hz=2.0, beta=0.0)
"""On what is taken off the rotation because an expression only seems to turn the head, in radians: the expression is
shown no faster, and what trembles in it shall not make the head tremble."""
TURNED_DEG = (30.0, 45.0)
"""Between these turns of the head the expression fades, because the tracker sees less and less of the face ..."""
TURNED_GAIN = 0.5
"""... to this part of it."""
FACES_EVERY_SECS = 0.5
"""How often the faces in the picture are counted."""


class Tracker(Protocol):
    """What following needs of a ``FaceTracker``."""

    def track(self, rgb: NDArray[np.uint8], locked: Box | None = None) -> FaceObservation | None:
        """The followed face in [H, W, 3] of RGB bytes, None without one."""
        ...

    def detect(self, rgb: NDArray[np.uint8]) -> list[Detection]:
        """All faces, the surest first."""
        ...

    def lock(self, face: Detection) -> None:
        """Follow this one from the next image on."""
        ...

    def reset(self) -> None:
        """Forget the face."""
        ...


@dataclass(frozen=True)
class Actor:
    """What drives: the same for every frame of a clip."""

    tracker: Tracker
    neutral: NeutralChoice
    express: Express
    gem: Gem
    lids: Floats
    """[coefficients] what closes the lids, for idle blinks."""
    head_pose: bool = True
    expression_filter: OneEuro = EXPRESSION_FILTER
    turn_filter: OneEuro = TURN_FILTER
    gains: Floats | None = None
    """[coefficients, coefficients] what becomes of coefficients away from rest, multiplied from the right."""
    turn_gain: float = 1.0
    misread_filter: OneEuro = MISREAD_FILTER


@dataclass(frozen=True)
class Memory:
    """What one frame leaves to the next."""

    attention: Attention = field(default_factory=Attention)
    seconds: float | None = None
    thumbnail: NDArray[np.float32] | None = None
    box: Box | None = None
    """Where the followed face was last seen."""
    new_scene: bool = False
    """Whether nobody was seen since the last cut: what is below is of the scene before, and held until somebody is."""
    expression: Smoothed | None = None
    """Coefficients away from the rest expression, in units of sigma."""
    turn: Smoothed | None = None
    """Rotation of the driver's head from its neutral."""
    shown_turn: Floats = field(default_factory=lambda: np.zeros(3, np.float32))
    """[3] the avatar's, which may be more or less of it."""
    misread: Smoothed | None = None
    """What is taken off it."""
    translation: Floats = field(default_factory=lambda: np.zeros(3, np.float32))
    """[3] metres the head stands from its place: only tracks say so."""
    past: tuple[Moment, ...] = ()
    """What was made of the followed face a moment ago, to be held when it goes."""
    clamped: float = 0.0
    faces: int = 0
    counted_at: float = -FACES_EVERY_SECS
    idle_since: float = 0.0
    unusable: int = 0
    """Expressions that were not finite, in the place of which the last good one stayed."""


@dataclass(frozen=True)
class Look:
    """What a frame shows."""

    face: FaceObservation | None
    """The followed face, where it is there."""
    dt: float
    """Seconds since the frame before."""
    cut: bool
    """Whether another scene begins here."""


def look(tracker: Tracker, before: Memory, frame: Frame) -> tuple[Memory, Look]:
    """Find the followed face, or notice that it is gone, or that the scene is another one."""
    now, view = frame.seconds, thumbnail(frame.rgb)
    dt = now - before.seconds if before.seconds is not None else 0.0
    cut = before.thumbnail is not None and is_cut(before.thumbnail, view)
    if cut:
        tracker.reset()
        before = replace(before, box=None, new_scene=True, counted_at=-FACES_EVERY_SECS, past=())
    face = tracker.track(frame.rgb, locked_box(before, dt))
    if face is not None and before.new_scene:
        before = replace(before, expression=None, turn=None, misread=None, new_scene=False)
    attention = update(before.attention, face is not None, dt)
    if face is None and before.past:
        before = _held(before, attention.missing_secs)
    return replace(before, attention=attention, seconds=now, thumbnail=view), Look(face, dt, cut)


def _held(memory: Memory, missing_secs: float) -> Memory:
    """As a face that has gone is held; the filters go on from there when it comes back."""
    moment = held(memory.past, missing_secs)
    expression, turn = (Smoothed(value, np.zeros_like(value)) for value in (moment.expression, moment.turn))
    return replace(memory, expression=expression, turn=turn, shown_turn=moment.shown_turn)


def follow(actor: Actor, memory: Memory, face: FaceObservation, dt: float) -> Memory:
    """The face's features, relative to the neutral, through the regressor and the filters."""
    relative = feature_vector(face) - actor.neutral.features
    answer = actor.express(relative, relative_rotation(head_rotation(face), actor.neutral.rotation))
    memory = take_on(actor, replace(memory, box=face.box_px), answer, dt)
    if memory.expression is None or memory.turn is None:
        return memory
    now = Moment(memory.seconds or 0.0, memory.expression.value, memory.turn.value, memory.shown_turn)
    return replace(memory, past=kept(memory.past, now))


def take_on(actor: Actor, memory: Memory, answer: Answer, dt: float) -> Memory:
    """What the avatar shall do, through gains and filters; what is not finite is not."""
    coefficients, misread = answer.coefficients, step(actor.misread_filter, memory.misread, answer.misread, dt)
    turn = answer.turn + answer.misread - misread.value
    rest = actor.gem.rest_coefficients
    if actor.gains is not None:
        coefficients = actor.gem.clamped(rest + (coefficients - rest) @ actor.gains)
    sigmas = (coefficients - rest) / actor.gem.sigma
    if not (np.isfinite(sigmas).all() and np.isfinite(turn).all()):
        return replace(memory, unusable=memory.unusable + 1)  # the last good ones stay
    smooth_turn = step(actor.turn_filter, memory.turn, turn, dt)
    return replace(
        memory,
        expression=step(actor.expression_filter, memory.expression, sigmas, dt),
        turn=smooth_turn,
        shown_turn=smooth_turn.value * actor.turn_gain,
        misread=misread,
        translation=np.zeros(3, np.float32),
        clamped=actor.gem.limit_share(coefficients),
    )


def locked_box(memory: Memory, dt: float) -> Box | None:
    """Where the face has to be that counts, ``dt`` seconds later: the one followed so far keeps the lock until it has
    been gone for HOLD_SECS; then None, and anybody counts."""
    return memory.box if memory.attention.missing_secs + dt < HOLD_SECS else None


def count_faces(tracker: Tracker, memory: Memory, frame: Frame) -> Memory:
    """How many faces the picture shows, looked up now and then."""
    if frame.seconds < memory.counted_at + FACES_EVERY_SECS:
        return memory
    return replace(memory, faces=max(1, len(tracker.detect(frame.rgb))), counted_at=frame.seconds)


def turned_gain(turn: Floats) -> float:
    """1 for a head near its neutral, TURNED_GAIN far to the side or up; leaning (roll) hides nothing."""
    degrees = float(np.degrees(np.hypot(turn[0], turn[1])))
    return float(np.interp(degrees, TURNED_DEG, (1.0, TURNED_GAIN)))
