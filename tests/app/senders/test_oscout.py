import socket

import numpy as np
import pytest
from gemheads.app.errors import OutputError, UsageError
from gemheads.app.performing.performance import Pose
from gemheads.app.senders.oscout import CoefficientsOut, pose_bundle
from gemheads.app.senders.outlet import Shown
from pythonosc.osc_bundle import OscBundle
from pythonosc.osc_message import OscMessage

PICTURE = np.zeros((2, 2, 3), np.uint8)
POSE = Pose(np.linspace(-1, 1, 200).astype(np.float32), np.float32([0.1, -0.2, 0.3]))


def contents(data: bytes) -> dict[str, list]:
    messages = [message for message in OscBundle(data) if isinstance(message, OscMessage)]
    return {message.address: list(message.params) for message in messages}


def test_a_bundle_says_whose_coefficients_they_are() -> None:
    read = contents(pose_bundle(POSE, "ab" * 32))
    assert list(read) == ["/gemheads/avatar", "/gemheads/head", "/gemheads/coefficients"]
    assert read["/gemheads/avatar"] == ["ab" * 32]
    assert read["/gemheads/head"] == POSE.turn.tolist()
    assert read["/gemheads/coefficients"] == POSE.coefficients.tolist()
    assert len(pose_bundle(POSE, "ab" * 32)) < 1400  # one packet, not two


@pytest.mark.enable_socket
def test_poses_arrive_on_this_machine() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(10)
        out = CoefficientsOut(listener.getsockname()[1])
        out.send(Shown(PICTURE, 0.0))  # a picture without a pose is nobody's performance
        out.send(Shown(PICTURE, 0.1, POSE, "cd" * 32))
        data, sender = listener.recvfrom(65536)
        assert sender[0] == "127.0.0.1"
        assert contents(data)["/gemheads/avatar"] == ["cd" * 32]
        assert out.status == f"coefficients to 127.0.0.1:{listener.getsockname()[1]}, 1 sent"
        out.close()


@pytest.mark.enable_socket
def test_nobody_listening_is_no_failure() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    out = CoefficientsOut(port)
    for number in range(3):
        out.send(Shown(PICTURE, float(number), POSE))
    out.close()


@pytest.mark.enable_socket
def test_what_cannot_be_is_said() -> None:
    with pytest.raises(UsageError, match="a port is 1 to 65535"):
        CoefficientsOut(0)
    with pytest.raises(OutputError, match="check the name of the host"):
        CoefficientsOut(9000, "no such host.invalid")
