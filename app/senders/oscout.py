"""What the avatar does, as numbers for other programs on this machine: OSC 1.0 over UDP, one bundle a picture."""

import socket

from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder

from ..errors import OutputError, UsageError
from ..performing.performance import Pose
from .outlet import Shown

LOOPBACK = "127.0.0.1"
PORT = 9141
"""Beside 9140, on which the window listens for orders."""


class CoefficientsOut:
    """An outlet of poses: /gemheads/avatar, /gemheads/head and /gemheads/coefficients in one bundle."""

    def __init__(self, port: int = PORT, host: str = LOOPBACK) -> None:
        """``host`` is this machine unless asked otherwise. Raises UsageError, and OutputError for an unknown host."""
        if not 1 <= port <= 65535:
            raise UsageError(f"coefficients to port {port}: a port is 1 to 65535; {PORT} is a good one")
        try:
            family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._socket = socket.socket(family, kind, protocol)
        except OSError as error:
            raise OutputError(f"coefficients to {host}:{port}: {error.strerror}; check the name of the host") from error
        self._address, self._where = address, f"{host}:{port}"
        self._count = 0

    @property
    def status(self) -> str:
        """Where they go."""
        return f"coefficients to {self._where}, {self._count} sent"

    def send(self, shown: Shown) -> None:
        """Send one pose; pictures without one are passed by, and so is a listener who is not there."""
        if shown.pose is None:
            return
        try:
            self._socket.sendto(pose_bundle(shown.pose, shown.avatar), self._address)
        except ConnectionRefusedError:
            pass  # nobody listens yet
        except OSError as error:
            raise OutputError(f"coefficients to {self._where}: {error.strerror}; check the network") from error
        self._count += 1

    def close(self) -> None:
        """Let the port go."""
        self._socket.close()


def pose_bundle(pose: Pose, avatar: str) -> bytes:
    """One OSC bundle of a pose.

    /gemheads/avatar: string, SHA-256 of the avatar's file, to which alone the coefficients mean something.
    /gemheads/head: 3 floats, rotation of the head from its rest, axis and angle in radians (x pitch, y yaw, z roll).
    /gemheads/coefficients: the flat vector in the avatar's own units: position, rotation, scale, opacity.
    """
    bundle = OscBundleBuilder(IMMEDIATELY)  # pyright: ignore[reportArgumentType]
    for address, values in (
        ("avatar", [avatar]),
        ("head", pose.turn.tolist()),
        ("coefficients", pose.coefficients.tolist()),
    ):
        message = OscMessageBuilder(f"/gemheads/{address}")
        for value in values:
            message.add_arg(value)
        bundle.add_content(message.build())  # pyright: ignore[reportArgumentType]
    return bundle.build().dgram
