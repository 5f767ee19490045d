"""Pictures of a capture: their size from the header alone, and their pixels."""

import os
import struct
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from ..picturefile import MAX_PIXELS, decode_picture
from ..wholefile import open_ordinary
from .layout import CaptureError

MAX_BYTES = 5 * MAX_PIXELS
"""Of a picture's file; four channels of the largest that is decoded have less."""
_MAX_SEGMENTS = 2**12
"""Of a JPEG before its size is told; a real one has a hundred at most."""
_PNG = b"\x89PNG\r\n\x1a\n"
_PNG_END = b"\x00\x00\x00\x00IEND\xaeB`\x82"
_JPEG, _JPEG_END = b"\xff\xd8", b"\xff\xd9"
_LAST = 4096
"""Bytes in which a picture ends; some programs put notes behind it."""
_GREY = 16
"""Channels of a shade differ by no more, be it by what a JPEG loses."""
_AGAIN = "export it again as PNG or JPEG"


def picture_size(path: Path) -> tuple[int, int]:
    """Width and height, from the first bytes of a PNG or JPEG, whose last ones are looked for. Raises CaptureError."""
    try:
        with open_ordinary(path) as (file, size):
            head = file.read(26)
            if head.startswith(_PNG) and len(head) == 26 and head[12:16] == b"IHDR":
                width, height, depth = struct.unpack(">IIB", head[16:25])
                file.seek(-min(_LAST, size), os.SEEK_END)
                return _sound(path, width, height, depth, _PNG_END in file.read())
            if head.startswith(_JPEG):
                file.seek(2)
                for _ in range(_MAX_SEGMENTS):
                    mark = file.read(4)
                    if len(mark) < 4 or mark[0] != 0xFF:
                        break
                    kind, length = mark[1], struct.unpack(">H", mark[2:])[0]
                    if 0xC0 <= kind <= 0xCF and kind not in (0xC4, 0xC8, 0xCC):  # a start of frame
                        depth, height, width = struct.unpack(">BHH", file.read(5))
                        file.seek(-min(_LAST, size), os.SEEK_END)
                        return _sound(path, width, height, depth, _JPEG_END in file.read())
                    file.seek(length - 2, 1)
    except FileNotFoundError:
        raise CaptureError(path, "is missing", "copy it there, or take its frame out of the transforms file") from None
    except (OSError, struct.error, ValueError) as error:
        said = getattr(error, "strerror", None) or error
        raise CaptureError(path, f"cannot be read ({said})", _AGAIN) from error
    raise CaptureError(path, "is neither PNG nor JPEG", _AGAIN)


def _sound(path: Path, width: int, height: int, depth: int, ends: bool) -> tuple[int, int]:
    """The size of a picture that will be read, hours later. Raises CaptureError for one that will not."""
    if depth > 8:
        raise CaptureError(path, f"has {depth} bits a channel", "export it again with 8 bits a channel")
    if not ends:
        raise CaptureError(path, "breaks off before its end", "copy it again")
    return width, height


def read_pixels(path: Path, width: int, height: int) -> NDArray[np.uint8]:
    """RGB [H, W, 3] or RGBA [H, W, 4], sRGB. Raises CaptureError where it is broken or of another size."""
    try:
        with open_ordinary(path) as (file, size):
            if size > MAX_BYTES:
                raise CaptureError(path, f"has {size} bytes, at most {MAX_BYTES} are read", _AGAIN)
            decoded = decode_picture(file.read(size), cv2.IMREAD_UNCHANGED)
    except OSError as error:
        said = error.strerror or error
        raise CaptureError(path, f"cannot be read ({said})", "the capture changed while it was used") from error
    if decoded is None or decoded.dtype != np.uint8:
        raise CaptureError(path, "is broken, or not of 8 bits a channel", _AGAIN)
    image = np.asarray(decoded, np.uint8)
    if image.shape[:2] != (height, width):
        raise CaptureError(path, f"is {image.shape[1]}x{image.shape[0]}, not {width}x{height}", _AGAIN)
    if image.ndim == 2:
        image = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    swap = cv2.COLOR_BGRA2RGBA if image.shape[2] == 4 else cv2.COLOR_BGR2RGB
    return np.asarray(cv2.cvtColor(image, swap), np.uint8)


def read_mask(path: Path, width: int, height: int) -> NDArray[np.uint8]:
    """How much of each pixel is the person, [H, W]: the alpha, or where that is opaque throughout, the shade.

    Raises CaptureError, also for colours: which of them would be the mask?
    """
    pixels = read_pixels(path, width, height)
    if pixels.shape[2] == 4 and pixels[..., 3].min() < 255:
        return pixels[..., 3]
    colours = pixels[..., :3]
    if max(cv2.absdiff(colours[..., 0], colours[..., other]).max() for other in (1, 2)) > _GREY:
        raise CaptureError(path, "has colours, which no mask has", "export it in shades of grey, white the person")
    return colours[..., 0]


def png_bytes(pixels: NDArray[np.uint8]) -> bytes:
    """A PNG of RGB [H, W, 3], RGBA [H, W, 4] or one channel [H, W]."""
    if pixels.ndim == 3:
        pixels = np.ascontiguousarray(pixels[..., [2, 1, 0, 3][: pixels.shape[2]]])
    return cv2.imencode(".png", pixels)[1].tobytes()
