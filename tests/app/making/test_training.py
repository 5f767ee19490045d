"""``gemheads train-regressor`` without a capture: what it refuses, before anything is learned."""

from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.models.gem import Gem
from gemheads.models.gemfile import save_gem
from gemheads.models.train.regressors import train_regressor
from gems import ball, statue
from refusals import refused


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--pictures", "0"), "--pictures 0: choose 40 or more"),
        (("--steps", "0"), "--steps 0: choose 1 or more"),
        (("--seed", "-1"), "--seed: -1: choose from 0"),
        (("--jobs", "0"), "--jobs 0: choose from 1 to 256"),
        (("--turns-only", "--rehearse-with", "theo"), "--rehearse-with has no effect with --turns-only"),
        ((), "mara.gem: ships with gemheads and stays as it is; give -o, such as -o my-mara.gem"),
        (("--take-over", "theo"), "ships with gemheads"),
        (("--turns-only", "--take-over", "theo"), "--take-over trains nothing"),
        (("--pictures", "40", "--take-over", "theo"), "--take-over trains nothing"),
        (("--seed", "0", "--take-over", "theo"), "--take-over trains nothing"),
    ],
)
def test_what_cannot_be(words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, error = refused(capsys, "train-regressor", "mara", *words)
    assert code == ExitCode.USAGE
    assert said in error


def test_a_folder_is_no_video(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for place, said in ((tmp_path, "is a folder, and no capture"), (tmp_path / "no.mp4", "no such video")):
        code, error = refused(capsys, "train-regressor", "mara", place)
        assert code == ExitCode.INPUT
        assert f"{place}: {said}" in error


@pytest.mark.parametrize("words", [(), ("--turns-only",), ("--take-over", "theo"), ("--companions", "{statue}")])
def test_an_avatar_that_does_not_move_learns_nothing(
    words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    still = tmp_path / "statue.gem"
    save_gem(statue(), still)
    who = "mara" if "{statue}" in words else still
    code, error = refused(capsys, "train-regressor", who, *(word.format(statue=still) for word in words))
    assert code == ExitCode.INPUT
    assert error == f"error: {still}: does not move, so no face can drive it; distill it from several frames\n"


def test_a_regressor_that_cannot_be_opened_is_not_saved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "ball.gem"
    save_gem(ball(), path)
    before = path.read_bytes()

    def broken(*_: object, **__: object) -> tuple[Gem, object]:
        return replace(ball(), regressor=b"no graph"), train_regressor.TrainingReport(1, 1, 1, 1)

    monkeypatch.setattr(train_regressor, "train_regressor", broken)
    assert main(["train-regressor", str(path), "--jobs", "1"]) == ExitCode.INPUT
    assert "the avatar's regressor cannot be used" in capsys.readouterr().err
    assert path.read_bytes() == before
