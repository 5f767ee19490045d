"""`gemheads fit`: pictures of an avatar become a track that draws them again."""

import json
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode, InputError
from gemheads.app.files.sources import files_of, files_sha256, read_image
from gemheads.app.making.cameras import load_camera
from gemheads.app.performing.portrait import portrait
from gemheads.app.performing.tracks import load_track
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.posing import pose_head
from gemheads.render.camera import Camera
from gemheads.render.compositing import over
from gemheads.render.software import SoftwareEngine
from refusals import refused

pytest.importorskip("torch", reason="fitting needs the extra gemheads[train]")

from gemheads.render.diff import cpu

AVATAR = Path(__file__).parents[3] / "assets" / "avatars" / "mara.gem"
GREY = (0.75, 0.75, 0.75)
STILL = np.zeros(3, np.float32)
SIDE = 96


def picture(gem: Gem, camera: Camera, sigmas: float, turn: tuple[float, ...], move: tuple[float, ...] = (0, 0, 0)):
    coefficients = gem.clamped(gem.rest_coefficients + sigmas * gem.sigma)
    raw = pose_head(gem.compose(coefficients), gem.neck_weights, gem.neck_pivot, np.array(turn), np.array(move))
    return over(SoftwareEngine().draw(raw, camera), GREY).copy()


def saved(image: np.ndarray, path: Path) -> Path:
    path.parent.mkdir(exist_ok=True)
    assert cv2.imwrite(str(path), image[..., ::-1])
    return path


def decibels(first: np.ndarray, second: np.ndarray) -> float:
    return float(-10 * np.log10(np.mean((first / 255.0 - second / 255.0) ** 2) + 1e-12))


def said(file: Path, camera: Camera, **other: object) -> Path:
    keys = ("fx", "fy", "cx", "cy", "width", "height")
    about = {key: getattr(camera, key) for key in keys} | {"world_to_camera": camera.world_to_camera.tolist()} | other
    file.write_text(json.dumps({key: value for key, value in about.items() if value is not None}))
    return file


def test_pictures_become_a_track_that_plays(tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    gem = load_gem(tiny)
    camera = portrait(gem.viewing, SIDE, SIDE)
    away = (0.03, -0.02, 0.0)
    shown = [picture(gem, camera, 0.5, (0.05, -0.1, 0.02), away), picture(gem, camera, 0.6, (0.06, -0.08, 0.02), away)]
    for index, image in enumerate(shown):
        saved(image, tmp_path / "shots" / f"{index}.png")
    track, errors, again = tmp_path / "a.track", tmp_path / "errors.png", tmp_path / "again"
    words = ("fit", str(tiny), str(tmp_path / "shots"), "-o", str(track), "--errors", str(errors), "--rate", "25")
    assert main(list(words)) == ExitCode.OK
    assert f"{track}: 2 frames" in capsys.readouterr().out
    kept = load_track(track)
    assert kept.rate == 25
    assert kept.driver_sha256 == files_sha256(files_of(str(tmp_path / "shots")))
    assert np.degrees(np.abs(kept.poses[1].turn - [0.06, -0.08, 0.02]).max()) < 0.5
    assert read_image(errors).shape == (SIDE, 3 * SIDE, 3)
    words = ("reenact", "--track", str(track), "--avatar", str(tiny), "-o", str(again), "--size", f"{SIDE}x{SIDE}")
    words = (*words, "--no-badge", "compared with what was fitted")
    assert main(list(words)) == ExitCode.OK
    for index, image in enumerate(shown):
        assert decibels(read_image(again / f"frame_{index:06}.png"), image) >= 38


def test_a_camera_from_a_file_and_a_head_out_of_its_place(tiny: Path, tmp_path: Path) -> None:
    gem = load_gem(tiny)
    camera = portrait(gem.viewing, SIDE, SIDE - 16, yaw_deg=30)
    shot = saved(picture(gem, camera, 0.4, (0.0, 0.1, 0.0), (0.02, 0.0, 0.0)), tmp_path / "shot.png")
    view, track = said(tmp_path / "view.json", camera), tmp_path / "a.track"
    assert main(["fit", str(tiny), str(shot), "-o", str(track), "--camera", str(view)]) == ExitCode.OK
    pose = load_track(track).poses[0]
    assert np.degrees(np.abs(pose.turn - [0, 0.1, 0]).max()) < 0.5
    across = camera.world_to_camera[:2, :3] @ (pose.translation - [0.02, 0.0, 0.0])
    assert np.abs(across).max() < 0.001


def test_what_cannot_be_fitted_is_told(tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    camera = portrait(load_gem(tiny).viewing, SIDE, SIDE)
    shot = str(saved(np.zeros((64, 48, 3), np.uint8), tmp_path / "shot.png"))
    small = str(saved(np.zeros((8, 8, 3), np.uint8), tmp_path / "small.png"))
    view, out = str(said(tmp_path / "view.json", camera)), ("-o", str(tmp_path / "a.track"))
    for words, code, what in (
        ((str(tiny), shot, "--camera", view), ExitCode.INPUT, f"is a camera of {SIDE}x{SIDE}"),
        ((str(tiny), shot, "--camera", "none.json"), ExitCode.INPUT, "none.json: cannot be read"),
        ((str(tiny), shot, "--background", "transparent"), ExitCode.USAGE, "give its colour"),
        ((str(tiny), small), ExitCode.INPUT, "sides from 16"),
        ((str(tiny), "none.png"), ExitCode.INPUT, "none.png: no such file"),
        ((str(tiny), shot, "--camera", view, "--errors", view), ExitCode.USAGE, "view.json, which is read"),
    ):
        found, error = refused(capsys, "fit", *words, *out)
        assert found == code
        assert what in error
    assert not (tmp_path / "a.track").exists()


def test_an_avatar_of_splats_that_would_fill_the_memory_is_refused(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cpu, "MOST_PAIRS", 100)
    shot = str(saved(np.zeros((64, 48, 3), np.uint8), tmp_path / "shot.png"))
    code, error = refused(capsys, "fit", tiny, shot, "-o", tmp_path / "a.track")
    assert code == ExitCode.INPUT
    assert error.startswith(f"error: {tiny}: cannot be fitted: its ")
    assert "far too large" in error
    assert not (tmp_path / "a.track").exists()


def test_a_missing_torch_is_one_plain_line(
    tiny: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    imported = {name: module for name, module in sys.modules.items() if name.startswith("gemheads.models.train.")}
    for name, module in imported.items():
        package, _, last = name.rpartition(".")
        monkeypatch.setattr(sys.modules[package], last, module)  # importing it anew sets this, too: it shall come back
    for name in imported:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "torch", None)
    shot = saved(np.zeros((64, 48, 3), np.uint8), tmp_path / "shot.png")
    code, error = refused(capsys, "fit", tiny, shot, "-o", tmp_path / "a.track")
    assert code == ExitCode.INPUT
    assert error == "error: fitting needs torch; install it: pip install 'gemheads[train]'\n"


@pytest.mark.parametrize(
    ("spoiled", "what"),
    [
        ({"fx": None, "width": None}, "lacks fx, width"),
        ({"world_to_camera": [[1, 2], [3, 4]]}, "rigid"),
        ({"world_to_camera": np.diag([2.0, 2, 2, 1]).tolist()}, "rigid"),
        ({"world_to_camera": np.diag([1.0, 1, -1, 1]).tolist()}, "mirrors"),
        ({"fx": -5}, "focal"),
        ({"cx": "left"}, "left"),
        ({"height": float("inf")}, "not a camera"),
    ],
)
def test_a_broken_camera_is_refused(spoiled: dict[str, object], what: str, tmp_path: Path) -> None:
    camera = Camera(100, 100, 32, 32, 64, 64, np.eye(4))
    with pytest.raises(InputError, match=what):
        load_camera(said(tmp_path / "view.json", camera, **spoiled))
    assert load_camera(said(tmp_path / "whole.json", camera)).width == 64


@pytest.mark.parametrize("text", ["", "[]", "nonsense", '"x"', "[" * 5000])
def test_what_is_no_camera_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "view.json").write_text(text)
    with pytest.raises(InputError, match="not a camera"):
        load_camera(tmp_path / "view.json")


def test_the_tracker_guesses_where_to_begin() -> None:
    if not AVATAR.exists():
        pytest.skip(f"no avatar at {AVATAR}; make it with `make avatars`")
    from gemheads.app.making.firstguess import Guesser

    gem = load_gem(AVATAR).truncated(5)
    camera = portrait(gem.viewing, 256, 256, yaw_deg=15)
    guesser = Guesser(gem, camera, GREY, None)
    turn, move = (0.1, -0.25, 0.05), (0.01, 0.005, 0.0)
    shown = picture(gem, camera, 0.0, turn, move)
    guess = guesser.guess(shown)
    assert guess is not None
    assert np.degrees(np.abs(guess.turn - turn).max()) < 4
    sideways = camera.world_to_camera[:2, :3] @ (guess.move - move)
    assert np.abs(sideways).max() < 0.01
    np.testing.assert_array_equal(guess.coefficients, gem.rest_coefficients)
    assert guesser.guess(np.full_like(shown, 90)) is None
