"""``gemheads train-regressor`` without a capture: what it refuses, before anything is learned."""

import pytest

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.app.errors import ExitCode
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
    ],
)
def test_what_cannot_be(words: tuple[str, ...], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    code, error = refused(capsys, "train-regressor", "mara", *words)
    assert code == ExitCode.USAGE
    assert said in error
