"""Only the shipped networks are opened."""

import shutil
from pathlib import Path

import numpy as np
import onnx
import pytest
from gemheads.models.driver.build.convert import RECIPES, differing
from gemheads.models.driver.face import FaceTracker
from gemheads.models.driver.networks import FOLDER, LANDMARKS_FILE, SCORES_FILE, SHA256, NetworkError, open_session

PLAIN = Path(__file__).resolve().parents[4] / "shared" / "data" / "networks"


def test_the_shipped_networks_are_the_converted_ones() -> None:
    assert differing({name: (FOLDER / name).read_bytes() for name in SHA256}) == []
    assert {f"{recipe.stem}.onnx" for recipe in RECIPES} <= set(SHA256)


@pytest.mark.parametrize("name", [LANDMARKS_FILE, SCORES_FILE])
def test_a_network_in_fewer_passes_is_the_network(name: str) -> None:
    """Beside a conversion that leaves every operation as it was."""
    if not (PLAIN / name).is_file():
        pytest.skip(f"{PLAIN / name} is not here: it is no part of a clone")
    plain, shipped = (open_session((folder / name).read_bytes(), name) for folder in (PLAIN, FOLDER))
    rng, shape = np.random.default_rng(0), plain.get_inputs()[0].shape
    for _ in range(3):
        values = {"input": rng.random(shape, np.float32) * (256 if name == SCORES_FILE else 1)}
        for output in (one.name for one in shipped.get_outputs()):
            wanted, got = (session.run([output], values)[0] for session in (plain, shipped))
            np.testing.assert_allclose(got, wanted, rtol=1e-3, atol=1e-3)


def test_scores_are_made_of_products_and_norms() -> None:
    """Of convolutions with transpositions between them they took a third more time."""
    operators = {node.op_type for node in onnx.load(FOLDER / SCORES_FILE).graph.node}
    assert {"MatMul", "LayerNormalization"} <= operators
    assert not operators & {"Conv", "Reciprocal"}


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
