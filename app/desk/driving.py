"""The driver of a session: the source that was asked for, its buttons, the sliders and the neutral."""

from collections.abc import Callable
from typing import Any

from ..credentials.origin import origin_of
from ..errors import CommandError
from ..feed.capture import Capture
from ..inputs import open_input
from ..inputs.opening import DEMO, PERFORMANCE, check_input
from ..inputs.source import Opener, Transport
from ..performing.casting import Avatar
from ..performing.shots import Health, Shot
from ..person.tuning import GROUPS, Tuning
from .actions import Order
from .resting import NeutralTaking, kept, recalled
from .sources import CameraList, camera_named, named
from .state import DeskState

Tell = Callable[[str, bool], None]
"""Says a sentence to the person, in alarm or not."""


class Driving:
    """For the window's thread; what waits is in the capture thread."""

    def __init__(self, tell: Tell, make: Callable[[Avatar], Any] = Capture) -> None:
        """
        Args:
            tell: for what goes wrong.
            make: the capture for the first avatar.
        """
        self.camera = ""
        """The name of the camera that was used last."""
        self._tell, self._make = tell, make
        self._capture: Capture | None = None
        self._source: tuple[Opener | None, str] = (open_input(PERFORMANCE), "Performance")
        self._tuning = Tuning()
        self._neutral = NeutralTaking()
        self._cameras = CameraList()
        self._by_camera, self._known_camera = False, ""
        self._waker: Callable[[], None] = lambda: None

    @property
    def source(self) -> tuple[Opener | None, str]:
        """What was chosen to drive, another object with each choice: what opens it, and its name until it is open."""
        return self._source

    @property
    def health(self) -> Health:
        """How the source is doing."""
        return self._capture.health if self._capture is not None else Health()

    @property
    def transport(self) -> Transport | None:
        """The source's buttons."""
        return self._capture.transport if self._capture is not None else None

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras that are connected."""
        return self._cameras.names

    @property
    def neutral(self) -> NeutralTaking:
        """How the taking of the neutral goes."""
        return self._neutral

    def cast(self, avatar: Avatar) -> bool:
        """Drive this avatar from now on; False, said aloud, when its regressor is broken."""
        try:
            if self._capture is None:
                capture: Capture = self._make(avatar)
                capture.rouse(self._waker)
                capture.use(*self._source)
                self._capture = capture
            else:
                self._capture.cast(avatar)
        except CommandError as error:
            self._tell(str(error), True)
            return False
        if not (origin := origin_of(avatar)).consented:
            self._tell(origin.said(), False)
        return True

    def rouse(self, waker: Callable[[], None]) -> None:
        """Have ``waker`` called, in the capture thread, when there is a new shot."""
        self._waker = waker
        if self._capture is not None:
            self._capture.rouse(waker)

    def newest(self) -> Shot | None:
        """The newest shot, each once."""
        return self._capture.newest() if self._capture is not None else None

    def use(self, opener: Opener | None, name: str) -> None:
        """Another source; a neutral that is being taken is begun anew."""
        self._source, self._by_camera, self._known_camera = (opener, name), False, ""
        self._neutral.stop()
        if self._capture is not None:
            self._capture.use(opener, name)

    def open(self, text: str) -> None:
        """A file, a folder or a port as the source; what is wrong with the word is told, and what plays goes on."""
        try:
            check_input(text)
            self.use(open_input(text), text.rstrip("/\\").replace("\\", "/").rsplit("/", 1)[-1])
        except CommandError as error:
            self._tell(str(error), True)

    def open_camera(self, name: str) -> None:
        """A camera by its name, the last one or the first where there is none; the one that runs is left running, for
        until it had let go of itself it would be busy."""
        wanted = name or self.camera
        if self._runs(wanted):
            self._tell(f"{self._known_camera} runs already.", False)
            return
        self.use(camera_named(wanted), wanted or "Camera")
        self._by_camera = True

    def _runs(self, wanted: str) -> bool:
        """Whether the camera of this name, or the one it is a part of the name of, is the source and delivers."""
        known = self._known_camera
        delivers = known != "" and self.health.phase not in ("no source", "opening", "stalled")
        return delivers and named((*self.cameras, known), wanted) == known

    def open_demo(self) -> None:
        """The shipped clip."""
        self.use(open_input(DEMO), "The demo")

    def press(self, order: Order) -> None:
        """A button of the source; nothing happens where it has none."""
        transport, value = self.transport, order.value
        if transport is None:
            return
        if order.name == "play":
            play = not transport.playing if value is None else bool(value)
            if play:
                transport.play()
            else:
                transport.pause()
        elif order.name == "step" and isinstance(value, float | int):
            transport.step(round(value))
        elif order.name == "seek" and isinstance(value, float | int):
            wanted = transport.position + value if order.relative else value
            transport.seek(min(transport.duration, max(0.0, wanted)))

    def relock(self) -> None:
        """Follow another face."""
        if self._capture is not None:
            self._capture.relock()

    def settle(self, state: DeskState, detector_every: int, avatar: Avatar, shot: Shot | None, now: float) -> bool:
        """Bring sliders, loop and neutral to where the state has them; whether a neutral was just finished."""
        if self._capture is None:
            return False
        if (transport := self.transport) is not None and transport.loop != state.loop:
            transport.loop = state.loop
        tuning = tuning_of(state, detector_every)
        if tuning != self._tuning:
            self._tuning = tuning
            self._capture.tune(tuning)
        self._meet(capture=self._capture)
        if state.resting != self._neutral.on:
            if state.resting:
                self._neutral.begin()
            else:
                self._neutral.stop()
        resting = self._neutral.advance(shot, self.health, avatar, now)
        if resting is not None:
            self._capture.rest(resting.choice)
            if self._known_camera and (trouble := kept(self._known_camera, resting)):
                self._tell(trouble, True)
        return state.resting and not self._neutral.on

    def _meet(self, capture: Capture) -> None:
        """Once a camera shows a picture its name is known, and with it the neutral of an earlier day."""
        health = self.health
        if not self._by_camera or self._known_camera or not health.frames:
            return
        self.camera = self._known_camera = health.source
        choice, warning = recalled(self.camera)
        if warning:
            self._tell(warning, False)
        if choice is not None:
            capture.rest(choice)

    def close(self) -> None:
        """Let go of the source, in under a second."""
        self._cameras.close()
        if self._capture is not None:
            self._capture.close()


def tuning_of(state: DeskState, detector_every: int) -> Tuning:
    """The sliders as the capture thread wants them."""
    return Tuning(
        smoothing=state.smoothing,
        gains={group: getattr(state, f"gain_{group}") for group in GROUPS},
        head_pose=state.head_pose,
        neutral_strength=state.neutral_strength,
        detector_every=detector_every,
    )
