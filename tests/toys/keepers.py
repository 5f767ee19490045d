"""An output that keeps what it gets."""

import threading

from gemheads.app.errors import OutputError
from gemheads.app.senders.outlet import Shown
from waiting import SOON


class Keeper:
    """Keeps what it gets; waits for ``gate`` before each picture."""

    def __init__(self, gate: threading.Event | None = None, failing: bool = False) -> None:
        self.kept: list[Shown] = []
        self.gate, self.failing, self.closed = gate, failing, False

    @property
    def status(self) -> str:
        return f"kept {len(self.kept)}"

    def send(self, shown: Shown) -> None:
        if self.gate:
            assert self.gate.wait(SOON)
        if self.failing:
            raise OutputError("out.mp4: no space left; free some space")
        self.kept.append(shown)

    def close(self) -> None:
        self.closed = True
