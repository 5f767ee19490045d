import math

import numpy as np
import pytest
from gemheads.app.inputs.arkitnames import target_of
from gemheads.app.inputs.packets import PacketError, read_ifacialmocap, read_vmc, turn_of_angles, turn_of_bones
from gemheads.models.arkit import NAMES
from hypothesis import given, settings
from hypothesis import strategies as st
from osc import bundle, message


@pytest.mark.parametrize(
    ("sent", "meant"),
    [
        ("jawOpen", "jawOpen"),
        ("JawOpen", "jawOpen"),
        ("eyeBlink_L", "eyeBlinkLeft"),
        ("eyeBlink_r", "eyeBlinkRight"),
        ("mouthSmile.R", "mouthSmileRight"),
        ("MOUTH_SMILE_LEFT", "mouthSmileLeft"),
        ("mouthLeft", "mouthLeft"),
        ("browInnerUp", "browInnerUp"),
    ],
)
def test_spellings_mean_the_same_shape(sent: str, meant: str) -> None:
    assert target_of(sent) == ((NAMES.index(meant), 1.0),)


def test_vrm_shapes_are_said_in_arkit_and_others_are_not_known() -> None:
    assert target_of("A") == target_of("aa") == ((NAMES.index("jawOpen"), 0.7),)
    assert {NAMES[index] for index, _ in target_of("Blink") or ()} == {"eyeBlinkLeft", "eyeBlinkRight"}
    assert {NAMES[index] for index, _ in target_of("Blink_L") or ()} == {"eyeBlinkLeft"}
    assert target_of("noSuchShape") is None
    assert target_of("a" * 1000) is None
    assert all(target_of(name) == ((index, 1.0),) for index, name in enumerate(NAMES))


def test_a_vmc_bundle_says_weights_bones_and_that_it_is_complete() -> None:
    said = read_vmc(
        bundle(
            ("/VMC/Ext/OK", 1),
            ("/VMC/Ext/Bone/Pos", "Head", 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.995),
            ("/VMC/Ext/Bone/Pos", "LeftHand", 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.5),
            ("/VMC/Ext/Blend/Val", "jawOpen", 0.5),
            ("/VMC/Ext/Blend/Apply",),
        )
    )
    assert said.weights == {"jawOpen": 0.5}
    assert list(said.bones) == ["Head"]
    assert said.applied


def test_ifacialmocap_says_percents_and_degrees_in_both_versions() -> None:
    text = "jawOpen-50|eyeBlink_L-100|hapihapi-0|=head#10,-20,5,0.1,0.2,0.3|rightEye#1,2,3|leftEye#1,2,3|"
    for packet in (text, text.replace("-50", "&50").replace("-100", "&100").replace("hapi-0", "hapi&0")):
        said = read_ifacialmocap(packet.encode())
        assert said.weights == {"jawOpen": 0.5, "eyeBlink_L": 1.0, "hapihapi": 0.0}
        assert said.turn is not None
        assert np.degrees(said.turn)[1] == pytest.approx(-20, abs=1.5)


def test_a_head_turned_in_unity_is_turned_the_same_way_here() -> None:
    """Unity, left-handed: positive x looks down, positive y turns to the person's right. Here y is to the left."""
    half = math.radians(30) / 2
    down = turn_of_bones({"Head": (math.sin(half), 0, 0, math.cos(half))})
    right = turn_of_bones({"Head": (0, math.sin(half), 0, math.cos(half))})
    assert np.degrees(down) == pytest.approx([30, 0, 0], abs=1e-3)
    assert np.degrees(right) == pytest.approx([0, -30, 0], abs=1e-3)
    both = turn_of_bones({name: (0, math.sin(half), 0, math.cos(half)) for name in ("Neck", "Head")})
    assert np.degrees(both) == pytest.approx([0, -60, 0], abs=1e-3)
    assert turn_of_bones({"Head": (0, 0, 0, 0)}).tolist() == [0, 0, 0]


def test_angles_turn_about_their_axes() -> None:
    for axis in range(3):
        angles = [0.0, 0.0, 0.0]
        angles[axis] = 40.0
        assert np.degrees(turn_of_angles(*angles)) == pytest.approx(angles, abs=1e-3)


NOT_VMC = [
    b"",
    b"garbage",
    b"/VMC/Ext/Blend/Val\0\0",
    b"#bundle\0" + b"\xff" * 40,
    b"#bundle\0" + b"\0" * 8 + b"\xff\xff\xff\xff",
    message("/VMC/Ext/Blend/Val", "jawOpen", float("nan")),
    message("/VMC/Ext/Blend/Val", "jawOpen", 1e30),
    message("/VMC/Ext/Blend/Val", 5, 0.5),
    message("/VMC/Ext/Blend/Val", "jawOpen", "wide"),
    message("/VMC/Ext/Bone/Pos", "Head", 0.0, 0.0, 0.0, float("inf"), 0.0, 0.0, 1.0),
    b"#bundle\0\0\0\0\0\0\0\0\1\0\0\0\x10" * 2000,
]


@pytest.mark.parametrize("packet", NOT_VMC, ids=range(len(NOT_VMC)))
def test_hostile_osc_is_refused(packet: bytes) -> None:
    with pytest.raises(PacketError):
        read_vmc(packet)


NOT_TEXT = [
    b"",
    b"\xff\xfe",
    b"jawOpen",
    b"jawOpen-nan",
    b"jawOpen-1e9",
    b"=head#1,2",
    b"=head#1,2,x",
    b"x" * 100_000,
    b"|" * 50,
]


@pytest.mark.parametrize("packet", NOT_TEXT, ids=range(len(NOT_TEXT)))
def test_hostile_text_is_refused(packet: bytes) -> None:
    with pytest.raises(PacketError):
        read_ifacialmocap(packet)


@given(st.binary(max_size=300))
@settings(max_examples=150, deadline=None)
def test_no_packet_raises_anything_else(packet: bytes) -> None:
    for read in (read_vmc, read_ifacialmocap):
        try:
            said = read(packet)
        except PacketError:
            continue
        assert all(math.isfinite(weight) for weight in said.weights.values())
