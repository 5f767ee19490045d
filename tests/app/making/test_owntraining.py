"""``gemheads train-regressor`` with a capture: what it refuses, before anything is learned."""

from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

import toycapture
from gemheads.app.errors import ExitCode
from gemheads.app.library import find_avatar
from gemheads.models.captures.layout import CaptureError
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem, save_gem
from gems import statue
from refusals import refused


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return toycapture.write_capture(tmp_path_factory.mktemp("captures") / "toy", moments=4)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--pictures", "3"), "--pictures 3: choose 40 or more, or 0"),
        (("--pictures", "-1"), "--pictures -1: choose 40 or more"),
        (("--steps", "0"), "--steps 0: choose 1 or more"),
        (("--seed", "-1"), "--seed: -1: choose from 0"),
        (("--pictures", "0", "--companions", "theo"), "--companions: does nothing for --pictures 0"),
        (("--pictures", "0", "--jobs", "1"), "--jobs: does nothing for --pictures 0"),
        (("--pictures", "0", "talk.mp4"), "talk.mp4: does nothing for --pictures 0"),
    ],
)
def test_numbers_that_cannot_be(
    capture: Path, words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, error = refused(capsys, "train-regressor", "mara", str(capture), *words)
    assert code == ExitCode.USAGE
    assert said in error


def test_two_captures_are_two_people(capture: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, error = refused(capsys, "train-regressor", "mara", str(capture), str(capture))
    assert code == ExitCode.USAGE
    assert "second capture" in error


def test_an_avatar_that_does_not_move_learns_nothing(
    capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_gem(statue(), tmp_path / "statue.gem")
    code, error = refused(capsys, "train-regressor", tmp_path / "statue.gem", capture, "--pictures", "0")
    assert code == ExitCode.INPUT
    assert "does not move, so no face can drive it" in error


def test_videos_are_looked_for_before_anything_is_fitted(
    capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for place, said in ((tmp_path, "is a folder, and no capture"), (tmp_path / "no.mp4", "no such video")):
        code, error = refused(capsys, "train-regressor", "mara", capture, place)
        assert code == ExitCode.INPUT
        assert f"{place}: {said}" in error


@pytest.mark.parametrize("words", [("--rehearse-with", "theo"), ("--turns-only",)])
def test_a_person_with_frames_learns_of_them_alone(
    capture: Path, words: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    code, error = refused(capsys, "train-regressor", "mara", str(capture), *words)
    assert code == ExitCode.USAGE
    assert f"{words[0]} does not go with a capture" in error


def test_taking_over_learns_from_nothing(capture: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, error = refused(capsys, "train-regressor", "mara", str(capture), "--take-over", "theo")
    assert code == ExitCode.USAGE
    assert "--take-over trains nothing" in error


@pytest.mark.parametrize("option", ["--labels", "--report", "--strip"])
def test_what_needs_a_capture_says_so(option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, error = refused(capsys, "train-regressor", "mara", option, str(tmp_path / "x"))
    assert code == ExitCode.USAGE
    assert "need a capture" in error


def test_another_avatars_labels_and_missing_ones(
    capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train-regressor", "mara", str(capture), "-o", str(tmp_path / "out.gem"), "--pictures", "0"]
    code, error = refused(capsys, *words, "--labels", str(tmp_path / "none.track"))
    assert code == ExitCode.INPUT
    assert "none.track" in error
    assert not (tmp_path / "out.gem").exists()


@pytest.mark.parametrize("option", ["--report", "--strip"])
@pytest.mark.parametrize("which", ["avatar", "labels"])
def test_nothing_that_is_read_is_written_over(
    capture: Path, tmp_path: Path, option: str, which: str, capsys: pytest.CaptureFixture[str]
) -> None:
    places = {"avatar": tmp_path / "copy.gem", "labels": tmp_path / "labels.track"}
    places["avatar"].write_bytes(find_avatar("mara").read_bytes())
    places["labels"].write_bytes(b"labels")
    words = ("--labels", places["labels"], "-o", tmp_path / "out.gem", option, places[which])
    before = places[which].read_bytes()
    code, error = refused(capsys, "train-regressor", str(places["avatar"]), str(capture), *map(str, words))
    assert code == ExitCode.USAGE
    assert "which is read" in error
    assert places[which].read_bytes() == before


def test_a_regressor_that_cannot_be_judged_is_kept(
    capture: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What was learned for hours is worth more than its figures."""
    from gemheads.models.train.regressors import capture_regressor, selfreenact

    def learned(gem: Gem, *_: object) -> object:
        return SimpleNamespace(gem=gem, neutral=None)

    def unseen(*_: object, **__: object) -> object:
        raise CaptureError(capture, "shows no face in its test pictures", "look at them")

    monkeypatch.setattr("gemheads.app.making.owntraining.training_moments", lambda *_: {})
    monkeypatch.setattr(capture_regressor, "capture_regressor", learned)
    monkeypatch.setattr(selfreenact, "self_reenactment", unseen)
    out = tmp_path / "out.gem"
    code, error = refused(capsys, "train-regressor", "mara", str(capture), "-o", str(out), "--pictures", "0")
    assert code == ExitCode.INPUT
    assert "is saved, but how well it follows cannot be judged" in error
    assert load_gem(out).name == "mara"
