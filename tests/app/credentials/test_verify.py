"""What ``gemheads verify`` says, and its exit codes."""

import hashlib
import os
import sys
from pathlib import Path

import pytest
from gemheads.app.cli import main
from gemheads.app.credentials.origin import Origin
from gemheads.app.credentials.papers import Papers, driver_of
from gemheads.app.credentials.signing import Signer
from gemheads.app.credentials.statement import Driver, Statement
from refusals import refused

from .conftest import write_file


@pytest.fixture
def signed(tmp_path: Path) -> Path:
    """A picture that this computer signed."""
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    path = write_file(tmp_path / "a.png")
    origin = Origin("ada\x1b[2J", "ab" * 32, licence="CC0-1.0")
    Signer().sign(path, Statement((origin,), Driver("live"), no_badge="a test without one"))
    return path


def told(capsys: pytest.CaptureFixture[str], path: Path) -> tuple[int, dict[str, str]]:
    code = main(["verify", str(path)])
    return code, {line[:12].strip(): line[13:] for line in capsys.readouterr().out.splitlines()}


def test_an_intact_file_says_whose_face_it_is(signed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, said = told(capsys, signed)
    assert code == 0
    assert said["State"].startswith("intact")
    assert said["Signed by"].startswith("the key of this computer (self-signed")
    assert said["Avatar"] == "ada [2J"  # nothing that steers a terminal
    assert said["Licence"] == "CC0-1.0"
    assert said["Consent"] == "not recorded"
    assert said["Driver"] == "live"
    assert said["Badge"] == "left out: a test without one"


def test_a_changed_file_says_so(signed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content = bytearray(signed.read_bytes())
    content[-300] ^= 1
    signed.write_bytes(content)
    code, said = told(capsys, signed)
    assert code == 6
    assert said["State"].startswith("ALTERED")
    assert "mismatch" in said["Because"]
    assert said["Signed by"].startswith("the key of this computer (self-signed")


def test_a_changed_signature_is_nobodys(signed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    content = bytearray(signed.read_bytes())
    padding = bytes(64)  # before it
    content[content.rindex(padding) + len(padding) + 10] ^= 1
    signed.write_bytes(content)
    code, said = told(capsys, signed)
    assert code == 6
    assert "claimSignature.mismatch" in said["Because"]
    assert "Signed by" not in said


def test_an_unsigned_file_says_so(tmp_path: Path, signed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, said = told(capsys, write_file(tmp_path / "b.jpg"))
    assert code == 7
    assert said["State"].startswith("no credentials")
    assert "Avatar" not in said


def test_another_computer_is_not_taken_for_this_one(
    tmp_path: Path, signed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from gemheads.app.credentials.localkey import local_key

    Signer(local_key(tmp_path / "other.pem")).sign(
        other := write_file(tmp_path / "o.png"), Statement((), Driver("live"))
    )
    assert told(capsys, other)[1]["Signed by"].startswith("gemheads on another computer (self-signed")


@pytest.mark.parametrize("name", ["none.png", "text.txt", "empty.png"])
def test_what_is_no_picture_is_one_plain_error(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    if name != "none.png":
        (tmp_path / name).write_text("hello" if name == "text.txt" else "")
    code, error = refused(capsys, "verify", tmp_path / name)
    assert code == 3
    assert name in error


def test_without_the_extra_it_says_what_to_install(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "c2pa", None)
    assert main(["verify", str(write_file(tmp_path / "a.png"))]) == 5
    assert "gemheads[credentials]" in capsys.readouterr().err


def test_papers_never_stop_a_result(tmp_path: Path, signed: Path) -> None:
    video = write_file(tmp_path / "a.webm")
    papers = Papers(Signer(), Statement((), Driver("live")))
    assert "cannot carry" in papers.sign(video)
    assert papers.signed_png(b"no picture") == b"no picture"
    assert Papers(None, Statement((), Driver("live"))).sign(video) == ""


def test_a_driver_is_told_by_the_hash_of_its_bytes_and_by_name_only_when_asked(tmp_path: Path) -> None:
    file = tmp_path / "secret name.mp4"
    file.write_bytes(b"abc")
    sha256 = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert driver_of(str(file), None) == Driver("video", sha256)
    assert driver_of(str(file), None, named=True) == Driver("video", sha256, "secret name.mp4")
    assert driver_of(None, file) == Driver("track", sha256)
    assert driver_of(str(tmp_path), None) == Driver("pictures")
    picture = file.rename(tmp_path / "face.PNG")
    assert driver_of(str(picture), None) == Driver("pictures", sha256)


def test_many_pictures_are_told_by_the_hash_of_their_hashes(tmp_path: Path) -> None:
    for number in (10, 9):
        (tmp_path / f"shot_{number}.png").write_bytes(str(number).encode())
    joined = "".join(hashlib.sha256(content).hexdigest() for content in (b"9", b"10"))  # in the order they are read
    sha256 = hashlib.sha256(joined.encode()).hexdigest()
    for driver in (tmp_path, tmp_path / "shot_%d.png", tmp_path / "shot_*.png"):
        assert driver_of(str(driver), None, named=True) == Driver("pictures", sha256, driver.name)


def test_a_video_that_came_along_with_a_track_is_told_too(signed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    statement = Statement((), Driver("track", "ab"), beside=True, along=Driver("video", "cd", "talk.mp4"))
    Signer().sign(signed, statement)
    said = told(capsys, signed)[1]
    assert (said["Driver"], said["Along"]) == ("track, sha256 ab", "video, talk.mp4, sha256 cd")


def test_a_track_beside_its_video_is_the_driver(tmp_path: Path) -> None:
    track, video = tmp_path / "a.track", tmp_path / "a.mp4"
    track.write_bytes(b"abc")
    video.write_bytes(b"def")
    assert driver_of(str(video), track, named=True) == driver_of(None, track, named=True)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems' names are Unicode")
def test_a_name_that_is_no_unicode_can_be_told(tmp_path: Path) -> None:
    file = tmp_path / os.fsdecode(b"caf\xe9.mp4")
    file.touch()
    assert driver_of(str(file), None, named=True).name == "caf\ufffd.mp4"
