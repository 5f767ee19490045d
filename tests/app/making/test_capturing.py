"""The command: a capture from nothing, gone on with where it was stopped, and never over anything else."""

from pathlib import Path

import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.making.capturing import ORDER
from gemheads.models.captures.reader import open_capture


def capture(out: Path, *words: object) -> int:
    small: dict[object, object] = {"--cameras": 2, "--size": "48x32", "--split": "1+1"}
    small.update(zip(words[::2], words[1::2], strict=True))
    return main(["capture", str(out), *(str(word) for pair in small.items() for word in pair)])


def test_a_capture_from_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "new" / "ada"
    assert capture(out, "--held-out", 0, "--tracking-noise", 2, "--background", "#204060") == 0
    assert "4 pictures of 1 + 1 moments from 2 cameras" in capsys.readouterr().out
    read = open_capture(out)
    assert (len(read.train), len(read.val), len(read.test)) == (1, 1, 2)
    assert read.val[0].camera_index == 0
    assert (read.train[0].camera.width, read.train[0].camera.height) == (48, 32)
    assert read.background == pytest.approx((0x20 / 255, 0x40 / 255, 0x60 / 255))

    lists = (out / "transforms_train.json").read_bytes()
    (out / "images" / "00001_01.png").unlink()
    assert capture(out, "--held-out", 0, "--tracking-noise", 2, "--background", "#204060") == 0
    assert "3 were there" in capsys.readouterr().out
    assert (out / "transforms_train.json").read_bytes() == lists

    assert capture(out) == ExitCode.USAGE
    said = capsys.readouterr().err
    assert "another held_out, background, tracking_noise_m; name another folder" in said
    (out / ORDER).write_text("{")
    assert capture(out) == ExitCode.INPUT
    assert "is broken" in capsys.readouterr().err


def test_stopped_and_gone_on_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from gemheads.models.captures.writer import CaptureWriter

    write = CaptureWriter.write_picture
    left = iter([True, True, False])

    def stopping(self: CaptureWriter, *given: object) -> None:
        if not next(left, True):
            raise KeyboardInterrupt
        write(self, *given)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(CaptureWriter, "write_picture", stopping)
    assert capture(tmp_path) == ExitCode.INTERRUPTED
    assert not (tmp_path / "transforms_train.json").exists()
    assert len(list((tmp_path / "images").iterdir())) == 2
    assert capture(tmp_path) == 0
    open_capture(tmp_path)


def test_another_folder_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert capture(tmp_path) == ExitCode.USAGE
    assert "holds something else" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    assert capture(tmp_path / "mine.txt") == ExitCode.USAGE


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--subject", "nobody"), "no such subject; there are ada"),
        (("--split", "12"), "moments to learn from + moments held out"),
        (("--split", "0+3"), "at least 1 moment"),
        (("--cameras", 1), "from 2"),
        (("--held-out", 2), "the cameras are 0 to 1"),
        (("--size", "17x20"), "must be even"),
        (("--tracking-noise", -1), "from 0 to 20 mm"),
        (("--background", "transparent"), "a picture has a ground"),
        (("--seed", -1), "choose from 0 to"),
    ],
)
def test_what_cannot_be_is_said(
    words: tuple[object, ...], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert capture(tmp_path / "new", *words) in (ExitCode.USAGE, ExitCode.INPUT)
    assert said in capsys.readouterr().err
    assert not (tmp_path / "new").exists()
