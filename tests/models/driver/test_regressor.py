"""What came with an avatar is looked through before it runs."""

from collections.abc import Sequence

import numpy as np
import onnx
import pytest
from gemheads.models.driver.axes import drawn_turn
from gemheads.models.driver.features import DIMENSION, FEATURE_VERSION
from gemheads.models.driver.nodding import Nodding
from gemheads.models.driver.regressor import (
    FEATURES_INPUT,
    MOST_OFF,
    OUTPUT,
    ROTATION_INPUT,
    TURN_OUTPUT,
    Regressor,
    RegressorError,
)
from onnx import TensorProto, helper, numpy_helper

COEFFICIENTS = 7


def graph(
    *,
    features: Sequence[int | str] = (1, DIMENSION),
    output: Sequence[int] = (1, COEFFICIENTS),
    extra: Sequence[onnx.NodeProto] = (),
    nodes: int = 0,
    version: int | None = None,
) -> onnx.ModelProto:
    """k = 3 tanh(r W + rotation V), as a regressor ends."""
    rng = np.random.default_rng(0)
    width = output[-1]
    weights = [
        numpy_helper.from_array(rng.normal(0, 0.1, (DIMENSION, width)).astype(np.float32), "W"),
        numpy_helper.from_array(np.ones((3, width), np.float32), "V"),
        numpy_helper.from_array(np.float32(3), "limit"),
    ]
    body = [
        helper.make_node("MatMul", [FEATURES_INPUT, "W"], ["a"]),
        helper.make_node("MatMul", [ROTATION_INPUT, "V"], ["b"]),
        helper.make_node("Add", ["a", "b"], ["c"]),
        *(helper.make_node("Identity", ["c"], [f"c{i}"]) for i in range(nodes)),
        helper.make_node("Tanh", ["c"], ["d"]),
        *extra,
        helper.make_node("Mul", ["d", "limit"], [OUTPUT]),
    ]
    inputs = [
        helper.make_tensor_value_info(FEATURES_INPUT, TensorProto.FLOAT, features),
        helper.make_tensor_value_info(ROTATION_INPUT, TensorProto.FLOAT, [1, 3]),
    ]
    outputs = [helper.make_tensor_value_info(OUTPUT, TensorProto.FLOAT, output)]
    content = helper.make_graph(body, "regressor", inputs, outputs, weights)
    model = helper.make_model(content, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    if version is not None:
        helper.set_model_props(model, {"feature_version": str(version)})
    return model


def refused(model: onnx.ModelProto, why: str, coefficients: int | None = None) -> None:
    with pytest.raises(RegressorError, match=why):
        Regressor(model.SerializeToString(), coefficients)


def test_it_answers_inside_three_sigma() -> None:
    regressor = Regressor(graph(version=FEATURE_VERSION).SerializeToString(), COEFFICIENTS)
    answer = regressor(np.zeros(DIMENSION), np.array([0.1, 0.2, 0.3])).coefficients
    np.testing.assert_allclose(answer, np.full(COEFFICIENTS, 3 * np.tanh(0.6)), rtol=1e-6)
    assert answer.dtype == np.float32
    assert np.abs(regressor(np.full(DIMENSION, 1e6), np.zeros(3)).coefficients).max() <= 3


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_not_finite_gives_the_last_good_answer(bad: float) -> None:
    regressor = Regressor(graph().SerializeToString())
    first = regressor(np.full(DIMENSION, bad), np.zeros(3))
    assert not first.coefficients.any()
    assert not first.turn.any()
    good = regressor(np.zeros(DIMENSION), np.ones(3))
    answer = regressor(np.zeros(DIMENSION), np.full(3, bad))
    np.testing.assert_array_equal(answer.coefficients, good.coefficients)
    np.testing.assert_array_equal(answer.turn, drawn_turn(np.ones(3)))
    answer.coefficients[:] = answer.turn[:] = 0  # the caller's copy is its own
    again = regressor(np.full(DIMENSION, bad), np.zeros(3))
    np.testing.assert_array_equal(again.coefficients, good.coefficients)
    np.testing.assert_array_equal(again.turn, drawn_turn(np.ones(3)))
    assert regressor.failures == 3


def test_other_shapes_are_refused() -> None:
    refused(graph(features=(1, DIMENSION + 1)), "train it again|cannot be used")
    refused(graph(features=("batch", DIMENSION)), "train it again")
    refused(graph(), "the avatar has 9 coefficients, its regressor gives 7", 9)


def test_other_features_are_refused() -> None:
    refused(graph(version=FEATURE_VERSION + 1), "trained on features of version")


def test_the_head_turns_as_was_read_without_what_the_expression_only_seems_to_nod() -> None:
    features, rotation = np.zeros(DIMENSION), np.array([0.1, 0.2, 0.3])
    plain = Regressor(graph().SerializeToString())(features, rotation)
    np.testing.assert_allclose(plain.turn, drawn_turn(rotation), rtol=1e-6)
    np.testing.assert_array_equal(plain.misread, np.zeros(3))
    nodding = Nodding(np.zeros(COEFFICIENTS), np.full(COEFFICIENTS, 0.01))
    upright = Regressor(graph().SerializeToString(), nodding=nodding)(features, rotation)
    left = np.array([0.1 - 0.01 * plain.coefficients.sum(), 0.2, 0.3])
    np.testing.assert_allclose(upright.turn, drawn_turn(left), rtol=1e-5)
    np.testing.assert_allclose(upright.turn + upright.misread, plain.turn, rtol=1e-6)


def turning(per_radian: float, width: int = 3) -> onnx.ModelProto:
    """A graph that says how the head turns: by the rotation that was read, times ``per_radian``."""
    times = numpy_helper.from_array((per_radian * np.eye(3, width)).astype(np.float32), "times")
    model = graph(extra=[helper.make_node("MatMul", [ROTATION_INPUT, "times"], [TURN_OUTPUT])])
    model.graph.initializer.append(times)
    model.graph.output.append(helper.make_tensor_value_info(TURN_OUTPUT, TensorProto.FLOAT, [1, width]))
    return model


def test_a_graph_may_say_how_the_head_turns_and_then_nothing_else_is_taken_off() -> None:
    nodding = Nodding(np.zeros(COEFFICIENTS), np.full(COEFFICIENTS, 0.01))
    regressor = Regressor(turning(1.5).SerializeToString(), COEFFICIENTS, nodding)
    answer = regressor(np.zeros(DIMENSION), np.array([0.1, 0.2, -0.3]))
    np.testing.assert_allclose(answer.turn, drawn_turn(np.array([0.15, 0.3, -0.45])), rtol=1e-6)


def test_no_graph_turns_a_head_far_from_what_was_read() -> None:
    regressor = Regressor(turning(-30).SerializeToString())
    answer = regressor(np.zeros(DIMENSION), np.array([0.0, 0.5, -0.5]))
    np.testing.assert_allclose(answer.turn, drawn_turn(np.array([0, 0.5 - MOST_OFF, MOST_OFF - 0.5])), rtol=1e-6)


def test_a_turn_that_is_not_finite_gives_the_last_good_answer() -> None:
    regressor = Regressor(turning(1e38).SerializeToString())
    good = regressor(np.zeros(DIMENSION), np.array([1e-9, 0, 0]))
    answer = regressor(np.zeros(DIMENSION), np.array([100.0, 0, 0]))
    np.testing.assert_array_equal(answer.coefficients, good.coefficients)
    np.testing.assert_array_equal(answer.turn, good.turn)
    assert regressor.failures == 1


def test_another_second_output_is_refused() -> None:
    model = graph()
    model.graph.output.append(helper.make_tensor_value_info("d", TensorProto.FLOAT, [1, COEFFICIENTS]))
    refused(model, "instead of one coefficients")
    refused(turning(1, width=4), "and perhaps head_turn")


def test_operators_outside_the_list_are_refused() -> None:
    refused(graph(extra=[helper.make_node("Det", ["d"], ["x"])]), "'Det'")
    refused(graph(extra=[helper.make_node("Mul", ["d", "d"], ["x"], domain="com.evil")]), "com.evil")
    branch = helper.make_graph([helper.make_node("Identity", ["d"], ["y"])], "branch", [], [])
    refused(graph(extra=[helper.make_node("Identity", ["d"], ["x"], body=branch)]), "graphs inside")


def test_data_outside_the_file_is_refused() -> None:
    model = graph()
    tensor = model.graph.initializer[0]
    tensor.ClearField("raw_data")
    tensor.data_location = TensorProto.EXTERNAL
    tensor.external_data.add(key="location", value="/etc/passwd")
    refused(model, "outside of itself")


def test_too_much_of_it_is_refused() -> None:
    refused(graph(nodes=600), "nodes")
    with pytest.raises(RegressorError, match="the limit is 32 MB"):
        Regressor(bytes(33 * 2**20))


@pytest.mark.parametrize("content", [b"", b"\x80\x04pickle", b"hello", graph().SerializeToString()[:-200]])
def test_bytes_that_are_no_graph_are_refused(content: bytes) -> None:
    with pytest.raises(RegressorError, match="cannot be used"):
        Regressor(content)
