"""What is delivered becomes shots: one driver, one avatar, and the memory between two moments."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...models.driver.answer import Answer, Express
from ...models.driver.detector import overlap
from ...models.driver.face import SAME_FACE
from ...models.driver.neutral import NeutralChoice
from ...models.driver.regressor import Regressor
from ...models.driver.smoothing import Smoothed
from ...render.arrays import Floats
from ..errors import InputError
from ..files.frames import Frame
from ..inputs.source import PoseFrame, WeightsFrame
from ..live import NO_SHIFT, act
from ..performing.casting import Avatar, expression_of
from ..performing.performance import Pose
from ..performing.presence import Phase, update
from ..performing.shots import Observed, Shot
from ..person.following import (
    Actor,
    Look,
    Memory,
    Tracker,
    count_faces,
    follow,
    look,
    take_on,
)
from ..person.hints import Hints, Sign, signs_of, signs_without_a_face, update_hints
from ..person.seeing import lock_next, observe, sketch_of
from ..person.settling import Settling, anew, go_over, settle
from ..person.tuning import Tuning, actor_for
from .onesource import OneSource

_TICK = Fraction(1, 1_000_000)
LONGEST_DT = 1.0
"""Seconds; a longer gap, or one that goes back, is a jump in the source: then the clock says how much time went by."""
FOR_GOOD = 60.0
"""Seconds after which everything that eases has arrived."""
SEAT_SECS = 1.0
"""Nobody leaves a chair to somebody else in less."""


class Acting:
    """For one thread. Its own time goes on with the source's while that is steady, else with the clock."""

    def __init__(self, avatar: Avatar, tracker: Tracker, clock: Callable[[], float] = time.perf_counter) -> None:
        """Raises InputError when the avatar's regressor is broken, and nothing else drives it."""
        self._tracker, self._clock = tracker, clock
        self._avatar = avatar
        self._known: dict[str, Express] = {}
        self._tuning = Tuning()
        self._memory = Memory(seconds=0.0)
        self._serial = self._passed_by = 0
        self._wall = clock()
        self.source = OneSource()
        """What was learned of the source so far."""
        self._actor = self._dressed(avatar)

    @property
    def attention(self) -> Phase:
        """What the avatar is doing."""
        return self._memory.attention.phase

    @property
    def phase(self) -> Phase:
        """The same, but SEARCHING until this source has shown a face."""
        return self.attention if self.source.found else Phase.SEARCHING

    @property
    def refusal(self) -> str:
        """Why no face drives this avatar, which then only plays tracks and turns its head; empty where faces do."""
        express = self._actor.express
        return express.reason if isinstance(express, _Refusing) else ""

    @property
    def unusable(self) -> int:
        """Expressions of this source with a value that is not finite; the last good one stayed."""
        return self._memory.unusable + self._failures - self.source.failed_before

    @property
    def _failures(self) -> int:
        """Of all regressors, whatever the source was."""
        return sum(express.failures for express in self._known.values() if isinstance(express, Regressor))

    def begin(self) -> None:
        """Another source: nothing of the one before counts but the expression, from which the avatar eases."""
        self._tracker.reset()
        self._memory = self._memory.for_another_source()
        self._learn(OneSource(self._failures))

    def resume(self) -> None:
        """The same source after it was gone: its time may begin anew, and the scene may have changed."""
        self._memory = replace(self._memory, thumbnail=None)
        self.source = replace(self.source, secs=None)

    def cast(self, avatar: Avatar) -> None:
        """Another avatar goes on. Raises InputError, and keeps the one before, as at first."""
        self._actor, self._avatar = self._dressed(avatar), avatar
        self._memory = replace(self._memory, expression=None, clamped=0.0)

    def tune(self, tuning: Tuning) -> None:
        """Other positions of the sliders."""
        self._tuning = tuning
        self._actor = self._dressed(self._avatar)

    def rest(self, neutral: NeutralChoice | None) -> None:
        """The neutral that counts from now on; None: look for it anew."""
        before = self.source.settling
        settling = replace(before, given=neutral) if neutral else Settling(now=before.now)
        self.source = replace(self.source, settling=settling)

    def relock(self) -> None:
        """Follow the next face to the right, from the next picture on."""
        self.source = replace(self.source, relock=True)

    def frame(self, frame: Frame, delivered: float, live: bool, exact: bool, rate: float | None) -> Shot | None:
        """A picture; None when it is passed by to save work.

        Args:
            frame: a sound picture.
            delivered: when the source delivered it.
            live: from a camera, which knows no cuts.
            exact: a single frame somebody looks at: shown as it is, without the past in it.
            rate: pictures a second where few of them are the camera's fault, else None.
        """
        self._passed_by += 1
        if not exact and self._passed_by < self._tuning.detector_every:
            return None
        self._passed_by = 0
        started = self._clock()
        dt = self._elapsed(frame.seconds, started)
        before = self._prepared(frame.rgb, live, exact)
        timed = Frame(frame.rgb, round(((before.seconds or 0.0) + dt) / _TICK), _TICK)
        memory, seen = look(self._tracker, before, timed)
        tracked = self._clock()
        observed = None
        if seen.face is not None:
            self.source = replace(self.source, found=True)
            if exact:
                memory = replace(memory, attention=replace(memory.attention, follow=1.0))
            memory = count_faces(self._tracker, memory, timed)
            observed = observe(seen.face, frame.rgb, memory.faces)
            if observed.is_finite:
                strength, settling = self._tuning.neutral_strength, self.source.settling
                if not exact and _may_be_another(before, seen):
                    settling = anew(settling)
                settling = settle(settling, seen.face, timed.seconds, dt, strength)
                self.source = replace(self.source, face=seen.face, weights=None, settling=settling)
                memory = follow(self._with_neutral(), memory, seen.face, 0.0 if exact else dt)
            else:
                memory, observed = replace(memory, unusable=memory.unusable + 1), None
        self._pass(frame.seconds, started)
        self._memory, pose = act(self._actor, memory, seen.face is not None, seen.cut)
        unseen = signs_without_a_face(frame.luma) if seen.face is None else set[Sign]()
        self._look_for_hints(observed, dt, rate, unseen)
        stages = {"read": started - delivered, "track": tracked - started, "express": self._clock() - tracked}
        return self._shot(pose, delivered, frame.seconds, sketch_of(seen.face), observed, stages)

    def weights(self, given: WeightsFrame, exact: bool) -> Shot:
        """A moment in ARKit weights; on an avatar without an ARKit map only the head moves."""
        started = self._clock()
        dt = self._elapsed(given.seconds, started)
        self.source = replace(self.source, face=None, weights=given, found=True)
        self._advance(dt, seen=True)
        self._pass(given.seconds, started)
        before = _fresh(self._memory) if exact else self._memory
        self._memory = replace(take_on(self._actor, before, self._of_weights(given), dt), faces=1)
        self._memory, pose = act(self._actor, self._memory, seen=True)
        self._learn(replace(self.source, hints=Hints()))
        return self._shot(pose, started, given.seconds, stages={"express": self._clock() - started})

    def pose(self, given: PoseFrame) -> Shot | None:
        """A moment of a track, exactly; None when it was made for another avatar."""
        self.source = replace(self.source, posed=given)
        if given.avatar_sha256 != self._avatar.sha256:
            return None
        started = self._clock()
        dt = self._elapsed(given.seconds, started)
        self.source = replace(self.source, face=None, weights=None, found=True)
        self._advance(dt, seen=True)
        self._pass(given.seconds, started)
        return self._exactly(given, started)

    def _exactly(self, given: PoseFrame, started: float) -> Shot:
        gem, pose = self._avatar.gem, given.pose
        sigmas = (pose.coefficients - gem.rest_coefficients) / gem.sigma
        still = np.zeros(3), np.zeros_like(sigmas)
        self._memory = replace(
            self._memory,
            expression=Smoothed(sigmas, still[1]),
            turn=Smoothed(pose.turn, still[0]),
            shown_turn=pose.turn,
            translation=pose.translation,
            clamped=pose.clamped,
        )
        if not self._tuning.head_pose:
            pose = replace(pose, turn=NO_SHIFT, translation=NO_SHIFT)
        return self._shot(pose, started, given.seconds, stages={"express": self._clock() - started})

    def tick(self) -> Shot:
        """A moment in which nothing was delivered: hold, ease to rest, idle."""
        started = self._clock()
        dt = self._elapsed(None, started)
        self._advance(dt, seen=False)
        self._pass(None, started)
        self._memory, pose = act(self._actor, self._memory, seen=False)
        self._look_for_hints(None, dt, None)
        return self._shot(pose, started, self._memory.seconds or 0.0)

    def again(self, exact: bool) -> Shot:
        """The last moment once more, after the avatar or the sliders changed: nobody waits for the next picture."""
        started, memory, source = self._clock(), self._memory, self.source
        followed, now = memory.attention.phase is Phase.TRACKING, memory.seconds or 0.0
        if source.posed is not None and source.posed.avatar_sha256 == self._avatar.sha256:
            return self._exactly(source.posed, started)
        if source.face is not None and not self.refusal:
            gone_over, strength = FOR_GOOD if exact else 0.0, self._tuning.neutral_strength
            if source.settling.reason:  # this face was looked at before, and counts once
                settling = go_over(source.settling, gone_over, strength)
            else:
                settling = settle(source.settling, source.face, now, gone_over, strength)
            self.source = replace(source, settling=settling)
            memory = replace(follow(self._with_neutral(), _fresh(memory), source.face, 0.0), box=memory.box)
        elif source.weights is not None:
            memory = take_on(self._actor, _fresh(memory), self._of_weights(source.weights), 0.0)
        self._memory, pose = act(self._actor, memory, followed)
        return self._shot(pose, started, now, stages={"express": self._clock() - started})

    def _dressed(self, avatar: Avatar) -> Actor:
        """The actor for an avatar under the present tuning. Raises InputError as ``cast`` does."""
        express = self._known.get(avatar.sha256)
        if express is None:
            express = self._known[avatar.sha256] = _express_of(avatar)
        return actor_for(avatar, self._tracker, express, self._tuning, self.source.hard_to_read)

    def _with_neutral(self) -> Actor:
        neutral = self.source.settling.now
        assert neutral is not None
        return replace(self._actor, neutral=neutral)

    def _of_weights(self, given: WeightsFrame) -> Answer:
        gem = self._avatar.gem
        rigged = gem.arkit_weights is not None
        coefficients = gem.clamped(gem.arkit_coefficients(given.weights)) if rigged else gem.rest_coefficients
        return Answer(coefficients, given.turn)

    def _elapsed(self, source_secs: float | None, now: float) -> float:
        """Seconds since the last moment, by the source where it is steady, else by the clock, which says ``now``."""
        before = self.source.secs
        if before is not None and source_secs is not None and 0 < source_secs - before <= LONGEST_DT:
            return source_secs - before
        return max(0.0, now - self._wall)

    def _pass(self, source_secs: float | None, now: float) -> None:
        """This moment is over; one that failed never was."""
        self.source, self._wall = replace(self.source, secs=source_secs), now

    def _advance(self, dt: float, seen: bool) -> None:
        """Time goes by without a picture."""
        memory = self._memory
        attention = update(memory.attention, seen, dt)
        seconds = float(round(((memory.seconds or 0.0) + dt) / _TICK) * _TICK)
        self._memory = replace(memory, attention=attention, seconds=seconds)

    def _prepared(self, rgb: NDArray[np.uint8], live: bool, exact: bool) -> Memory:
        """The memory as it counts for this picture: single frames and another face to follow."""
        memory = self._memory
        if live:
            memory = replace(memory, thumbnail=None)
        if exact:
            memory = _fresh(memory)
        if self.source.relock:
            self.source = replace(self.source, relock=False)
            other = lock_next(self._tracker, rgb, memory.box)
            if other:
                memory = replace(memory, box=None, past=())
                if self.source.settling.given is None:  # another person rests in another way
                    self.source = replace(self.source, settling=Settling(now=self.source.settling.now))
        return memory

    def _look_for_hints(
        self, observed: Observed | None, dt: float, rate: float | None, unseen: Iterable[Sign] = ()
    ) -> None:
        """``unseen``: what can be said of a picture in which nobody is followed."""
        signs = set(unseen)
        if observed is not None and self._memory.turn is not None:
            signs = signs_of(observed, self._memory.turn.value)
            if not self.source.settling.at_rest:
                signs.add("makeshift" if self.source.settling.final else "settling")
        if rate is not None:
            signs.add("slow")
        self._learn(replace(self.source, hints=update_hints(self.source.hints, signs, dt)))

    def _learn(self, source: OneSource) -> None:
        """What is known from now on of how the driver is seen; one who is hard to read is followed more smoothly."""
        before, self.source = self.source, source
        if before.hard_to_read != source.hard_to_read:
            self._actor = self._dressed(self._avatar)

    def _shot(
        self,
        pose: Pose,
        delivered: float,
        source_secs: float,
        sketch: NDArray[np.float32] | None = None,
        observed: Observed | None = None,
        stages: dict[str, float] | None = None,
    ) -> Shot:
        self._serial += 1
        ready, avatar = self._clock(), self._avatar.sha256
        return Shot(self._serial, pose, avatar, delivered, ready, source_secs, sketch, observed, stages or {})


def _may_be_another(before: Memory, seen: Look) -> bool:
    """Whether a face that is seen after a while may be another person's, who rests in another way."""
    if before.attention.phase is not Phase.IDLE or seen.face is None:
        return False
    elsewhere = before.box is None or overlap(before.box, seen.face.box_px) < SAME_FACE
    return elsewhere or before.attention.missing_secs + seen.dt >= SEAT_SECS


@dataclass(frozen=True)
class _Refusing:
    """In the place of what turns a face into expressions, where nothing does."""

    reason: str

    def __call__(self, features: Floats, rotation: Floats) -> Answer:
        raise InputError(self.reason)


def _express_of(avatar: Avatar) -> Express:
    try:
        return expression_of(avatar, "learned")
    except InputError as error:
        if avatar.gem.regressor is None and avatar.gem.arkit_weights is None:
            return _Refusing(str(error))
        return expression_of(avatar, "baseline")


def _fresh(memory: Memory) -> Memory:
    """Without the past that eases into what is shown."""
    return replace(memory, expression=None, turn=None, misread=None, past=())
