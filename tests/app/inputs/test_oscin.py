"""Real packets through the loopback of this machine; nothing leaves it."""

import socket
from collections.abc import Iterator

import numpy as np
import pytest
from gemheads.app.inputs.oscin import MOST_PACKETS, MOST_TURN, FaceData
from gemheads.app.inputs.source import SourceLost
from gemheads.models.arkit import NAMES
from osc import bundle, message

pytestmark = pytest.mark.enable_socket


@pytest.fixture
def osc() -> Iterator[FaceData]:
    listener = FaceData("osc", 0)
    yield listener
    listener.close()


def send(listener: FaceData, *packets: bytes) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for packet in packets:
            sender.sendto(packet, ("127.0.0.1", listener.port))


def blend(name: str, weight: float) -> tuple[str, str, float]:
    return "/VMC/Ext/Blend/Val", name, weight


def test_the_newest_complete_moment_is_delivered_once(osc: FaceData) -> None:
    packets = [bundle(blend("jawOpen", jaw), blend("Blink_L", 1.0), ("/VMC/Ext/Blend/Apply",)) for jaw in (0.2, 0.7)]
    send(osc, *packets)
    moment = osc.read(5)
    assert moment is not None
    assert moment.weights[NAMES.index("jawOpen")] == pytest.approx(0.7)
    assert moment.weights[NAMES.index("eyeBlinkLeft")] == 1
    assert osc.drops == 1
    assert osc.read(0) is None


def test_a_moment_may_come_in_pieces(osc: FaceData) -> None:
    send(osc, message("/VMC/Ext/Blend/Apply"))
    osc.read(5)
    send(osc, message(*blend("jawOpen", 0.4)))
    assert osc.read(0.2) is None
    send(osc, message("/VMC/Ext/Blend/Apply"))
    moment = osc.read(5)
    assert moment is not None
    assert moment.weights[NAMES.index("jawOpen")] == pytest.approx(0.4)


def test_a_sender_that_never_says_apply_is_understood(osc: FaceData) -> None:
    send(osc, message(*blend("jawOpen", 0.4)))
    assert osc.read(5) is not None


def test_garbage_is_counted_and_changes_nothing(osc: FaceData) -> None:
    good = bundle(blend("jawOpen", 0.3), ("/VMC/Ext/Blend/Apply",))
    send(osc, b"garbage", message(*blend("jawOpen", float("nan"))), good, b"\0" * 5000)
    moment = osc.read(5)
    assert moment is not None
    assert moment.weights[NAMES.index("jawOpen")] == pytest.approx(0.3)
    assert np.isfinite(moment.weights).all()
    assert osc.rejected == 3


def test_weights_stay_within_their_range_and_heads_on_their_necks(osc: FaceData) -> None:
    send(
        osc,
        bundle(
            blend("jawOpen", 50.0),
            blend("mouthPucker", -3.0),
            ("/VMC/Ext/Bone/Pos", "Head", 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0),
            ("/VMC/Ext/Blend/Apply",),
        ),
    )
    moment = osc.read(5)
    assert moment is not None
    assert moment.weights.min() == 0
    assert moment.weights.max() == 1
    assert np.linalg.norm(moment.turn) == pytest.approx(MOST_TURN, rel=1e-5)


def test_a_flood_does_not_hold_the_loop(osc: FaceData) -> None:
    send(osc, *[message(*blend("jawOpen", 0.5))] * (MOST_PACKETS + 50))
    assert osc.read(5) is not None
    assert osc.rejected == 0


def test_an_iphone_is_understood() -> None:
    phone = FaceData("ifacialmocap", 0)
    try:
        send(phone, b"jawOpen-50|eyeBlink_L-100|=head#0,20,0,0,0,0|")
        moment = phone.read(5)
        assert moment is not None
        assert moment.weights[NAMES.index("jawOpen")] == pytest.approx(0.5)
        assert np.degrees(moment.turn) == pytest.approx([0, 20, 0], abs=0.01)
    finally:
        phone.close()


def test_a_port_that_is_taken_is_told() -> None:
    first = FaceData("osc", 0)
    try:
        with pytest.raises(SourceLost, match="cannot be listened on") as raised:
            FaceData("osc", first.port)
        assert raised.value.retry
    finally:
        first.close()


def test_only_this_machine_is_listened_to(osc: FaceData) -> None:
    assert osc._socket.getsockname()[0] == "127.0.0.1"
    assert osc.name.endswith("127.0.0.1:0")
