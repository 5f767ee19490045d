"""The link to one source: opened, watched over, lost, and sought again by itself."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from ..errors import CommandError
from ..files.frames import Frame
from .attempt import Attempt, Spawn, in_thread
from .source import Delivery, LiveSource, Opener, SourceLost, is_sound
from .vigil import Vigil, watch

FIRST_RETRY_SECS, LAST_RETRY_SECS = 0.5, 5.0
HEALTHY_SECS = 2.0
"""A source that delivered for so long is trusted again: its next retry comes soon."""
SLOW_SECS = 4.0
"""A source that takes longer to open is spoken of."""
_DEMO = "Or play the demo meanwhile."


@dataclass(frozen=True)
class LinkState:
    """How it stands."""

    phase: Literal["opening", "open", "stalled", "over"]
    message: str = ""
    cure: str = ""


OPEN = LinkState("open")


class Link:
    """Reads one source, for one thread. ``pause`` waits for so many seconds, or shorter if something else is wanted."""

    def __init__(
        self,
        opener: Opener,
        name: str,
        clock: Callable[[], float] = time.perf_counter,
        pause: Callable[[float], None] = time.sleep,
        spawn: Spawn = in_thread,
    ) -> None:
        self._opener, self._clock, self._pause, self._spawn = opener, clock, pause, spawn
        self.name = name
        self.source: LiveSource | None = None
        """None while it is not open."""
        self.state = LinkState("opening", f"Opening {name} ...")
        self._attempt: Attempt | None = Attempt(opener, spawn)
        self._begun = clock()
        self._vigil = Vigil(self._begun)
        self._healthy_since = self._begun
        self._retry_secs = FIRST_RETRY_SECS
        self._retry_at: float | None = None
        self._past_drops = self._past_rejected = 0

    @property
    def pictured(self) -> bool:
        """Whether it shows pictures, or may once it is open."""
        if self.source is None:
            return self.state.phase != "over"
        return self.source.kind not in ("track", "weights")

    @property
    def drops(self) -> int:
        """Frames that a newer one replaced, over all openings."""
        return self._past_drops + (self.source.drops if self.source else 0)

    @property
    def rejected(self) -> int:
        """Deliveries that were no such thing, over all openings."""
        return self._past_rejected + (self.source.rejected if self.source else 0)

    def read(self, timeout: float) -> Delivery | None:
        """What came within ``timeout`` seconds, if it is of use. Never raises, and never waits for a device."""
        if self._attempt is not None:
            self._finish_opening(timeout)
        elif self.source is None and self._retry_at is not None and self._clock() >= self._retry_at:
            self._retry()
        source = self.source
        if source is None:
            self._pause(timeout)
            return None
        try:
            delivery = source.read(timeout)
        except SourceLost as lost:
            self._lose(lost)
            return None
        except Exception as error:  # a source of whatever kind must not take the loop with it
            self._lose(SourceLost(f"{self.name} failed ({error}).", "It is opened again by itself.", True))
            return None
        if delivery is not None and not is_sound(delivery):
            self._past_rejected += 1
            delivery = None
        return self._watched(source, delivery)

    def close(self) -> None:
        """Let go of the source, open or not; returns at once."""
        if self._attempt is not None:
            self._attempt.forget()
            self._attempt = None
        self._let_go()

    def _finish_opening(self, timeout: float) -> None:
        attempt, now = self._attempt, self._clock()
        assert attempt is not None
        outcome = attempt.outcome
        if outcome is None:
            if now - self._begun > SLOW_SECS and self.state.phase == "opening":
                cure = f"Unplug it and plug it in again, or choose another source. {_DEMO}"
                self.state = LinkState("opening", f"{self.name} takes long to open.", cure)
            return
        self._attempt = None
        if isinstance(outcome, Exception):
            self._lose(_as_lost(outcome, self.name))
            return
        self.source, self._vigil, self._healthy_since = outcome, Vigil(now), now
        self.name = outcome.name
        if outcome.kind != "camera" or self.state.phase == "opening":
            self.state = OPEN  # a camera that had stalled has to show a picture first

    def _watched(self, source: LiveSource, delivery: Delivery | None) -> Delivery | None:
        """The delivery, unless it is one more copy of a frozen picture; notices what has stalled."""
        now = self._clock()
        if source.kind != "camera":
            return delivery
        if isinstance(delivery, Frame):
            self._vigil = watch(self._vigil, delivery.rgb, now)
        if self._vigil.frozen:
            message, cure = f"{self.name} sends the same picture over and over.", "Unplug it and plug it in again."
        elif self._vigil.stale(now):
            message, cure = f"{self.name} sends no pictures.", "Check its cable, and whether another program uses it."
        else:
            if delivery is not None:
                self._thrive(now)
            return delivery
        if self.state.phase != "stalled" or self._retry_at is None:
            self._retry_at = now + self._next_wait()
        self.state = LinkState("stalled", message, f"{cure} It is used again as soon as it works.")
        if now >= self._retry_at:
            self._let_go()
            self._retry()
        return None

    def _thrive(self, now: float) -> None:
        if self.state.phase != "open":
            self.state, self._healthy_since = OPEN, now
        self._retry_at = None
        if now - self._healthy_since > HEALTHY_SECS:
            self._retry_secs = FIRST_RETRY_SECS

    def _lose(self, lost: SourceLost) -> None:
        self._let_go()
        self.state = LinkState("stalled" if lost.retry else "over", lost.message, lost.cure)
        self._retry_at = self._clock() + self._next_wait() if lost.retry else None

    def _next_wait(self) -> float:
        """Seconds until the next try; twice as long each time."""
        wait, self._retry_secs = self._retry_secs, min(LAST_RETRY_SECS, 2 * self._retry_secs)
        return wait

    def _retry(self) -> None:
        self._retry_at = None
        self._begun = self._clock()
        self._attempt = Attempt(self._opener, self._spawn)

    def _let_go(self) -> None:
        if self.source is not None:
            self._past_drops += self.source.drops
            self._past_rejected += self.source.rejected
            self.source.close()
            self.source = None


def _as_lost(error: Exception, name: str) -> SourceLost:
    if isinstance(error, SourceLost):
        return error
    if isinstance(error, CommandError):
        return SourceLost(f"{str(error).rstrip('.')}.", "Choose another source.", False)
    return SourceLost(f"{name} cannot be opened ({error}).", f"Choose another source. {_DEMO}", False)
