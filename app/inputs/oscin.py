"""Face data over UDP: VMC (any VTuber program) and iFacialMocap (iPhone), as ARKit weights."""

import select
import socket
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ...models.arkit import NAMES
from .arkitnames import Target, target_of
from .packets import PacketError, Quaternion, Said, read_ifacialmocap, read_vmc, turn_of_bones
from .source import Kind, SourceLost, WeightsFrame

LOOPBACK = "127.0.0.1"
READERS: dict[str, Callable[[bytes], Said]] = {"osc": read_vmc, "vmc": read_vmc, "ifacialmocap": read_ifacialmocap}
"""Protocol -> what reads its packets."""
PORTS = {"osc": 39539, "vmc": 39539, "ifacialmocap": 49983}
"""The ports that senders use unless told otherwise."""
MOST_PACKETS = 256
"""Packets read at once: a flood must not keep the loop from going on."""
MOST_TURN = 1.2
"""Radians."""
_LARGEST = 65536


class FaceData:
    """Listens on one port of this machine only, unless another host is given. Raises SourceLost when it is taken."""

    kind: Kind = "weights"
    transport = None

    def __init__(
        self, protocol: str, port: int, host: str = LOOPBACK, clock: Callable[[], float] = time.perf_counter
    ) -> None:
        self.name = f"{protocol} on {host}:{port}"
        self.drops = self.rejected = 0
        self._read_packet, self._clock, self._started = READERS[protocol], clock, clock()
        self._said: dict[Target, float] = {}
        self._bones: dict[str, Quaternion] = {}
        self._weights = np.zeros(len(NAMES), np.float32)
        self._turn = np.zeros(3, np.float32)
        self._ever_applied = False
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._socket.bind((host, port))
        except (OSError, OverflowError) as error:
            self._socket.close()
            message = f"Port {port} of {host} cannot be listened on ({getattr(error, 'strerror', error)})."
            cure = "Close the other program that listens there, or give another port and set it in the sender."
            raise SourceLost(message, cure, True) from error
        self._socket.setblocking(False)

    @property
    def port(self) -> int:
        """The port listened on; useful after asking for port 0, which takes a free one."""
        return self._socket.getsockname()[1]

    def read(self, timeout: float) -> WeightsFrame | None:
        """The newest complete moment; packets of garbage are counted and change nothing."""
        try:
            ready, _, _ = select.select([self._socket], [], [], max(0.0, timeout))
        except (OSError, ValueError) as error:
            message = f"Listening on {self.name} ended ({error})."
            raise SourceLost(message, "It starts again by itself.", True) from error
        moments = self._drain() if ready else 0
        self.drops += max(0, moments - 1)
        if not moments:
            return None
        return WeightsFrame(self._weights.copy(), self._turn.copy(), self._clock() - self._started)

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()

    def _drain(self) -> int:
        """Take in all packets that wait; returns how many complete moments they made."""
        moments, heard = 0, False
        for _ in range(MOST_PACKETS):
            try:
                packet = self._socket.recv(_LARGEST)
            except (BlockingIOError, InterruptedError):
                break
            except OSError:  # Windows reports here that an earlier packet of ours found nobody
                continue
            try:
                said = self._read_packet(packet)
            except PacketError:
                self.rejected += 1
                continue
            heard |= self._take_in(said)
            if said.applied:
                self._ever_applied, heard = True, False
                moments += 1
                self._complete()
        if heard and not self._ever_applied:  # a sender that never says when a moment is complete
            moments += 1
            self._complete()
        return moments

    def _take_in(self, said: Said) -> bool:
        """Remember what a packet says; returns whether that is anything of use."""
        known = [(target, weight) for name, weight in said.weights.items() if (target := target_of(name))]
        self._said.update(known)
        self._bones.update(said.bones)
        if said.bones:
            self._turn = _limited(turn_of_bones(self._bones))
        elif said.turn is not None:
            self._turn = _limited(said.turn)
        return bool(known or said.bones or said.turn is not None)

    def _complete(self) -> None:
        """What was said so far is a moment; shapes that share a muscle do not add up, the stronger one wins."""
        self._weights = np.zeros(len(NAMES), np.float32)
        for target, weight in self._said.items():
            for index, part in target:
                self._weights[index] = max(self._weights[index], min(1.0, max(0.0, weight)) * part)


def _limited(turn: NDArray[np.float32]) -> NDArray[np.float32]:
    """A head turns no further than MOST_TURN, whatever the sender says."""
    angle = float(np.linalg.norm(turn))
    return turn if angle <= MOST_TURN else turn * np.float32(MOST_TURN / angle)
