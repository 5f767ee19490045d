"""Where a player is: a playhead that runs by the clock, pauses, steps, seeks and loops."""

import threading
import time
from collections.abc import Callable


class Playhead:
    """The position in something that lasts ``duration`` seconds. Every method returns at once, from any thread."""

    def __init__(
        self,
        duration: float | None,
        frame_secs: float,
        loop: bool = True,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """``duration``: None until ``lasts`` says it; ``frame_secs``: how far one step goes. Raises ValueError unless
        both are finite and above 0."""
        told = 1.0 if duration is None else duration
        if not (0 < told < float("inf") and 0 < frame_secs < float("inf")):
            raise ValueError(f"a player needs a duration and a frame time above 0, got {duration} and {frame_secs} s")
        self._duration = float("inf") if duration is None else duration
        self._frame_secs, self._clock = frame_secs, clock
        self._changed = threading.Condition()
        self._loop, self._playing = loop, True
        self._base, self._since = 0.0, clock()
        self.jumps = 0
        """Rises with every step, seek and return to the beginning: what was read ahead is then worth nothing."""

    @property
    def playing(self) -> bool:
        """False while paused, and at the end of what does not loop."""
        with self._changed:
            self._settle()
            return self._playing

    @property
    def loop(self) -> bool:
        """Whether it begins again at its end."""
        return self._loop

    @loop.setter
    def loop(self, value: bool) -> None:
        with self._changed:
            self._settle()
            self._loop = value

    @property
    def position(self) -> float:
        """Seconds from the beginning, in [0, duration]."""
        with self._changed:
            return self._settle()

    @property
    def duration(self) -> float:
        """Seconds; infinity while nobody knows."""
        return self._duration

    def lasts(self, seconds: float) -> None:
        """The duration is known from now on, or is another one. Raises ValueError unless it is finite and above 0."""
        if not 0 < seconds < float("inf"):
            raise ValueError(f"a player needs a duration above 0, got {seconds} s")
        with self._changed:
            self._duration = seconds

    def play(self) -> None:
        """Go on; from the beginning when it stands at the end."""
        with self._changed:
            if not self._playing:
                ended = self._settle() >= self._duration - self._frame_secs / 2
                self._put(0.0 if ended else self._base, playing=True, jump=ended)

    def pause(self) -> None:
        """Stay where it is."""
        with self._changed:
            self._put(self._settle(), playing=False, jump=False)

    def step(self, frames: int) -> None:
        """Pause, and go so many frames on, or back where negative."""
        with self._changed:
            last = max(0.0, self._duration - self._frame_secs)
            self._put(min(max(0.0, self._settle() + frames * self._frame_secs), last), playing=False, jump=True)

    def seek(self, seconds: float) -> None:
        """Go to a time; beyond the ends, to the nearest one. NaN and infinity are ignored."""
        if abs(seconds) < float("inf"):
            with self._changed:
                self._settle()
                self._put(min(max(0.0, seconds), self._duration), self._playing, jump=True)

    def end(self) -> None:
        """There is nothing after this: begin again, or stop."""
        with self._changed:
            if self._playing:
                self._put(0.0 if self._loop else self._duration, playing=self._loop, jump=self._loop)

    def slip(self, seconds: float) -> None:
        """Go on from here, later than the clock says: the machine could not keep up."""
        with self._changed:
            self._put(seconds, self._playing, jump=False)

    def wait(self, timeout: float) -> None:
        """Until a button is pressed, at most so long (seconds)."""
        with self._changed:
            if timeout > 0:
                self._changed.wait(timeout)

    def _settle(self) -> float:
        """The position now; begins again or stops where the end was passed."""
        position = self._base + (self._clock() - self._since if self._playing else 0.0)
        if position < self._duration or not self._playing:
            return min(position, self._duration)
        if self._loop:
            position %= self._duration
            self._put(position, playing=True, jump=True)
            return position
        self._put(self._duration, playing=False, jump=False)
        return self._duration

    def _put(self, position: float, playing: bool, jump: bool) -> None:
        self._base, self._since, self._playing = position, self._clock(), playing
        self.jumps += jump
        self._changed.notify_all()
