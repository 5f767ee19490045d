import os
from datetime import date
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from gemheads.app.errors import InputError, OutputError
from gemheads.app.files.sources import Source
from gemheads.app.person import profiles
from gemheads.app.person.neutrals import find_neutral, read_rule
from gemheads.app.person.profiles import kept_cameras, load_profile, profile_path, save_profile
from gemheads.app.person.restface import Resting
from gemheads.models.driver.face import FaceTracker
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.neutral import NeutralChoice
from safetensors.numpy import save_file

CAMERA, TODAY = "Integrated Camera: 720p (Müller)", date(2026, 3, 4)


def resting() -> Resting:
    rng = np.random.default_rng(0)
    features, noise = rng.normal(size=(2, DIMENSION)).astype(np.float32)
    choice = NeutralChoice(0, 0.0, features, np.array([0.1, 0.2, 0.3]), "45 pictures", ())
    return Resting(choice, np.abs(noise), 0.1, "")


def test_a_neutral_comes_back_for_its_camera_only(tmp_path: Path) -> None:
    taken = resting()
    save_profile(CAMERA, taken, TODAY, tmp_path)
    profile = load_profile(CAMERA, tmp_path)
    assert profile is not None
    assert profile.choice is not None
    assert (profile.choice.features == taken.choice.features).all()
    assert (profile.choice.rotation == taken.choice.rotation).all()
    assert (profile.noise == taken.noise).all()
    assert (profile.choice.reason, profile.warning) == ("taken on 2026-03-04", "")
    assert load_profile(CAMERA + "2", tmp_path) is None


def test_only_features_are_kept(tmp_path: Path) -> None:
    """A few kilobytes: no picture has room in it."""
    assert save_profile(CAMERA, resting(), TODAY, tmp_path).stat().st_size < 8 * DIMENSION + 1000
    assert len(os.listdir(tmp_path)) == 1


def test_names_are_fit_for_every_file_system(tmp_path: Path) -> None:
    name = profile_path("../../etc/passwd", tmp_path).name
    assert profile_path("../../etc/passwd", tmp_path).parent == tmp_path
    assert name.startswith("etc-passwd-")
    assert profile_path("カメラ", tmp_path) != profile_path("相机", tmp_path)


def test_other_networks_are_warned_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_profile(CAMERA, resting(), TODAY, tmp_path)
    monkeypatch.setattr(profiles, "NETWORKS", "0" * 16)
    profile = load_profile(CAMERA, tmp_path)
    assert profile is not None
    assert profile.choice is not None
    assert profile.warning == "The face networks changed since your neutral of 2026-03-04: press N to take it again."


def test_features_of_another_version_are_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_profile(CAMERA, resting(), TODAY, tmp_path)
    monkeypatch.setattr(profiles, "FEATURE_VERSION", profiles.FEATURE_VERSION + 1)
    profile = load_profile(CAMERA, tmp_path)
    assert profile is not None
    assert profile.choice is None
    assert "another version: press N" in profile.warning


@pytest.mark.parametrize("damage", ["cut", "foreign", "huge", "nan", "shape"])
def test_what_is_no_neutral_is_refused_with_its_cure(tmp_path: Path, damage: str) -> None:
    path = save_profile(CAMERA, resting(), TODAY, tmp_path)
    about = {"format": profiles.FORMAT, "feature_version": str(profiles.FEATURE_VERSION)}
    good = {
        "features": np.zeros(DIMENSION, np.float32),
        "rotation": np.zeros(3),
        "noise": np.zeros(DIMENSION, np.float32),
    }
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:500])
    elif damage == "huge":
        path.write_bytes(bytes(profiles.LARGEST + 1))
    elif damage == "foreign":
        save_file(good, path, {"format": "something else"})
    elif damage == "nan":
        save_file(good | {"features": np.full(DIMENSION, np.nan, np.float32)}, path, about)
    else:
        save_file(good | {"noise": np.zeros(5, np.float32)}, path, about)
    with pytest.raises(InputError, match="delete the file and press N"):
        load_profile(CAMERA, tmp_path)


def test_a_neutral_that_cannot_be_kept_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="it counts until you quit"):
        save_profile(CAMERA, resting(), TODAY, tmp_path / "file")


def test_the_kept_cameras_are_those_whose_file_can_be_read(tmp_path: Path) -> None:
    assert kept_cameras(tmp_path / "none") == []
    for camera in ("Zoom", CAMERA):
        save_profile(camera, resting(), TODAY, tmp_path)
    (tmp_path / "broken.safetensors").write_bytes(b"{")
    assert kept_cameras(tmp_path) == [CAMERA, "Zoom"]


def test_a_video_takes_the_neutral_of_a_camera(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(profiles, "user_folder", lambda: tmp_path / "avatars")
    taken = resting()
    source, tracker = cast(Source, None), FaceTracker()
    with pytest.raises(InputError, match="press N in `gemheads live`"):
        find_neutral(read_rule(f"profile={CAMERA}"), source, tracker)
    save_profile(CAMERA, taken, TODAY)
    choice = find_neutral(read_rule(f"profile={CAMERA}"), source, tracker)
    assert (choice.features == taken.choice.features).all()
    assert choice.reason == f"{CAMERA}, taken on 2026-03-04"
    with pytest.raises(InputError, match=r"there are: Integrated Camera"):
        find_neutral(read_rule("profile=Other"), source, tracker)
    monkeypatch.setattr(profiles, "FEATURE_VERSION", -1)
    with pytest.raises(InputError, match="another version"):
        find_neutral(read_rule(f"profile={CAMERA}"), source, tracker)
