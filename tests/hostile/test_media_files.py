"""Videos and pictures that want to reach beyond themselves, or to fill the memory."""

import socket
import struct
import time
import zlib
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from gemheads.app.errors import InputError
from gemheads.app.files.audio import AudioCopy
from gemheads.app.files.sources import open_source, read_image

PLAYLIST = "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n{address}\n#EXT-X-ENDLIST\n"
CONCAT = "ffconcat version 1.0\nfile {address}\n"


@pytest.fixture
def private(tmp_path: Path) -> Path:
    """A video that nobody named."""
    path = tmp_path / "private.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for _ in range(3):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.zeros((48, 64, 3), np.uint8), format="rgb24")))
        container.mux(stream.encode())
    return path


def test_a_list_of_files_called_a_video_leads_to_none_of_them(tmp_path: Path, private: Path) -> None:
    """FFmpeg goes by the content, whatever the name: such a "video" would show other files of this machine."""
    path = tmp_path / "clip.mp4"
    path.write_text(CONCAT.format(address=private.name))
    with av.open(str(path)) as container:
        assert len(list(container.decode(video=0))) == 3  # without the guard
    with pytest.raises(InputError, match="not a readable video"):
        open_source(str(path))
    with pytest.raises(av.error.FFmpegError, match="Invalid"):
        AudioCopy(path, None)


@pytest.mark.enable_socket
def test_a_playlist_calls_nobody(tmp_path: Path) -> None:
    path = tmp_path / "clip.m3u8"
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(8)
        server.setblocking(False)
        path.write_text(PLAYLIST.format(address=f"http://127.0.0.1:{server.getsockname()[1]}/private.ts"))
        with pytest.raises(InputError, match="not a readable video"):
            open_source(str(path))
        with pytest.raises(BlockingIOError):
            server.accept()


def png(*chunks: tuple[bytes, bytes], lie: int | None = None) -> bytes:
    """A PNG of these chunks; the last one claims to be ``lie`` bytes long."""
    content = b"\x89PNG\r\n\x1a\n"
    for number, (kind, body) in enumerate(chunks, 1):
        length = lie if lie is not None and number == len(chunks) else len(body)
        content += struct.pack(">I", length) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    return content


def head(width: int, height: int) -> tuple[bytes, bytes]:
    return b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)


def test_a_chunk_of_four_gigabytes(tmp_path: Path) -> None:
    """OpenCV 5.0 believes the length, and takes 20 s and 4 GB."""
    refused(tmp_path, png(head(4, 4), (b"IDAT", zlib.compress(bytes(52))), lie=2**32 - 1))


def test_a_second_header_of_two_bytes_at_the_very_end(tmp_path: Path) -> None:
    """What it should say of width and height lies beyond the file."""
    refused(tmp_path, png(head(4, 4), (b"IDAT", zlib.compress(bytes(52))), (b"IHDR", b"\0\0")))


def test_a_picture_of_a_billion_pixels(tmp_path: Path) -> None:
    """A megabyte of zeros, well packed, is three gigabytes of black."""
    rows = zlib.compress(bytes(2**20))
    refused(tmp_path, png(head(2**15, 2**15), (b"IDAT", rows), (b"IEND", b"")))


def test_a_bitmap_of_a_billion_pixels(tmp_path: Path) -> None:
    ok, small = cv2.imencode(".bmp", np.zeros((4, 4, 3), np.uint8))
    assert ok
    content = bytearray(small.tobytes())
    content[18:26] = struct.pack("<ii", 2**15, 2**15)
    refused(tmp_path, bytes(content))


@pytest.mark.parametrize("content", [b"P6 2 2 255 " + bytes(12), b"#?RADIANCE\n", b"\x59\xa6\x6a\x95" + bytes(64)])
def test_kinds_that_nobody_photographs_in_are_not_read(tmp_path: Path, content: bytes) -> None:
    refused(tmp_path, content)


def refused(folder: Path, content: bytes) -> None:
    path = folder / "picture.png"
    path.write_bytes(content)
    began = time.process_time()
    with pytest.raises(InputError, match="is not a picture that can be decoded"):
        read_image(path)
    assert time.process_time() - began < 1


def test_a_sound_picture_is_read(tmp_path: Path) -> None:
    pixels = (np.arange(768) % 251).astype(np.uint8).reshape(16, 16, 3)
    cv2.imwrite(str(tmp_path / "picture.png"), pixels)
    np.testing.assert_array_equal(read_image(tmp_path / "picture.png"), pixels[..., ::-1])
