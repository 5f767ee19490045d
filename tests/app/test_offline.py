"""No command opens a socket: each runs in a program that the first one would kill, native libraries included."""

import json
from pathlib import Path

import av
import cv2
import pytest
from gemheads.app.library import DEMO_CLIP
from sealed import run_sealed

from .conftest import Clip

PROGRAM = """
import json, os, sys

os.environ["XDG_DATA_HOME"] = sys.argv[2]
from gemheads.app.cli import main

print([main(words) for words in json.loads(sys.argv[1])], file=sys.stderr)
"""


def codes(tmp_path: Path, *commands: tuple[str, ...]) -> list[int]:
    """What each of these commands ends with, one after the other in one program without sockets."""
    done = run_sealed(PROGRAM, json.dumps(commands), str(tmp_path / "data"))
    assert done.returncode == 0, done.stderr
    return json.loads(done.stderr.splitlines()[-1])


def test_commands_about_an_avatar(tiny: Path, tmp_path: Path) -> None:
    png, ply = str(tmp_path / "modes.png"), str(tmp_path / "head.ply")
    modes = ("modes", str(tiny), "-o", png, "--components", "1", "--size", "64x64", "--engine", "software")
    assert codes(tmp_path, ("info",), ("info", str(tiny)), modes, ("export", str(tiny), "-o", ply)) == [0, 0, 0, 0]


def test_commands_about_a_face(tiny: Path, tmp_path: Path) -> None:
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    avatar = ("--avatar", str(tiny), "--driver", "baseline")
    out, track = str(tmp_path / "out.mp4"), str(tmp_path / "a.track")
    picture = str(first_frame(tmp_path))
    assert codes(
        tmp_path,
        ("reenact", picture, "-o", out, *avatar, "--size", "64x64", "--engine", "software", "--neutral", "first"),
        ("track", picture, "-o", track, *avatar, "--neutral", "first"),
        ("verify", out),
    ) == [0, 0, 0]


def test_a_video_that_names_addresses_is_not_followed(tiny: Path, tmp_path: Path, make_clip: Clip) -> None:
    """A playlist in place of a video, and a video in which nobody is."""
    playlist = tmp_path / "talk.mp4"
    playlist.write_text("#EXTM3U\n#EXT-X-TARGETDURATION:5\n#EXTINF:5,\nhttp://127.0.0.1:9/a.ts\n#EXT-X-ENDLIST\n")
    rest = ("-o", str(tmp_path / "out.mp4"), "--avatar", str(tiny), "--driver", "baseline", "--engine", "software")
    assert codes(tmp_path, ("reenact", str(playlist), *rest), ("reenact", str(make_clip()), *rest)) == [3, 4]


def first_frame(folder: Path) -> Path:
    """A picture with a face in it."""
    path = folder / "face.png"
    with av.open(str(DEMO_CLIP)) as container:
        image = next(container.decode(video=0)).to_ndarray(format="bgr24")
    assert cv2.imwrite(str(path), image)
    return path
