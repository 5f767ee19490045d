"""Blender's pictures show what the studio's do, from the same place; where Blender is missing, the cure is said."""

import importlib.util
import json
import os
import signal
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.making.capturing import ORDER
from gemheads.models.heads.expressions import weights_of
from gemheads.models.studio.blender import BlenderError, blender, interruptible, quiet
from gemheads.models.studio.cycles import CyclesPainter
from gemheads.models.studio.drawing import Painter
from gemheads.models.studio.lamps import LAMPS, ROOM
from gemheads.models.studio.moment import Act, Stage
from gemheads.models.studio.rig import rig
from gemheads.models.studio.subject import load_subject
from gemheads.models.studio.surfaces import sky_images
from refusals import refused

needs_blender = pytest.mark.skipif(
    importlib.util.find_spec("bpy") is None, reason="bpy is not installed (pip install bpy==5.0.1 on Python 3.11)"
)
SMALL = ("--cameras", "2", "--size", "16x16", "--split", "1+0")


def test_without_blender_the_cure_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "bpy" else find(name))
    code, error = refused(capsys, "capture", tmp_path / "new", "--renderer", "cycles", *SMALL)
    assert code == ExitCode.INPUT
    assert "pip install bpy==5.0.1" in error
    assert not (tmp_path / "new").exists()


def test_a_broken_blender_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "bpy.py").write_text("raise ImportError('no libGL')")
    monkeypatch.delitem(sys.modules, "bpy", raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(BlenderError, match="no libGL"):
        blender()


def test_a_folder_has_one_renderer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["capture", str(tmp_path), *SMALL]) == 0
    order = json.loads((tmp_path / ORDER).read_text())
    assert order["renderer"] == "studio"
    (tmp_path / ORDER).write_text(json.dumps({key: said for key, said in order.items() if key != "renderer"}))
    assert main(["capture", str(tmp_path), *SMALL]) == 0, "captures from before there was a choice"
    (tmp_path / ORDER).write_text(json.dumps({**order, "renderer": "cycles"}))
    assert main(["capture", str(tmp_path), *SMALL]) == ExitCode.USAGE
    assert "another renderer" in capsys.readouterr().err


def test_quiet_gives_the_streams_back(capfd: pytest.CaptureFixture[str]) -> None:
    with quiet():
        os.write(1, b"inside")
        os.write(2, b"inside")
    os.write(1, b"after")
    assert capfd.readouterr() == ("after", "")


def test_an_interrupt_comes_at_the_end() -> None:
    before, reached = signal.getsignal(signal.SIGINT), []

    def interrupted() -> None:
        with interruptible():
            signal.raise_signal(signal.SIGINT)
            reached.append(True)

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert reached, "not inside, where Blender would swallow it"
    assert signal.getsignal(signal.SIGINT) is before


def test_the_sky_brings_the_light_of_the_lamps() -> None:
    """The integral of a lobe is 2 pi (1 - exp(-2k)) / k times its radiance."""
    lamps, _ = sky_images()
    height, width = lamps.shape[:2]
    solid = np.cos(np.pi * (0.5 - (np.arange(height) + 0.5) / height)) * (np.pi / height) * (2 * np.pi / width)
    total = (lamps * solid[:, None, None]).sum((0, 1))
    expected = 4 * np.pi * np.array(ROOM)
    for _, color, wide, _ in LAMPS:
        expected = expected + 2 * np.pi * (1 - np.exp(-2 * wide)) / wide * np.array(color)
    assert total == pytest.approx(expected, rel=1e-3)


@needs_blender
def test_blender_draws_what_the_studio_does() -> None:
    """One after another: a view from the side, and one whose middle is elsewhere and whose pixels are not square."""
    subject = load_subject("ada")
    stage = Stage(subject)
    still = np.zeros(3, np.float32)
    moment = stage.moment(Act(weights_of(jawOpen=0.6), np.array([0.0, 0.3, 0.0], np.float32), still))
    camera = rig(3, 64, 64, subject.viewing)[2]
    odd = replace(rig(3, 64, 48, subject.viewing)[1], cx=25.0, cy=30.0)
    odd = replace(odd, fx=odd.fx * 1.2)
    studio, cycles = Painter(stage), CyclesPainter(stage, samples=8)
    for view in (camera, odd):
        image, other = studio.draw(moment, view), cycles.draw(moment, view)
        assert other.shape == image.shape
        assert other.dtype == np.float32
        inside, there = image[..., 3] > 0.5, other[..., 3] > 0.5
        assert (inside & there).sum() / (inside | there).sum() > 0.96
        assert (other[..., :3] <= other[..., 3:] + 1e-6).all(), "premultiplied"
        # another way of drawing, the same person under the same lamps
        assert np.abs(image[inside & there] - other[inside & there]).mean() < 0.06
    again = stage.moment(Act(weights_of(), np.array([0.0, -0.3, 0.0], np.float32), still))
    assert np.abs(cycles.draw(again, camera)[..., :3] - cycles.draw(moment, camera)[..., :3]).mean() > 0.02


@needs_blender
def test_a_capture_by_blender(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["capture", str(tmp_path), "--renderer", "cycles", *SMALL]) == 0
    said = capfd.readouterr()
    assert said.out == f"{tmp_path}: 2 pictures of 1 + 0 moments from 2 cameras\n", "Blender's chatter is kept away"
    assert "bpy" not in said.err
    assert "Deprecation" not in said.err
    assert len(list((tmp_path / "images").iterdir())) == 2
