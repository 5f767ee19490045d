"""Decoding pictures of unknown origin, after a look at what they claim."""

import struct
from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray

MAX_PIXELS = 2**26
"""8192 x 8192."""
_PNG = b"\x89PNG\r\n\x1a\n"
_KIND_OF_COLOUR = 25
"""Where a PNG says so, in its first chunk."""
_KINDS = (_PNG, b"\xff\xd8\xff", b"RIFF", b"BM", b"II*\0", b"MM\0*")
"""How PNG, JPEG, WebP, BMP and TIFF begin. What else OpenCV could read is not asked of it."""


def decode_picture(data: bytes, flags: int = cv2.IMREAD_COLOR_RGB) -> NDArray[np.generic] | None:
    """What ``cv2.imdecode`` makes of a file's bytes; None for all that is no sound picture of at most MAX_PIXELS.

    Where colours alone are asked for, a PNG or WebP with alpha is laid on white: what colours there are where nothing
    is to be seen is anybody's guess.
    """
    if not data.startswith(_KINDS) or (data.startswith(_PNG) and not _is_sound_png(data)):
        return None
    laid = flags == cv2.IMREAD_COLOR_RGB and _has_alpha(data)
    try:
        picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED if laid else flags)
    except cv2.error:  # more pixels than gemheads/__init__.py lets it decode
        return None
    return _on_white(picture) if laid and picture is not None and picture.shape[2:] == (4,) else picture


def is_animation(data: bytes) -> bool:
    """Whether a PNG or WebP holds several pictures, of which ``decode_picture`` makes one: the PNG says how many before
    the first of them, the WebP in the header of what it extends that there are such."""
    if data.startswith(_PNG):
        said = next(((kind, at) for kind, at in _chunks(data) if kind in (b"acTL", b"IDAT")), None)
        return said is not None and said[0] == b"acTL" and struct.unpack_from(">I", data, said[1] + 8)[0] > 1
    return data[:4] == b"RIFF" and data[8:16] == b"WEBPVP8X" and len(data) > 20 and bool(data[20] & 0x02)


def _has_alpha(data: bytes) -> bool:
    """A PNG says so by its kind of colour, grey or RGB with alpha, or names a transparent colour or shade; a WebP in
    the header of what it extends or, without loss, of its one picture."""
    if data.startswith(_PNG):
        kinds = [kind for kind, _ in _chunks(data)]
        return data[_KIND_OF_COLOUR : _KIND_OF_COLOUR + 1] in (b"\4", b"\6") or b"tRNS" in kinds
    form, flags = data[8:16], data[20:25]
    extended = form == b"WEBPVP8X" and flags[:1] != b"" and bool(flags[0] & 0x10)
    return extended or (form == b"WEBPVP8L" and len(flags) == 5 and bool(flags[4] & 0x10))


def _on_white(picture: NDArray[np.generic]) -> NDArray[np.uint8]:
    """[H, W, 3] RGB bytes of [H, W, 4] BGRA of 8 or 16 bits."""
    most = 255 if picture.dtype == np.uint8 else 65535
    colour, alpha = picture[..., 2::-1].astype(np.float32), picture[..., 3:].astype(np.float32) / most
    return np.round(255 * (colour / most * alpha + 1 - alpha)).astype(np.uint8)


def _is_sound_png(data: bytes) -> bool:
    """Whether all its chunks lie within the file: OpenCV 5.0 takes gigabytes and 20 s for one that claims not to."""
    for kind, at in _chunks(data):
        length = struct.unpack_from(">I", data, at)[0]
        if length > len(data) - at - 12:
            return False
        if kind == b"IHDR":
            if length != 13:
                return False
            width, height = struct.unpack_from(">II", data, at + 8)
            if width * height > MAX_PIXELS:
                return False
        if kind == b"IEND":
            return True
    return False


def _chunks(data: bytes) -> Iterator[tuple[bytes, int]]:
    """Kinds and places of a PNG's chunks, as far as they say how long they are."""
    at = len(_PNG)
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        yield kind, at
        at += 12 + length
