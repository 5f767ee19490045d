"""Only the shipped networks are opened."""

import shutil
from pathlib import Path

import pytest
from gemheads.models.driver.convert import RECIPES, differing
from gemheads.models.driver.face import FaceTracker
from gemheads.models.driver.networks import FOLDER, LANDMARKS_FILE, SHA256, NetworkError, open_session


def test_the_shipped_networks_are_the_converted_ones() -> None:
    assert differing({name: (FOLDER / name).read_bytes() for name in SHA256}) == []
    assert {f"{recipe.stem}.onnx" for recipe in RECIPES} <= set(SHA256)


def test_a_missing_network_is_named_with_the_cure(tmp_path: Path) -> None:
    with pytest.raises(NetworkError, match=r"face_detector\.onnx.*Reinstall"):
        FaceTracker(tmp_path)


def test_a_changed_network_is_refused(tmp_path: Path) -> None:
    for name in SHA256:
        shutil.copy(FOLDER / name, tmp_path / name)
    content = bytearray((tmp_path / LANDMARKS_FILE).read_bytes())
    content[-1] ^= 1
    (tmp_path / LANDMARKS_FILE).write_bytes(content)
    with pytest.raises(NetworkError, match="hash differs"):
        FaceTracker(tmp_path)


def test_what_onnxruntime_refuses_is_one_error() -> None:
    with pytest.raises(NetworkError, match="cannot open a test"):
        open_session(b"not a model", "a test")
