"""The command `train`: what it refuses before anything starts, and what it tells."""

import json
import shutil
from pathlib import Path

import pytest

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.models.gemfile import load_gem
from gemheads.models.train.perceptual import WeightsMissing
from refusals import refused
from toycapture import write_capture


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_capture(tmp_path_factory.mktemp("toy") / "capture", moments=4, size=48)


def train(*words: object) -> int:
    return main(["train", *map(str, words)])


def test_a_run_is_told_of_and_distilled(capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = tmp_path / "run"
    words = ("--no-perceptual", "--seed", 5, "--maps", 64)
    assert train(capture, "-o", run, "--steps", 3, *words) == ExitCode.OK
    said = capsys.readouterr().out
    assert "trained for 3 steps" in said
    assert "dB on the held-out camera" in said
    assert "without the VGG term" in said
    assert (run / "previews" / "000003.png").is_file()
    assert main(["distill", str(run), "-o", str(tmp_path / "toy.gem"), "--components", "2"]) == ExitCode.OK
    gem = load_gem(tmp_path / "toy.gem")
    assert gem.uv_size == 64
    assert len(gem) > 1000
    capsys.readouterr()
    code, error = refused(capsys, "train", capture, "-o", run, "--steps", 4, *words)
    assert code == ExitCode.INPUT
    assert "run of other settings; give the same ones" in error


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["--preset", "huge"], ExitCode.USAGE, "choose from tiny, small, full"),
        (["--steps", "0"], ExitCode.USAGE, "--steps 0: choose from"),
        (["--seed", "-1"], ExitCode.USAGE, "--seed: -1: choose from 0 to"),
        (["--maps", "96"], ExitCode.USAGE, "--maps 96: choose from 64, 128, 256, 512"),
    ],
)
def test_wrong_words(
    capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], code: ExitCode, said: str
) -> None:
    found, error = refused(capsys, "train", capture, "-o", tmp_path / "run", *words)
    assert found == code
    assert said in error
    assert not (tmp_path / "run").exists()


def test_a_capture_at_fault_is_named(capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, error = refused(capsys, "train", tmp_path / "nowhere", "-o", tmp_path / "run")
    assert code == ExitCode.INPUT
    assert "nowhere: is no folder" in error
    assert not (tmp_path / "run").exists()


def test_a_room_that_is_taken_for_the_person_is_told(
    capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room = tmp_path / "room"
    shutil.copytree(capture, room)
    for name in ("train", "val", "test"):
        listed = room / f"transforms_{name}.json"
        told = json.loads(listed.read_text())
        told["background"] = [0, 0.5, 0]  # it was taken before white
        for frame in told["frames"]:
            del frame["fg_mask_path"]
        listed.write_text(json.dumps(told))
    for words in (("train", room, "-o", tmp_path / "run", "--steps", 2, "--no-perceptual", "--maps", 64),
                  ("distill", room, "-o", tmp_path / "bare.gem", "--components", 2, "--maps", 64)):  # fmt: skip
        assert main([str(word) for word in words]) == ExitCode.OK
        assert "has no mask, and what is behind the person is not #008000" in capsys.readouterr().err


def test_without_its_weights_the_cure_is_told(
    capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(*words: object) -> None:
        raise WeightsMissing("vgg: its weights cannot be fetched")

    monkeypatch.setattr("gemheads.models.train.perceptual.Perceptual", missing)
    code, error = refused(capsys, "train", capture, "-o", tmp_path / "run")
    assert code == ExitCode.INPUT
    assert "--no-perceptual trains without the VGG term" in error
    assert not (tmp_path / "run").exists()


def test_a_folder_that_cannot_be_written(capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").write_text("")
    code, error = refused(capsys, "train", capture, "-o", tmp_path / "file" / "run", "--no-perceptual")
    assert code == ExitCode.OUTPUT
    assert "cannot be written" in error
