"""`distill`, `refine` and `fit` on a capture: files in, files out, and what is said."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.files.sources import read_image
from gemheads.app.library import find_avatar
from gemheads.app.performing.tracks import load_track
from gemheads.models.captures.reader import open_capture
from gemheads.models.gemfile import load_gem
from refusals import refused

pytest.importorskip("torch", reason="refining needs the extra gemheads[train]")

QUICK = ("--no-perceptual", "--iterations", "60")


@pytest.fixture(scope="module")
def bare(toy_capture: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The avatar of the capture's bare mesh, and its moments."""
    folder = tmp_path_factory.mktemp("bare")
    out, moments = folder / "toy.gem", folder / "toy.track"
    words = ("--maps", "24", "--components", "4", "--moments", str(moments))
    assert main(["distill", str(toy_capture), "-o", str(out), *words]) == ExitCode.OK
    return out, moments


def test_a_capture_is_distilled_with_its_moments(toy_capture: Path, bare: tuple[Path, Path]) -> None:
    gem, track, capture = load_gem(bare[0]), load_track(bare[1]), open_capture(toy_capture)
    assert gem.about["source"] == "bare mesh of the capture toy, 6 frames"
    assert gem.arkit_weights is not None
    assert track.pts.tolist() == list(capture.timesteps("train"))
    for pose, timestep in zip(track.poses, track.pts.tolist(), strict=True):
        tracked = capture.tracked(timestep)
        np.testing.assert_allclose(pose.turn, tracked.rotation, atol=1e-6)
        np.testing.assert_allclose(pose.translation, tracked.translation, atol=1e-6)


def test_refine_improves_and_its_moments_play(
    toy_capture: Path, bare: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, moments, sheet = tmp_path / "fine.gem", tmp_path / "fine.track", tmp_path / "sheet.png"
    words = (
        "refine",
        str(bare[0]),
        str(toy_capture),
        "-o",
        str(out),
        "--moments",
        str(moments),
        "--sheet",
        str(sheet),
    )
    assert main([*words, *QUICK]) == ExitCode.OK
    said = capsys.readouterr()
    assert "dB on the held-out camera, 60 steps" in said.out
    assert "stays as it was" not in said.out
    assert "is the bare mesh" in said.err
    assert "refined on toy, 60 steps" in load_gem(out).about["source"]
    assert read_image(sheet).shape == (4 * 64, 4 * 64, 3)
    again = tmp_path / "again.gem"
    assert main(["refine", str(out), str(toy_capture), "-o", str(again), "--no-perceptual", "--iterations", "10"]) == 0
    assert "its 6 moments are fitted" in capsys.readouterr().err
    start = ("refine", str(out), str(toy_capture), "-o", str(again), "--start", str(moments))
    assert main([*start, "--no-perceptual", "--iterations", "10", "--coefficients", "fixed"]) == ExitCode.OK
    frames = tmp_path / "frames"
    play = ("reenact", "--track", str(moments), "--avatar", str(out), "-o", str(frames), "--size", "64x64")
    assert main(list(play)) == ExitCode.OK
    assert len(list(frames.glob("*.png"))) == 6


def test_where_nothing_improves_the_old_one_stays(
    toy_capture: Path,
    bare: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from gemheads.models.gem import MODALITIES
    from gemheads.models.train.synthesis import refine

    monkeypatch.setattr(refine, "RATES", dict.fromkeys(MODALITIES, 5.0))
    monkeypatch.setattr(refine, "SLOWER", 1.0)
    avatar = tmp_path / "toy.gem"
    avatar.write_bytes(bare[0].read_bytes())
    assert main(["refine", str(avatar), str(toy_capture), "--no-perceptual", "--iterations", "10"]) == ExitCode.OK
    assert "stays as it was" in capsys.readouterr().out
    assert avatar.read_bytes() == bare[0].read_bytes()
    out = tmp_path / "other.gem"
    words = ("refine", str(avatar), str(toy_capture), "-o", str(out), "--no-perceptual", "--iterations", "10")
    assert main(list(words)) == ExitCode.OK
    assert load_gem(out).name == "toy"


def test_a_capture_is_fitted_into_a_track(
    toy_capture: Path, bare: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    track, errors = tmp_path / "test.track", tmp_path / "errors.png"
    words = ("fit", str(bare[0]), str(toy_capture), "-o", str(track), "--cameras", "1,2,4", "--errors", str(errors))
    assert main(list(words)) == ExitCode.OK
    assert "2 moments from 3 cameras" in capsys.readouterr().out
    capture = open_capture(toy_capture)
    played = load_track(track)
    assert played.pts.tolist() == [6, 7]
    for pose, timestep in zip(played.poses, (6, 7), strict=True):
        tracked = capture.tracked(timestep)
        assert np.degrees(np.abs(pose.turn - tracked.rotation).max()) < 6
        assert np.abs(pose.translation - tracked.translation).max() < 0.01
    assert read_image(errors).shape == (3 * 64, 3 * 64, 3)


@pytest.mark.parametrize("command", ["fit", "refine"])
def test_cameras_that_look_elsewhere_are_told(
    toy_capture: Path, bare: tuple[Path, Path], tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of a capture whose cameras look along +z, as OpenCV's do."""
    words = {"fit": ("--cameras", "1,2"), "refine": ("--no-perceptual", "--iterations", "10")}[command]
    other = shutil.copytree(toy_capture, tmp_path / "other")
    for path in other.glob("transforms_*.json"):
        tree = json.loads(path.read_text())
        for frame in tree["frames"]:
            frame["transform_matrix"] = (frame["transform_matrix"] @ np.diag([1, -1, -1, 1])).tolist()
        path.write_text(json.dumps(tree))
    for folder, told in ((toy_capture, 0), (other, 1)):
        assert main([command, str(bare[0]), str(folder), "-o", str(tmp_path / "x.gem"), *words]) == ExitCode.OK
        assert capsys.readouterr().err.count(f"does not look like the pictures of {folder}") == told


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("refine", "{avatar}", "{toy}", "--iterations", "1"), ExitCode.USAGE, "--iterations 1: choose from 10"),
        (("refine", "{avatar}", "{toy}", "--seed", "-1"), ExitCode.USAGE, "--seed: -1: choose from 0"),
        (("refine", "{avatar}", "{toy}", "-o", "x.ply"), ExitCode.USAGE, "is called .gem"),
        (("refine", "mara", "{toy}"), ExitCode.USAGE, "mara.gem: ships with gemheads and stays as it is; give -o"),
        (("refine", "{taught}", "{toy}"), ExitCode.USAGE, "has a regressor, which knows the old bases and would be"),
        (("refine", "{avatar}", "nowhere"), ExitCode.INPUT, "nowhere: is no folder"),
        (("refine", "{tiny}", "{toy}", "--start", "{moments}"), ExitCode.INPUT, "made for another avatar ('toy')"),
        (("fit", "{avatar}", "{toy}", "-o", "x", "--split", "all"), ExitCode.USAGE, "choose from train, val, test"),
        (("fit", "{avatar}", "{toy}", "-o", "x", "--cameras", "9"), ExitCode.USAGE, "choose from 0,1,2,3,4"),
        (("fit", "{avatar}", "{toy}", "-o", "x", "--cameras", "a"), ExitCode.USAGE, "choose from 0,1,2,3,4"),
        (("distill", "{toy}", "-o", "x.gem", "--maps", "4"), ExitCode.USAGE, "--maps 4: choose from 16"),
        (("distill", "{tiny}", "-o", "x.gem", "--moments", "x"), ExitCode.USAGE, "is no capture"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    toy_capture: Path,
    bare: tuple[Path, Path],
    tiny: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    code: ExitCode,
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    taught = tmp_path / "taught.gem"
    taught.write_bytes(find_avatar("mara").read_bytes())
    places = {"avatar": bare[0], "toy": toy_capture, "tiny": tiny, "moments": bare[1], "taught": taught}
    # else notes say what is missing, before anything else
    stated = ("--licence", "CC0-1.0", "--consent", "no person")
    more = {"refine": ("--no-perceptual",), "distill": stated}.get(words[0], ())
    found, error = refused(capsys, *(word.format(**places) for word in words), *more)
    assert found == code
    assert said in error
    assert not (tmp_path / "x").exists()
