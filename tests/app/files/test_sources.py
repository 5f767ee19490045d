"""What a word of the command line names as a driver: pictures, folders, sequences, and what is none."""

import os
import struct
import sys
import zlib
from fractions import Fraction
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.errors import InputError
from gemheads.app.files.crop import read_crop
from gemheads.app.files.sources import open_source

from ..conftest import Clip


def write_png(path: Path, value: int, size: tuple[int, int] = (20, 16)) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), np.full((size[1], size[0], 3), value, np.uint8))


def test_large_photographs_are_scaled_down_as_videos_are(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((100, 4000, 3), np.uint8))
    scaled, whole = open_source(str(tmp_path)), open_source(str(tmp_path), longest_side=5000)
    for source, size in ((scaled, (1920, 48)), (whole, (4000, 100))):
        assert source.size == size
        assert next(source.frames()).rgb.shape == source.samples(1)[0].rgb.shape == (size[1], size[0], 3)


def test_a_part_of_a_large_photograph_keeps_its_pixels(tmp_path: Path) -> None:
    picture = np.random.default_rng(0).integers(0, 255, (100, 4000, 3), np.uint8)
    cv2.imwrite(str(tmp_path / "a.png"), picture[..., ::-1])
    source = open_source(str(tmp_path), crop=read_crop("25,20,40,80"))
    assert source.size == (1600, 80)
    for frame in (next(source.frames()), source.samples(1)[0]):
        np.testing.assert_array_equal(frame.rgb, picture[20:, 1000:2600])


def test_of_a_video_the_same_part_is_seen_in_frames_and_samples(make_clip: Clip) -> None:
    clip = str(make_clip("clip.mp4"))
    crop, whole = read_crop("right"), open_source(clip)
    source = open_source(clip, crop=crop)
    assert source.size == (whole.size[0] // 2, whole.size[1])
    for part, frame in zip(source.frames(), whole.frames(), strict=True):
        np.testing.assert_array_equal(part.rgb, crop.of(frame.rgb))
        assert part.pts == frame.pts
    np.testing.assert_array_equal(source.samples(1)[0].rgb, crop.of(whole.samples(1)[0].rgb))


@pytest.mark.skipif(sys.platform == "win32", reason="no file can be called so")
def test_a_name_with_a_colon_is_no_protocol(make_clip: Clip, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make_clip("2024-05-01T10:30:00.mp4")
    monkeypatch.chdir(tmp_path)
    assert len(list(open_source("2024-05-01T10:30:00.mp4").frames())) == 4


def test_what_macos_puts_beside_a_picture_is_not_read(tmp_path: Path) -> None:
    write_png(tmp_path / "shot.png", 7)
    (tmp_path / "._shot.png").write_bytes(b"\0\5\x16\7 attributes")
    assert [int(frame.rgb[0, 0, 0]) for frame in open_source(str(tmp_path)).frames()] == [7]


def test_folders_are_read_in_the_order_of_their_numbers(tmp_path: Path) -> None:
    for number in (10, 2, 1):
        write_png(tmp_path / "shots" / f"frame{number}.png", number)
    (tmp_path / "shots" / "notes.txt").touch()
    source = open_source(str(tmp_path / "shots"), Fraction(25))
    assert [int(frame.rgb[0, 0, 0]) for frame in source.frames()] == [1, 2, 10]
    assert [frame.seconds for frame in source.frames()] == pytest.approx([0, 0.04, 0.08])
    assert source.frame_count == 3
    assert source.size == (20, 16)


@pytest.mark.parametrize("pattern", ["shot_%03d.png", "shot_*.png", "shot_0[0-9]?.png"])
def test_sequences_by_pattern(tmp_path: Path, pattern: str) -> None:
    for number in (0, 1, 12):
        write_png(tmp_path / f"shot_{number:03d}.png", number)
    write_png(tmp_path / "other.png", 99)
    source = open_source(str(tmp_path / pattern))
    assert [int(frame.rgb[0, 0, 0]) for frame in source.frames()] == [0, 1, 12]


def test_a_pattern_names_numbers_alone(tmp_path: Path) -> None:
    for name in ("shot_0001.png", "shot_0001_mask.png", "shot_left_0001.png", "shot_²1.png"):
        write_png(tmp_path / name, 7)
    source = open_source(str(tmp_path / "shot_%04d.png"))
    assert len(list(source.frames())) == 1
    assert len(list(open_source(str(tmp_path)).frames())) == 4


def test_a_part_too_small_to_look_at_is_named(tmp_path: Path, make_clip: Clip) -> None:
    write_png(tmp_path / "a.png", 7, (40, 40))
    for source in (str(tmp_path / "a.png"), str(tmp_path), str(make_clip("clip.mp4"))):
        with pytest.raises(InputError, match=r"--crop 0,0,25,5 leaves \d+x\d+ pixels; .* at least 16 to a side"):
            open_source(source, crop=read_crop("0,0,25,5"))


@pytest.mark.parametrize("size", [(8, 20), (20, 1), (16400, 20)])
def test_a_picture_in_which_no_face_can_be_looked_for_is_told(tmp_path: Path, size: tuple[int, int]) -> None:
    write_png(tmp_path / "thin.png", 7, size)
    with pytest.raises(InputError, match=f"{size[0]}x{size[1]} pixels; give pictures with sides from 16 to 16384"):
        open_source(str(tmp_path / "thin.png"))


def test_one_picture_is_a_clip_of_one_frame(tmp_path: Path) -> None:
    write_png(tmp_path / "ä face.png", 7)
    assert [int(frame.rgb[0, 0, 0]) for frame in open_source(str(tmp_path / "ä face.png")).frames()] == [7]


def test_colours_are_red_green_blue(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "red.png"), np.full((20, 20, 3), (0, 0, 200), np.uint8))
    assert next(open_source(str(tmp_path / "red.png")).frames()).rgb[0, 0].tolist() == [200, 0, 0]


@pytest.mark.parametrize("depth", [np.uint8, np.uint16])
def test_a_png_with_alpha_is_laid_on_white(tmp_path: Path, depth: type) -> None:
    most = np.iinfo(depth).max
    image = np.zeros((20, 20, 4), depth)
    image[:, :10] = (0, 0, most, 0)  # red that nobody is to see
    image[:, 10:] = (most, 0, 0, most)
    cv2.imwrite(str(tmp_path / "cut.png"), image)
    rgb = next(open_source(str(tmp_path / "cut.png")).frames()).rgb
    assert rgb[0, 0].tolist() == [255, 255, 255]
    assert rgb[0, 15].tolist() == [0, 0, 255]


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


@pytest.mark.parametrize("kind", [2, 3], ids=["one colour of all", "one of a palette"])
def test_a_png_that_names_a_transparent_colour_is_laid_on_white(tmp_path: Path, kind: int) -> None:
    row = b"\0" + (bytes(10) + b"\1" * 10 if kind == 3 else bytes(30) + b"\xff\0\0" * 10)
    parts = [chunk(b"IHDR", struct.pack(">IIBBBBB", 20, 20, 8, kind, 0, 0, 0))]
    parts += [chunk(b"PLTE", bytes([0, 0, 0, 255, 0, 0]))] if kind == 3 else []
    parts += [chunk(b"tRNS", b"\0\xff" if kind == 3 else bytes(6))]
    parts += [chunk(b"IDAT", zlib.compress(row * 20)), chunk(b"IEND", b"")]
    (tmp_path / "named.png").write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))
    rgb = next(open_source(str(tmp_path / "named.png")).frames()).rgb
    assert rgb[0, 0].tolist() == [255, 255, 255]
    assert rgb[0, 15].tolist() == [255, 0, 0]


@pytest.mark.parametrize("quality", [101, 95], ids=["without loss", "with loss"])
def test_a_webp_with_alpha_is_laid_on_white(tmp_path: Path, quality: int) -> None:
    image = np.zeros((32, 32, 4), np.uint8)
    image[:, 16:] = (255, 0, 0, 255)
    for alpha in (True, False):
        path = tmp_path / f"{alpha}.webp"
        cv2.imwrite(str(path), image if alpha else image[..., :3], [cv2.IMWRITE_WEBP_QUALITY, quality])
        rgb = next(open_source(str(path)).frames()).rgb
        assert rgb[5, 5].tolist() == [255 * alpha] * 3
        assert rgb[5, 28].tolist() == pytest.approx([0, 0, 255], abs=3)


def test_what_is_missing_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.mp4: no such file or folder"):
        open_source(str(tmp_path / "none.mp4"))
    with pytest.raises(InputError, match="no such file or folder"):
        open_source(str(tmp_path / "none_%03d.png"))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no named pipes")
def test_a_pipe_is_told(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.mp4")
    with pytest.raises(InputError, match=r"pipe\.mp4: a pipe or device, and a driver is read twice; save it"):
        open_source(str(tmp_path / "pipe.mp4"))


def test_a_folder_without_pictures_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"a folder without pictures; it needs files ending in .*\.png"):
        open_source(str(tmp_path))


def test_an_empty_file_is_told(tmp_path: Path) -> None:
    (tmp_path / "empty.mp4").touch()
    with pytest.raises(InputError, match="the file is empty"):
        open_source(str(tmp_path / "empty.mp4"))


def test_what_is_not_a_video_is_told(tmp_path: Path) -> None:
    (tmp_path / "text.mp4").write_text("not a video at all " * 100)
    with pytest.raises(InputError, match="not a readable video"):
        open_source(str(tmp_path / "text.mp4"))


def test_a_picture_that_is_none_is_told(tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"\x89PNG nothing")
    with pytest.raises(InputError, match=r"broken\.png: is not a picture"):
        open_source(str(tmp_path / "broken.png"))


@pytest.mark.parametrize("name", ["a.png", "a.webp"])
def test_an_animation_is_no_picture(tmp_path: Path, name: str) -> None:
    path, animation = tmp_path / name, cv2.Animation()
    animation.frames = [np.full((32, 32, 3), shade, np.uint8) for shade in (40, 200)]
    animation.durations = [40, 40]
    _, content = cv2.imencodeanimation(path.suffix, animation)
    path.write_bytes(content.tobytes())
    with pytest.raises(InputError, match="is an animation, of which one picture would be read; convert it to mp4"):
        open_source(str(path))
    assert cv2.imwrite(str(path), animation.frames[0])
    assert open_source(str(path)).size == (32, 32)
