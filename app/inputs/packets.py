"""What face-data packets say: the VMC protocol (OSC) and the text of iFacialMocap. Anything else is refused whole."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...render.rotations import matrix_from_wxyz, rotvec_from_matrix, wxyz_from_rotvec

Quaternion = tuple[float, float, float, float]
"""x, y, z, w"""

MAX_TEXT = 8192
"""Bytes; a packet of iFacialMocap has about 1500."""
_MOST_BUNDLES = 16
"""Bundles in a bundle in a bundle serve nobody but an attacker."""
_BEYOND = 1000.0
"""No weight or angle is larger than this: such a packet is garbage."""

_LEAST_VALUES = {"/VMC/Ext/Blend/Val": 2, "/VMC/Ext/Bone/Pos": 8}


class PacketError(ValueError):
    """A packet that is not of the protocol."""


@dataclass
class Said:
    """What a packet says."""

    weights: dict[str, float] = field(default_factory=dict)
    """Shape -> weight, 1 at the full shape; names as sent."""
    bones: dict[str, Quaternion] = field(default_factory=dict)
    """Head and Neck, each against the bone before it, in Unity's axes (x right, y up, z forward, left-handed)."""
    turn: NDArray[np.float32] | None = None
    """[3] rotation of the head, axis and angle in radians, in our axes."""
    applied: bool = False
    """Whether the sender said that a moment is complete."""


def read_vmc(packet: bytes) -> Said:
    """An OSC packet of the VMC protocol; messages of other addresses are passed over. Raises PacketError."""
    from pythonosc.osc_packet import OscPacket

    if packet.count(b"#bundle\x00") > _MOST_BUNDLES:
        raise PacketError("too many bundles in one packet")
    try:
        messages = [timed.message for timed in OscPacket(packet).messages]
    except Exception as error:  # a parser of hostile bytes may raise anything
        raise PacketError(f"not OSC: {error}") from error
    said = Said()
    for message in messages:
        values = list(message.params)
        if len(values) < _LEAST_VALUES.get(message.address, 0):
            raise PacketError(f"{message.address} with {len(values)} values")
        if message.address == "/VMC/Ext/Blend/Val":
            said.weights[_name(values[0])] = _number(values[1])
        elif message.address == "/VMC/Ext/Bone/Pos" and values[0] in ("Head", "Neck"):
            x, y, z, w = (_number(value) for value in values[4:8])
            said.bones[_name(values[0])] = (x, y, z, w)
        elif message.address == "/VMC/Ext/Blend/Apply":
            said.applied = True
    return said


def read_ifacialmocap(packet: bytes) -> Said:
    """``jawOpen-12|eyeBlink_L-0|=head#rx,ry,rz,x,y,z|...``, weights in percent; version 2 has ``&`` for ``-``.

    Raises PacketError.
    """
    if len(packet) > MAX_TEXT:
        raise PacketError(f"{len(packet)} bytes are no packet of iFacialMocap")
    try:
        parts = packet.decode("ascii").strip("\r\n\x00 ").split("|")
    except UnicodeDecodeError as error:
        raise PacketError("not text") from error
    said = Said(applied=True)
    for part in parts:
        if "#" in part:
            name, _, numbers = part.lstrip("=").partition("#")
            if name == "head":
                values = [_number(word) for word in numbers.split(",")]
                if len(values) < 3:
                    raise PacketError("a head without three angles")
                said.turn = turn_of_angles(*values[:3])
        elif part:
            name, divider, number = part.partition("&" if "&" in part else "-")
            if not divider:
                raise PacketError(f"no weight in {part[:20]!r}")
            said.weights[_name(name)] = _number(number) / 100
    if not said.weights and said.turn is None:
        raise PacketError("nothing in it")
    return said


def turn_of_angles(x_deg: float, y_deg: float, z_deg: float) -> NDArray[np.float32]:
    """[3] rotation, axis and angle, of angles about x, y, z as ARKit gives them: z is turned first, then x, then y.

    ARKit's axes of a face are ours: x to the person's left, y up, z out of the face.
    """
    x, y, z = (
        matrix_from_wxyz(wxyz_from_rotvec(math.radians(angle) * axis))
        for angle, axis in zip((x_deg, y_deg, z_deg), np.eye(3), strict=True)
    )
    return rotvec_from_matrix(y @ x @ z).astype(np.float32)


def turn_of_bones(bones: Mapping[str, Quaternion]) -> NDArray[np.float32]:
    """[3] rotation, axis and angle, of the head by its neck and itself.

    Mirroring x takes Unity's left-handed axes to ours: of a quaternion it turns y and z round.
    """
    matrix = np.eye(3)
    for bone in ("Neck", "Head"):
        x, y, z, w = bones.get(bone, (0.0, 0.0, 0.0, 1.0))
        matrix = matrix @ matrix_from_wxyz(np.array([w, x, -y, -z]))
    return rotvec_from_matrix(matrix).astype(np.float32)


def _name(value: object) -> str:
    if not isinstance(value, str) or not 0 < len(value) <= 64:
        raise PacketError("a name that is none")
    return value


def _number(value: object) -> float:
    try:
        number = float(value)  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError, OverflowError) as error:
        raise PacketError(f"not a number: {str(value)[:20]!r}") from error
    if not abs(number) <= _BEYOND:  # NaN too
        raise PacketError(f"no weight or angle: {number}")
    return number
