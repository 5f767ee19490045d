"""Credentials in files: what they say, that they are lost with the first changed byte, and that files stay whole."""

import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import av
import pytest
from gemheads.app.credentials.localkey import local_key
from gemheads.app.credentials.reading import read_credentials
from gemheads.app.credentials.signing import KINDS, Signer
from gemheads.app.credentials.statement import AVATAR_ALONE, WITH_DRIVER, Driver, Statement, manifest
from gemheads.app.errors import InputError, OutputError

from .conftest import STATEMENT, write_file

NAMES = ("a.png", "a.jpg", "a.mp4", "a.mov")


@pytest.mark.parametrize("name", NAMES)
def test_what_was_signed_is_read_again(name: str, signer: Signer, tmp_path: Path) -> None:
    path = write_file(tmp_path / name)
    signer.sign(path, STATEMENT)
    verdict = read_credentials(path)
    assert (verdict.state, verdict.problems, verdict.own) == ("intact", (), False)
    assert verdict.source_type == "trainedAlgorithmicMedia"
    assert verdict.ours is not None
    assert verdict.ours["avatars"][0]["consent"] == "Ada, for this test"
    assert verdict.ours["driver"] == {"kind": "video", "sha256": "cd" * 32}
    assert [file.name for file in tmp_path.iterdir()] == [name]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows links only for administrators")
def test_a_link_stays_one_and_what_it_stands_for_is_signed(signer: Signer, tmp_path: Path) -> None:
    path = write_file(tmp_path / "a.mp4")
    (tmp_path / "link.mp4").symlink_to(path)
    signer.sign(tmp_path / "link.mp4", STATEMENT)
    assert (tmp_path / "link.mp4").is_symlink()
    assert read_credentials(path).state == "intact"


def test_a_name_as_long_as_the_disk_takes_is_signed(signer: Signer, tmp_path: Path) -> None:
    path = write_file(tmp_path / f"{'n' * 251}.mp4")
    signer.sign(path, STATEMENT)
    assert read_credentials(path).state == "intact"


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("place", [0.3, 0.6, 0.9])
def test_one_changed_bit_of_the_picture_is_seen(name: str, place: float, signer: Signer, tmp_path: Path) -> None:
    path = write_file(tmp_path / name)
    before = path.read_bytes()
    signer.sign(path, STATEMENT)
    content = bytearray(path.read_bytes())
    at = content.find(before[round(len(before) * place) :][:64]) + 32
    assert at > 32
    content[at] ^= 1
    path.write_bytes(content)
    verdict = read_credentials(path)
    assert verdict.state == "altered"
    assert verdict.problems


@pytest.mark.parametrize(("old", "new"), [(b"Ada, for this test", b"Eve, for this test"), (b"CC-BY-4.0", b"CC0-1.0  ")])
def test_a_changed_consent_or_licence_is_seen(old: bytes, new: bytes, signer: Signer, tmp_path: Path) -> None:
    path = write_file(tmp_path / "a.jpg")
    signer.sign(path, STATEMENT)
    content = path.read_bytes()
    assert content.count(old) == 1
    path.write_bytes(content.replace(old, new))
    assert read_credentials(path).state == "altered"


def test_credentials_of_another_file_do_not_fit(signer: Signer, tmp_path: Path) -> None:
    """What was cut from one JPEG and put into another one."""
    path = write_file(tmp_path / "a.jpg")
    before = path.read_bytes()
    signer.sign(path, STATEMENT)
    signed = path.read_bytes()
    kept = next(n for n in range(len(before)) if before[n] != signed[n])
    segment = signed[kept - 1 : kept - 1 + len(signed) - len(before)]
    other = bytearray(before)
    other[-200] ^= 0x10
    path.write_bytes(bytes(other[: kept - 1]) + segment + bytes(other[kept - 1 :]))
    assert read_credentials(path).state == "altered"


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.95])
@pytest.mark.parametrize("name", NAMES)
def test_a_file_that_was_cut_short_is_never_intact(name: str, share: float, signer: Signer, tmp_path: Path) -> None:
    path = write_file(tmp_path / name)
    signer.sign(path, STATEMENT)
    content = path.read_bytes()
    path.write_bytes(content[: round(len(content) * share)])
    with suppress(InputError):
        assert read_credentials(path).state != "intact"


def test_a_signed_video_plays_as_before(signer: Signer, tmp_path: Path) -> None:
    def packets(path: Path) -> list[tuple[int | None, bytes]]:
        with av.open(str(path)) as container:
            return [(packet.pts, bytes(packet)) for packet in container.demux(video=0) if packet.size]

    path = write_file(tmp_path / "a.mp4")
    before = packets(path)
    signer.sign(path, STATEMENT)
    assert packets(path) == before
    assert len(before) == 24


def test_the_statement_tells_how_the_picture_came_to_be() -> None:
    def term(statement: Statement) -> str:
        return manifest(statement)["assertions"][0]["data"]["actions"][0]["digitalSourceType"]

    assert term(STATEMENT) == AVATAR_ALONE
    assert term(Statement(STATEMENT.origins, STATEMENT.driver, beside=True)) == WITH_DRIVER
    unbadged = manifest(Statement((), Driver("live"), no_badge="it is a test of this"))["assertions"][1]["data"]
    assert unbadged["badge"] == {"drawn": False, "reason": "it is a test of this"}
    assert unbadged["driver"] == {"kind": "live"}


def test_webm_is_left_as_it_is(signer: Signer, tmp_path: Path) -> None:
    path = write_file(tmp_path / "a.webm")
    before = path.read_bytes()
    assert ".webm" not in KINDS
    with pytest.raises(OutputError, match="cannot carry"):
        signer.sign(path, STATEMENT)
    assert path.read_bytes() == before


@pytest.mark.parametrize("harm", ["folder", "gone"])
def test_a_file_that_cannot_be_signed_stays_as_it_is(
    harm: str, signer: Signer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_file(tmp_path / "a.png")
    before = path.read_bytes()
    if harm == "folder":
        (tmp_path / ".a.signing.png").mkdir()
    else:

        def full(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OutputError, match="is whole, but carries no credentials"):
        signer.sign(path, STATEMENT)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir() if file.is_file()] == ["a.png"]


PROGRAM = """
import sys
from pathlib import Path
from gemheads.app.credentials.localkey import local_key
from gemheads.app.credentials.signing import Signer
from gemheads.app.credentials.statement import Driver, Statement

signer, path, before = Signer(local_key(Path(sys.argv[1]))), Path(sys.argv[2]), Path(sys.argv[3]).read_bytes()
print("ready", flush=True)
while True:
    signer.sign(path, Statement((), Driver("live")))
    aside = path.with_suffix(".again")
    aside.write_bytes(before)
    aside.replace(path)
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_a_kill_leaves_the_whole_file_signed_or_not(signer: Signer, tmp_path: Path) -> None:
    path, copy, key = tmp_path / "a.mp4", write_file(tmp_path / "copy.mp4"), tmp_path / "key.pem"
    local_key(key)
    before = copy.read_bytes()
    states = set()
    for wait in (0.001, 0.004, 0.011):
        path.write_bytes(before)
        words = [sys.executable, "-c", PROGRAM, str(key), str(path), str(copy)]
        program = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        assert program.stdout is not None
        assert program.stdout.readline() == "ready\n"
        time.sleep(wait)
        program.kill()
        program.wait()
        program.stdout.close()
        whole = path.read_bytes() == before
        states.add("none" if whole else read_credentials(path).state)
    assert states <= {"none", "intact"}


LARGE = """
import resource, sys
from pathlib import Path
import av
import numpy as np
from gemheads.app.credentials.localkey import local_key
from gemheads.app.credentials.reading import read_credentials
from gemheads.app.credentials.signing import Signer
from gemheads.app.credentials.statement import Driver, Statement

path, image = Path(sys.argv[1]), np.zeros((1080, 1920, 3), np.uint8)
with av.open(str(path), "w", options={"movflags": "frag_keyframe+delay_moov+default_base_moof"}) as container:
    stream = container.add_stream("rawvideo", rate=30)
    stream.width, stream.height, stream.pix_fmt = 1920, 1080, "rgb24"
    for _ in range(24):
        container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
signer = Signer(local_key(path.with_suffix(".pem")))
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
signer.sign(path, Statement((), Driver("live")))
grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
print(read_credentials(path).state, path.stat().st_size // 10**6, grown // 1024)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory is counted in other units elsewhere")
def test_a_long_recording_is_signed_piece_by_piece(signer: Signer, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", LARGE, str(tmp_path / "a.mov")], capture_output=True, text=True, check=True
    )
    state, megabytes, grown = done.stdout.split()
    assert state == "intact"
    assert int(megabytes) > 140
    assert int(grown) < 60
