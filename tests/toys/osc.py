"""What programs send by OSC, byte by byte."""

from collections.abc import Iterable

from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder


def message(address: str, *values: object) -> bytes:
    """One message."""
    return _built(address, values).dgram


def bundle(*contents: tuple[object, ...]) -> bytes:
    """Several, each its address and its values."""
    builder = OscBundleBuilder(IMMEDIATELY)
    for address, *values in contents:
        builder.add_content(_built(str(address), values))
    return builder.build().dgram


def _built(address: str, values: Iterable[object]) -> OscMessage:
    builder = OscMessageBuilder(address)
    for value in values:
        builder.add_arg(value)  # pyright: ignore[reportArgumentType]
    return builder.build()
