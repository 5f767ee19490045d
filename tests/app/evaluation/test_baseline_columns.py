"""Baselines by the commands: trained by `train --model`, judged by `evaluate` as columns that state their budget."""

import json
from pathlib import Path

import pytest

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode


def train(capture: Path, out: Path, model: str, steps: int) -> int:
    return main(["train", str(capture), "-o", str(out), "--model", model, "--steps", str(steps), "--no-perceptual"])


def test_each_is_a_column_with_its_budget(
    toy_capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for model, steps in (("rigged", 3), ("blendshapes", 2)):
        assert train(toy_capture, tmp_path / model, model, steps) == ExitCode.OK
        assert json.loads((tmp_path / model / "config.json").read_text())["plan"]["model"] == model
    capsys.readouterr()
    words = [str(tmp_path / "rigged"), str(toy_capture), "--against", str(tmp_path / "blendshapes")]
    out = tmp_path / "report"
    assert main(["evaluate", *words, "-o", str(out), "--lpips", "none", "--shots", "2"]) == ExitCode.OK
    assert "Novel expression, blendshapes: PSNR" in capsys.readouterr().out
    report = json.loads((out / "report.json").read_text())
    rigged, blendshapes = report["avatars"]
    assert (rigged["kind"], rigged["driven_by"], rigged["steps"]) == ("mesh-rigged", "the tracked mesh", 3)
    assert blendshapes["kind"] == "blendshapes"
    assert blendshapes["driven_by"] == "the capture's ARKit weights"
    assert rigged["seconds"] > 0
    assert "a run of 2 of 2 steps, 2 pictures each" in blendshapes["source"]
    page = (out / "report.html").read_text()
    assert "<th>steps</th><th>s in all</th>" in page
    assert "the capture&#x27;s ARKit weights" in page
    assert report["tables"]["test"]["pictures"][0]["fitted_in_cameras"] == {"rigged": [], "blendshapes": []}


def test_a_model_nobody_knows(toy_capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert train(toy_capture, tmp_path / "run", "nerf", 1) == ExitCode.USAGE
    assert "rigged" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()
