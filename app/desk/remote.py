"""Orders from other programs: OSC over UDP, on this machine unless asked otherwise."""

import socket

from ..errors import InputError, UsageError
from .actions import BY_NAME, Order

LOOPBACK = "127.0.0.1"
LARGEST = 4096
"""Bytes of a packet; longer ones are cut off, and then no message."""
MOST = 64
"""Orders taken a frame: a flood leaves time for pictures."""
PREFIX = "/gemheads/"


def read_listen(text: str) -> tuple[str, int]:
    """Host and port of ``PORT``, ``:PORT`` or ``HOST:PORT``; without a host it is this machine. Raises UsageError."""
    host, _, port = text.strip().rpartition(":")
    if not port.isdecimal() or not 1 <= int(port) <= 65535:
        raise UsageError(f"--listen {text}: no address; write HOST:PORT or PORT, such as 9140")
    return host.strip("[]") or LOOPBACK, int(port)


class Remote:
    """A socket that never blocks."""

    def __init__(self, host: str, port: int) -> None:
        """Raises InputError when the port cannot be listened on."""
        try:
            family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(family, kind, protocol)
            self._socket.setblocking(False)
            self._socket.bind(address)
        except OSError as error:
            reason = error.strerror or error
            raise InputError(f"--listen {host}:{port}: {reason}; choose another port or host") from error
        self.rejected = 0
        """Packets that were no order."""

    @property
    def port(self) -> int:
        """Where it listens."""
        return self._socket.getsockname()[1]

    def orders(self) -> list[Order]:
        """What came in since the last call, the oldest first."""
        orders: list[Order] = []
        for _ in range(MOST):
            try:
                packet = self._socket.recv(LARGEST)
            except BlockingIOError:
                break
            except OSError:  # a port that nobody answers on any more, on some systems
                continue
            found = read_packet(packet)
            self.rejected += not found
            orders += found
        return orders

    def close(self) -> None:
        """Let the port go."""
        self._socket.close()


def read_packet(packet: bytes) -> list[Order]:
    """The orders of an OSC message or bundle; none for what is neither, or asks for nothing we know."""
    from pythonosc.osc_packet import OscPacket

    try:
        messages = [timed.message for timed in OscPacket(packet).messages]
    except Exception:  # the parser raises what a hostile packet makes it: ParseError, struct.error, IndexError ...
        return []
    orders = []
    for message in messages:
        name = message.address.removeprefix(PREFIX)
        if message.address.startswith(PREFIX) and name in BY_NAME:
            value = next(iter(message.params), None)
            orders.append(Order(name, _argument(BY_NAME[name].argument, value)))
    return orders


def _argument(kind: str, value: object) -> float | str | None:
    """What of a message's first argument an action of this kind can use."""
    if kind == "text":
        return value if isinstance(value, str) else None
    if kind == "none" or not isinstance(value, bool | int | float):
        return None
    return float(value)
