"""Memory runs out: it is told, and what can go on goes on."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import onnxruntime
import pytest
from gemheads.app import export
from gemheads.app.errors import ExitCode
from gemheads.render.camera import Camera, look_at
from gemheads.render.engines import FastestEngine
from gemheads.render.gaussians import RawGaussians
from gemheads.render.software import SoftwareEngine
from onnx import TensorProto, helper
from refusals import refused


def out_of_memory(*_: object, **__: object) -> None:
    raise MemoryError


def test_a_command_says_that_the_memory_is_full(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(export, "export_expression", out_of_memory)
    code, error = refused(capsys, "export", "mara", "-o", tmp_path / "a.ply")
    assert code == ExitCode.UNEXPECTED
    assert error.startswith("error: the memory is full; close other programs")


def numpy_fails() -> None:
    np.empty(2**60, np.uint8)


def opencv_fails() -> None:
    cv2.copyMakeBorder(np.zeros((1, 1), np.uint8), 0, 2**31 - 2, 0, 2**31 - 2, cv2.BORDER_CONSTANT)


def torch_fails() -> None:
    pytest.importorskip("torch", reason="the extra gemheads[train] is not installed").empty(2**58)


def onnxruntime_fails() -> None:
    nodes = [helper.make_node("ConstantOfShape", ["size"], ["y"])]
    size = helper.make_tensor_value_info("size", TensorProto.INT64, [1])
    graph = helper.make_graph(nodes, "g", [size], [helper.make_tensor_value_info("y", TensorProto.FLOAT, None)])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4
    session = onnxruntime.InferenceSession(model.SerializeToString(), options, providers=["CPUExecutionProvider"])
    session.run(None, {"size": np.array([2**55])})


@pytest.mark.parametrize("stage", [numpy_fails, opencv_fails, torch_fails, onnxruntime_fails])
def test_whatever_library_finds_the_memory_full(
    stage: Callable[[], None], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Each has an error of its own for it."""
    monkeypatch.setattr(export, "export_expression", lambda *_: stage())
    code, error = refused(capsys, "export", "mara", "-o", tmp_path / "a.ply")
    assert code == ExitCode.UNEXPECTED
    assert error.startswith("error: the memory is full; close other programs")


def test_an_engine_without_memory_falls_to_the_other(monkeypatch: pytest.MonkeyPatch) -> None:
    quads = SoftwareEngine()
    monkeypatch.setattr(quads, "name", "quads", raising=False)
    monkeypatch.setattr(quads, "draw", out_of_memory)
    monkeypatch.setattr(FastestEngine, "_decided", "quads")
    engine = FastestEngine(quads, SoftwareEngine())
    camera = Camera(50, 50, 8, 8, 16, 16, look_at([0, 0, 1], [0, 0, 0]))
    ones = (np.zeros((4, 3)), np.tile([1.0, 0, 0, 0], (4, 1)), np.full((4, 3), -3), np.full(4, 3), np.ones((4, 3)))
    raw = RawGaussians(*(np.asarray(part, np.float32) for part in ones))
    assert engine.draw(raw, camera).any()
    assert engine.name == "software"
    engine.close()
