"""Switches the outputs on and off as the state says, and says how they do."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from ..credentials.origin import origin_of
from ..performing.casting import Avatar
from ..senders.fan import Fan
from ..senders.folder import made
from ..senders.oscout import CoefficientsOut
from ..senders.recording import RECORDING_DEPTH, Recording, recording_in
from ..senders.snapshot import Snapshot
from ..senders.virtualcamera import open_virtual_camera
from .actions import Order
from .painter import ground
from .state import DeskState
from .view import OutputLine

NAMES = {"record": "Recording", "virtual_camera": "Virtual camera", "coefficients": "Coefficients"}
"""Field of the state -> what people call the output."""
PICTURE = "Picture"


class Outputs:
    """Sits between the state and the senders."""

    def __init__(self, size: tuple[int, int], rate: int, folder: Callable[[], Path]) -> None:
        """``size`` and ``rate`` of what is written; ``folder`` says where recordings and pictures go."""
        self.fan = Fan()
        self._size, self._rate, self._folder = size, rate, folder
        self._started: set[str] = set()

    def settle(self, state: DeskState) -> tuple[Order, ...]:
        """Turn on and off what the state wants; orders for switches whose output ended by itself."""
        self.fan.marks = replace(self.fan.marks, no_badge=state.no_badge, camera_badge=state.camera_badge)
        if (colour := ground(state.background)) is not None:
            red, green, blue = (round(255 * value) for value in colour)
            self.fan.marks = replace(self.fan.marks, ground=(red, green, blue))
        ended = []
        for name, label in NAMES.items():
            if not getattr(state, name):
                self._started.discard(name)
                self.fan.stop(label)
            elif name not in self._started:
                self._start(name, label, state)
            elif not self.fan.running(label):
                self._started.discard(name)  # who turns it on again before the next round means it
                ended.append(Order(name, 0.0))
        return tuple(ended)

    def introduce(self, avatar: Avatar) -> None:
        """Whose face this one is, before it is seen: credentials name it."""
        origins = {**self.fan.marks.origins, avatar.sha256: origin_of(avatar)}
        self.fan.marks = replace(self.fan.marks, origins=origins)

    def picture(self) -> None:
        """Save the next picture."""
        self.fan.start(PICTURE, lambda: Snapshot(self._folder(), self._size), once=True, filing=True)

    def lines(self) -> tuple[OutputLine, ...]:
        """How each does."""
        return tuple(
            OutputLine(
                report.name,
                (report.text or report.phase).replace(str(Path.home()), "~"),
                report.drops,
                report.phase == "failed",
                report.phase in ("failed", "done"),
            )
            for report in self.fan.reports()
        )

    def close(self) -> None:
        """End all of them, in under a second; a file may still be written to its end, and signed, behind that."""
        self.fan.close()

    def finished(self, timeout: float = 0.0) -> bool:
        """After ``close``: whether all files are finished, or will be within ``timeout`` seconds, which are waited."""
        return self.fan.filed(timeout)

    def _start(self, name: str, label: str, state: DeskState) -> None:
        self._started.add(name)
        transparent = state.background == "transparent"
        if name == "record":
            sound = state.microphone
            self.fan.start(label, lambda: self._recording(transparent, sound), depth=RECORDING_DEPTH, filing=True)
        elif name == "virtual_camera":
            self.fan.start(label, lambda: open_virtual_camera(self._size, rate=self._rate))
        else:
            self.fan.start(label, CoefficientsOut)

    def _recording(self, transparent: bool, sound: bool) -> Recording:
        return recording_in(made(self._folder()), self._size, self._rate, transparent, sound)
