import struct

import pytest
from gemheads.app.desk.actions import ACTIONS, Order
from gemheads.app.desk.remote import LOOPBACK, read_listen, read_packet
from gemheads.app.errors import UsageError
from hypothesis import given
from hypothesis import strategies as st
from osc import message


def test_every_action_can_be_asked_for_by_its_address() -> None:
    for action in ACTIONS:
        value: object = "white" if action.argument == "text" else 0.5
        expected = None if action.argument == "none" else value
        assert read_packet(message(action.osc, value)) == [Order(action.name, expected)]  # pyright: ignore
        assert read_packet(message(action.osc)) == [Order(action.name)]


def test_integers_and_truth_values_are_numbers_and_other_things_are_not() -> None:
    assert read_packet(message("/gemheads/avatar", 2)) == [Order("avatar", 2.0)]
    assert read_packet(message("/gemheads/mirror", True)) == [Order("mirror", 1.0)]
    assert read_packet(message("/gemheads/zoom", "large")) == [Order("zoom")]
    assert read_packet(message("/gemheads/open", 3)) == [Order("open")]


@pytest.mark.parametrize(
    "hostile",
    [
        b"",
        b"/",
        b"/gemheads/quit",
        b"\x00" * 64,
        b"#bundle\x00" + b"\xff" * 40,
        message("/gemheads/nothing"),
        message("/x"),
    ],
)
def test_what_is_no_order_is_none(hostile: bytes) -> None:
    assert read_packet(hostile) == []


@given(st.binary(max_size=200))
def test_no_packet_does_harm(noise: bytes) -> None:
    read_packet(noise)
    read_packet(b"/gemheads/zoom\x00\x00,f\x00\x00" + noise)
    read_packet(b"#bundle\x00" + struct.pack(">Q", 1) + noise)


def test_where_to_listen() -> None:
    assert read_listen("9000") == read_listen(":9000") == (LOOPBACK, 9000)
    assert read_listen("0.0.0.0:9000") == ("0.0.0.0", 9000)
    assert read_listen("[::1]:9000") == ("::1", 9000)
    for nonsense in ("", "host", "host:", "1:x", "99999", "0"):
        with pytest.raises(UsageError, match="HOST:PORT"):
            read_listen(nonsense)
