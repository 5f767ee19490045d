"""One round of the capture thread: wishes, then a delivery, then a shot; and how the source is doing, in words."""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable

from ...models.driver.networks import NetworkError
from ..errors import CommandError
from ..files.frames import Frame
from ..inputs.attempt import Spawn, in_thread
from ..inputs.link import Link
from ..inputs.source import Delivery, Opener, PoseFrame, TimedFrame, WeightsFrame
from ..performing.casting import Avatar
from ..performing.mailbox import Mailbox
from ..performing.presence import Phase
from ..performing.shots import Health, Shot, SourcePhase
from ..person.following import Tracker
from ..person.hints import SLOW
from ..person.lazytracker import LazyTracker
from .acting import Acting

READ_SECS = 0.01
"""How long one round waits for a delivery: wishes wait no longer."""
TICK_SECS = 1 / 30
"""Between two shots while nothing is delivered: the avatar breathes and blinks."""
QUIET_SECS = 0.3
"""A pause in deliveries up to this is a slow source, not an absent one ..."""
QUIET_PAUSES, MOST_QUIET_SECS = 1.5, 1.5
"""... and so is one up to so many times as long as the pause before, but for so many seconds at most: in a dark room a
camera takes its time."""
RATE_SECS = 2.0
TOLD_SECS = 4.0
"""What could not be done is told for so long, whatever is seen meanwhile."""
SILENT_SECS = 1.0
"""Face data that does not come for so long has stopped."""
_PHASES: dict[Phase, SourcePhase] = {
    Phase.SEARCHING: "searching",
    Phase.TRACKING: "tracking",
    Phase.HOLD: "hold",
    Phase.IDLE: "idle",
}
_WORDS: dict[SourcePhase, tuple[str, str]] = {
    "searching": ("Looking for a face.", "Sit within a metre of the camera, with light on your face."),
    "idle": ("Looking for you.", "Come back into the picture, within a metre of the camera."),
}
"""To somebody in front of a camera: in the wide pictures of most a face that is much further away than a metre is not
found (``detector.LEAST_FACE``), though one that is followed may go further."""
_NO_FACE = ("No face is seen here.", "Choose what shows one from the front, an eighth of the longer side high or more.")
_START_SENDER = "Start the sender, and give it this address; for another device, listen at 0.0.0.0:PORT instead."
_log = logging.getLogger(__name__)


class Loop:
    """What the capture thread runs over and over. All but ``ask``, ``shots`` and ``health`` belong to that thread."""

    def __init__(
        self,
        avatar: Avatar,
        tracker: Callable[[], Tracker],
        clock: Callable[[], float] = time.perf_counter,
        pause: Callable[[float], None] | None = None,
        spawn: Spawn = in_thread,
    ) -> None:
        """``pause`` waits so many seconds (default: until the next wish). Raises InputError as ``Acting`` does."""
        self._clock, self._spawn = clock, spawn
        self._wishes: deque[Callable[[], None]] = deque()
        self._wished = threading.Event()
        self._pause = pause or self._wait
        self.acting = Acting(avatar, LazyTracker(tracker), clock)
        self.link: Link | None = None
        self.shots: Mailbox[Shot] = Mailbox()
        self.health = Health()
        self.serial = 0
        """Of the source, see ``Health.serial``."""
        self._open_before = False
        self._trouble: tuple[str, str] = ("", "")
        self._told_until = float("-inf")
        self._shot_at = self._delivered_at = self._used_at = clock()
        self._pause_secs = 0.0
        """Between the last two deliveries that were used."""
        self._arrivals: deque[float] = deque(maxlen=512)
        self._frames = self._failed = self._dropped_before = 0

    def ask(self, wish: Callable[[], None]) -> None:
        """Have something done in the capture thread, before the next delivery; from any thread."""
        self._wishes.append(wish)
        self._wished.set()

    def use(self, opener: Opener | None, name: str, serial: int = 0) -> None:
        """Leave the source, and open another one, called ``serial`` in what is said of its health."""
        self.close()
        self.acting.begin()
        self._arrivals.clear()
        self._frames = self._failed = 0
        self._dropped_before = self.shots.dropped
        self._trouble, self._told_until, self._open_before = ("", ""), float("-inf"), False
        self._delivered_at, self._pause_secs = self._clock(), 0.0  # nobody waits for it yet
        self.link = Link(opener, name, self._clock, self._pause, self._spawn) if opener else None
        self.serial = serial

    def cast(self, avatar: Avatar) -> None:
        """Another avatar, at once in the pose of the moment; the one before stays when its regressor is broken."""
        try:
            self.acting.cast(avatar)
        except CommandError as error:
            self._refuse(str(error), "Choose another avatar.")
            return
        self._trouble, self._told_until = ("", ""), float("-inf")
        self.shots.put(self.acting.again(self._paused))

    def changed(self) -> None:
        """After the sliders or the neutral changed: where no next frame will show it, show it now."""
        if self._paused:
            self.shots.put(self.acting.again(exact=True))

    def turn(self) -> None:
        """One round; never raises."""
        self._wished.clear()
        while self._wishes:
            self._grant(self._wishes.popleft())
        delivery = self._read()
        now = self._clock()
        shot = None
        if delivery is not None:
            self._arrivals.append(now)
            self._delivered_at = now
            shot = self._tried(delivery, now)
        if shot is not None:
            self._pause_secs, self._shot_at, self._used_at = now - self._used_at, now, now
        elif now - self._shot_at >= TICK_SECS and now - self._used_at >= self._quiet_secs and not self._paused:
            shot, self._shot_at = self.acting.tick(), max(self._shot_at + TICK_SECS, now - TICK_SECS)
        if shot is not None:
            self.shots.put(shot)
        self.health = self._examined(now)

    def close(self) -> None:
        """Let go of the source; returns at once."""
        if self.link is not None:
            self.link.close()
            self.link = None

    @property
    def _paused(self) -> bool:
        """Whether the source stands still because somebody wants it to."""
        source = self.link.source if self.link else None
        return source is not None and source.transport is not None and not source.transport.playing

    @property
    def _quiet_secs(self) -> float:
        """How long nothing may be delivered before nobody is there: for ever until a video's next frame is due."""
        source = self.link.source if self.link else None
        if source is not None and source.kind == "video" and self.acting.attention is Phase.TRACKING:
            return float("inf")
        return max(QUIET_SECS, min(MOST_QUIET_SECS, QUIET_PAUSES * self._pause_secs))

    def _grant(self, wish: Callable[[], None]) -> None:
        try:
            wish()
        except Exception as error:  # a wish that cannot be granted must not end the show
            _log.exception("a wish could not be granted")
            self._refuse(f"That could not be done ({error}).", "")

    def _refuse(self, message: str, cure: str) -> None:
        self._trouble, self._told_until = (message, cure), self._clock() + TOLD_SECS

    def _wait(self, seconds: float) -> None:
        self._wished.wait(seconds)

    def _read(self) -> Delivery | None:
        if self.link is None:
            self._pause(READ_SECS)
            return None
        delivery = self.link.read(READ_SECS)
        is_open = self.link.source is not None
        if is_open and not self._open_before:
            self.acting.resume()
        self._open_before = is_open
        return delivery

    def _tried(self, delivery: Delivery, now: float) -> Shot | None:
        """The shot of a delivery; None when there is none, or when it could not be made, which is counted."""
        try:
            shot = self._expressed(delivery, now)
        except NetworkError as error:
            self._trouble = (str(error), "Reinstall gemheads.")
        except Exception as error:  # one picture must not end the show
            if not self._failed:
                _log.exception("a delivery could not be used")
            self._trouble = (f"This picture could not be read ({error}).", "")
        else:
            if shot is not None:
                self._frames += 1
                if now >= self._told_until:
                    self._trouble = ("", "")
            return shot
        self._failed += 1
        return None

    def _expressed(self, delivery: Delivery, now: float) -> Shot | None:
        if isinstance(delivery, Frame):
            if self.acting.refusal:
                self._trouble = (f"{self.acting.refusal}.", "Or play a track that was made for it.")
                return None
            delivered = delivery.delivered if isinstance(delivery, TimedFrame) else now
            live = self.link is not None and self.link.source is not None and self.link.source.kind == "camera"
            rate = self._rate(now)
            slow = live and len(self._arrivals) > 2 and now - self._arrivals[0] >= RATE_SECS and rate < SLOW
            return self.acting.frame(delivery, delivered, live, self._paused, rate if slow else None)
        if isinstance(delivery, WeightsFrame):
            return self.acting.weights(delivery, self._paused)
        return self._posed(delivery)

    def _posed(self, delivery: PoseFrame) -> Shot | None:
        shot = self.acting.pose(delivery)
        if shot is None:
            self._trouble = ("This track was made for another avatar.", "Choose that avatar, or track the video again.")
        return shot

    def _rate(self, now: float) -> float:
        """Deliveries a second, over the last RATE_SECS, or since the first."""
        while self._arrivals and now - self._arrivals[0] > RATE_SECS + 0.5:
            self._arrivals.popleft()
        if not self._arrivals or (since := now - self._arrivals[0]) >= RATE_SECS:
            return sum(now - arrival <= RATE_SECS for arrival in self._arrivals) / RATE_SECS
        return (len(self._arrivals) - 1) / since if since > 0 else 0.0

    def _examined(self, now: float) -> Health:
        link, acting = self.link, self.acting
        phase, message, cure = self._words(now)
        return Health(
            phase=phase,
            message=message,
            cure=cure,
            frames=self._frames,
            drops=(link.drops if link else 0) + self.shots.dropped - self._dropped_before,
            rate=self._rate(now),
            source=link.name if link else "",
            pictured=link is not None and link.pictured,
            hints=acting.source.hints.sentences if phase in ("tracking", "hold", "searching", "idle") else (),
            rejected=(link.rejected if link else 0) + self._failed + acting.unusable,
            neutral=acting.source.settling.reason,
            settled=acting.source.settling.settled,
            serial=self.serial,
        )

    def _words(self, now: float) -> tuple[SourcePhase, str, str]:
        """The phase, what is the matter, and what to do about it."""
        if self.link is None:
            return "no source", *self._trouble
        state, source = self.link.state, self.link.source
        if state.phase in ("opening", "stalled"):
            return state.phase, state.message, state.cure
        if state.phase == "over" or source is None:
            return "no source", state.message, state.cure
        phase = _PHASES[self.acting.phase]
        if self._trouble[0]:
            return phase, *self._trouble
        if source.kind == "weights" and now - self._delivered_at > SILENT_SECS:
            silent: SourcePhase = "stalled" if self._frames else "searching"
            return silent, f"Nothing comes in from {source.name}.", _START_SENDER
        message, cure = _WORDS.get(phase, ("", ""))
        if message and source.kind != "camera":
            message, cure = _NO_FACE
        return phase, message, cure
