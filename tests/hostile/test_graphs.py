"""ONNX graphs from avatars of strangers: of allowed operators too one can make a bomb."""

import resource
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import onnx
import pytest
from gemheads.models.driver.axes import drawn_turn
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.networks import NetworkError, open_session
from gemheads.models.driver.regressor import FEATURES_INPUT, OUTPUT, ROTATION_INPUT, Regressor, RegressorError
from onnx import TensorProto, helper, numpy_helper


def model(
    nodes: Sequence[onnx.NodeProto],
    constants: dict[str, np.ndarray] | None = None,
    inputs: Sequence[onnx.ValueInfoProto] = (),
) -> onnx.ModelProto:
    """These nodes between the features and ``answer``, of which the first seven numbers are the coefficients."""
    known = {
        "first": np.array([0]),
        "last": np.array([7]),
        "across": np.array([1]),
        "turn": np.zeros((3, 7), np.float32),
        **(constants or {}),
    }
    body = [
        *nodes,
        helper.make_node("Slice", ["answer", "first", "last", "across"], ["sliced"]),
        helper.make_node("MatMul", [ROTATION_INPUT, "turn"], ["turned"]),
        helper.make_node("Add", ["sliced", "turned"], [OUTPUT]),
    ]
    given = ((FEATURES_INPUT, DIMENSION), (ROTATION_INPUT, 3))
    graph = helper.make_graph(
        body,
        "regressor",
        [*(helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, size]) for name, size in given), *inputs],
        [helper.make_tensor_value_info(OUTPUT, TensorProto.FLOAT, [1, 7])],
        [numpy_helper.from_array(values, name) for name, values in known.items()],
    )
    return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)


def refused(bomb: onnx.ModelProto | bytes, said: str) -> None:
    content = bomb if isinstance(bomb, bytes) else bomb.SerializeToString()
    began, before = time.process_time(), resident()
    with pytest.raises(RegressorError, match=said) as caught:
        Regressor(content, 7)
    assert time.process_time() - began < 2
    assert resident() - before < 2**26
    assert len(str(caught.value)) < 500
    assert "\n" not in str(caught.value)


def resident() -> int:
    """Bytes at the peak."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def varint(number: int) -> bytes:
    return bytes([number & 127 | 128]) + varint(number >> 7) if number > 127 else bytes([number])


def record(number: int, content: bytes, beyond: int = 0) -> bytes:
    """A field of bytes, whose tag has more than the 32 bits that onnxruntime looks at where ``beyond`` is not 0."""
    return varint(number << 3 | 2 | beyond) + varint(len(content)) + content


def by_hand(more: bytes, of_model: bytes = b"") -> bytes:
    """A harmless graph with more fields behind its own."""
    whole = model(identity())
    graph = whole.graph.SerializeToString()
    whole.ClearField("graph")
    return whole.SerializeToString() + record(7, graph + more) + of_model


def identity() -> list[onnx.NodeProto]:
    return [helper.make_node("Identity", [FEATURES_INPUT], ["answer"])]


def test_a_graph_like_these_that_is_harmless_answers() -> None:
    features = np.arange(DIMENSION)
    regressor = Regressor(model(identity()).SerializeToString(), 7)
    np.testing.assert_array_equal(regressor(features, np.zeros(3)).coefficients, features[:7])


def test_a_kilobyte_that_doubles_itself_to_gigabytes() -> None:
    nodes = [
        helper.make_node("Concat", [f"y{i}" if i else FEATURES_INPUT] * 2, [f"y{i + 1}"], axis=1) for i in range(22)
    ]
    refused(model([*nodes, helper.make_node("Identity", ["y22"], ["answer"])]), "more than a regressor needs")


def test_constants_that_double_themselves_while_the_file_is_opened() -> None:
    """onnxruntime 1.31 aborts the program when their length has more than 32 bits."""
    nodes = [helper.make_node("Concat", [f"y{i}"] * 2, [f"y{i + 1}"], axis=1) for i in range(22)]
    ones = {"y0": np.ones((1, 1000), np.float32)}
    refused(model([*nodes, helper.make_node("Identity", ["y22"], ["answer"])], ones), "what was there before")


@pytest.mark.parametrize(
    ("node", "said"),
    [
        (helper.make_node("Transpose", [FEATURES_INPUT], ["answer"], perm=[1, 0]), "'Transpose', which is not allowed"),
        (helper.make_node("Add", [FEATURES_INPUT, "column"], ["answer"]), "more than a row"),
        (helper.make_node("Add", [FEATURES_INPUT, "cube"], ["answer"]), "more than a row"),
        (helper.make_node("Concat", [FEATURES_INPUT] * 2, ["answer"], axis=0), "joins more than rows"),
        (helper.make_node("Concat", [FEATURES_INPUT] * 2, ["answer"]), "joins more than rows"),
        (helper.make_node("MatMul", [FEATURES_INPUT, FEATURES_INPUT], ["answer"]), "no row times a constant matrix"),
        (helper.make_node("MatMul", ["column", FEATURES_INPUT], ["answer"]), "no row times a constant matrix"),
        (helper.make_node("MatMul", [FEATURES_INPUT, "cube"], ["answer"]), "no row times a constant matrix"),
        (helper.make_node("Gemm", [FEATURES_INPUT, "row"], ["answer"], transA=1), "makes a column"),
        (helper.make_node("Gemm", [FEATURES_INPUT, "row", "column"], ["answer"]), "no row times a constant matrix"),
        (helper.make_node("Clip", [FEATURES_INPUT, "row", "row"], ["answer"]), "more than single constants"),
        (helper.make_node("Identity", ["row"], ["answer"]), "what was there before"),
        (helper.make_node("Identity", ["nobody"], ["answer"]), "what was there before"),
        (helper.make_node("Identity", [FEATURES_INPUT], ["row"]), "a name that is taken"),
        (helper.make_node("Identity", [FEATURES_INPUT], ["answer", "more"]), "what was there before"),
        (helper.make_node("Cast", [FEATURES_INPUT], ["answer"], to=TensorProto.FLOAT), "no constant of float16"),
        (helper.make_node("Cast", ["row"], ["answer"], to=TensorProto.FLOAT), "no constant of float16"),
        (helper.make_node("Cast", ["half"], ["answer"], to=TensorProto.DOUBLE), "no constant of float16"),
        (helper.make_node("Cast", ["half"], ["row"], to=TensorProto.FLOAT), "a name that is taken"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.op_type,
)
def test_whatever_makes_more_than_a_row(node: onnx.NodeProto, said: str) -> None:
    shapes = {"column": (1000, 1), "row": (1, 1000), "cube": (10, 10, 10)}
    constants = {name: np.ones(shape, np.float32) for name, shape in shapes.items()}
    refused(model([node], {**constants, "half": np.ones((1, 10), np.float16)}), said)


def test_work_for_an_hour() -> None:
    """500 products with one and the same matrix of a megabyte."""
    names = [FEATURES_INPUT, *(f"m{i}" for i in range(499)), "answer"]
    nodes = [helper.make_node("MatMul", [names[i], "large"], [names[i + 1]]) for i in range(500)]
    refused(model(nodes, {"large": np.zeros((DIMENSION, DIMENSION), np.float32)}), "more than a regressor needs")


def test_one_constant_that_is_made_wide_again_and_again() -> None:
    """onnxruntime does that while the file is opened, and keeps all of them."""
    nodes = [helper.make_node("Cast", ["half"], [f"c{i}"], to=TensorProto.FLOAT) for i in range(500)]
    refused(model([*nodes, *identity()], {"half": np.zeros((100, 1000), np.float16)}), "more than a regressor needs")


def test_two_constants_of_one_name() -> None:
    doubled = model(identity())
    doubled.graph.initializer.append(doubled.graph.initializer[0])
    refused(doubled, "two constants of one name")


def test_more_numbers_than_all_rows_of_a_regressor_have() -> None:
    widened = [
        helper.make_node("Slice", [FEATURES_INPUT, "first", "across", "across"], ["one"]),
        helper.make_node("Add", ["wide", "one"], ["row"]),
    ]
    wide = {"wide": np.zeros((1, 2**16), np.float32)}
    kept = [helper.make_node("Neg", [f"n{i}" if i else "row"], [f"n{i + 1}"]) for i in range(70)]
    for nodes in (kept, [helper.make_node("Max", ["row"] * 70, ["answer"])]):
        refused(model([*widened, *nodes], wide), "more than a regressor needs")


@pytest.mark.parametrize("dims", [[2**30, 1], [2**62, 2**62], [-1, -1], [1] * 9, [2**62] * 10**6])
def test_a_constant_that_is_smaller_than_it_claims(dims: list[int]) -> None:
    lying = model(identity())
    lying.graph.initializer.append(TensorProto(name="large", data_type=TensorProto.FLOAT, dims=dims))
    refused(lying, "more numbers than are in it|more than a regressor needs")


def test_a_matrix_of_float16_works_like_one_of_float32() -> None:
    nodes = [
        helper.make_node("Cast", ["half"], ["matrix"], to=TensorProto.FLOAT),
        helper.make_node("MatMul", [FEATURES_INPUT, "matrix"], ["answer"]),
    ]
    doubling = {"half": 2 * np.eye(DIMENSION, dtype=np.float16)}
    features = np.arange(DIMENSION)
    answer = Regressor(model(nodes, doubling).SerializeToString(), 7)(features, np.zeros(3))
    np.testing.assert_array_equal(answer.coefficients, 2 * features[:7])


def test_an_input_with_a_constant_of_its_name() -> None:
    given = helper.make_tensor_value_info("many", TensorProto.FLOAT, [1, 7])
    refused(model(identity(), {"many": np.zeros((1, 7), np.float32)}, [given]), "an input that is a constant too")


def test_a_failure_later_on_gives_the_last_good_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    regressor = Regressor(model(identity()).SerializeToString(), 7)
    good = regressor(np.ones(DIMENSION), np.ones(3))

    class Broken:
        def run(self, *_: object) -> None:
            raise RuntimeError("Non-zero status code returned while running a node")

    monkeypatch.setattr(regressor, "_session", Broken())
    again = regressor(np.zeros(DIMENSION), np.zeros(3))
    np.testing.assert_array_equal(again.coefficients, good.coefficients)
    np.testing.assert_array_equal(again.turn, drawn_turn(np.ones(3)))
    assert regressor.failures == 1


@pytest.mark.parametrize("field", ["input", "output"])
def test_names_as_long_as_a_book(field: str) -> None:
    """Found by fuzzing: messages repeated them."""
    book = model(identity())
    getattr(book.graph, field)[0].name = "x" * 50_000
    if field == "input":
        book.graph.node[0].input[0] = "x" * 50_000
    else:
        book.graph.node[-1].output[0] = "x" * 50_000
    refused(book, "takes|instead of one")


def test_a_sparse_constant_of_gigabytes() -> None:
    values = numpy_helper.from_array(np.ones(1, np.float32), "v")
    places = numpy_helper.from_array(np.zeros(1, np.int64), "i")
    sparse = helper.make_sparse_tensor(values, places, [1, 2**30])
    refused(model([helper.make_node("Neg", [FEATURES_INPUT], ["answer"], sparse_value=sparse)]), "sparse tensors")


def test_graphs_within_operators_and_functions() -> None:
    inner = helper.make_graph(identity(), "inner", [], [])
    refused(model([helper.make_node("Neg", [FEATURES_INPUT], ["answer"], body=inner)]), "graphs inside operators")
    refused(model([helper.make_node("Loop", [], ["answer"])]), "'Loop', which is not allowed")
    called = model(identity())
    called.functions.append(helper.make_function("ai.onnx", "Add", [], [], identity(), [helper.make_opsetid("", 17)]))
    refused(called, "functions of its own")


def test_fields_by_hand_are_read_as_they_are_by_the_library() -> None:
    node = helper.make_node("Gemm", [FEATURES_INPUT, "square"], ["more"], transA=0).SerializeToString()
    square = numpy_helper.from_array(np.zeros((DIMENSION, 1), np.float32), "square").SerializeToString()
    Regressor(by_hand(record(1, node) + record(5, square)), 7)


@pytest.mark.parametrize("beyond", [2**32, 2**35, 2**63, 2**64])
def test_fields_that_only_onnxruntime_finds(beyond: int) -> None:
    """It takes 32 bits of a tag, so a number too large to be any field's is that of one that is there."""
    node = helper.make_node("Sin", [FEATURES_INPUT], ["more"]).SerializeToString()
    refused(by_hand(record(1, node, beyond)), "not a protobuf message|more than 64 bits|cut off")


def attribute(*parts: bytes) -> bytes:
    """Such a node, with an attribute transA of these parts."""
    node = helper.make_node("Gemm", [FEATURES_INPUT, "turn"], ["more"]).SerializeToString()
    return record(1, node + record(5, record(1, b"transA") + b"".join(parts) + b"\xa0\x01\x02"))


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (attribute(b"\x18\x01", record(3, b"\0")), "twice, or as something else"),
        (attribute(b"\x18\x01", b"\x18\x00"), "twice, or as something else"),
        (attribute(b"\x1d\0\0\0\0"), "twice, or as something else"),
        (attribute(record(8, b"\0") * 2, b"\x1b\x1c"), "not a protobuf message: wire type 3"),
        (attribute(b"\x18" + b"\xff" * 9 + b"\x03"), "more than 64 bits"),
        (attribute(record(21, b"outer")), "the field 21 of AttributeProto, which no"),
        (record(1, record(4, b"Neg") + record(4, b"Sin")), "twice, or as something else"),
        (record(5, b"\x10" + varint(2**32 + TensorProto.FLOAT16)), "the field 2 of TensorProto, which no"),
        (record(5, b"\x70\x01"), "data outside of itself"),
        (record(15, b""), "sparse tensors"),
        (record(0, b""), "not a protobuf message"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_two_readers_understand_differently(more: bytes, said: str) -> None:
    refused(by_hand(more), said)


def test_an_attribute_that_stands_twice() -> None:
    node = helper.make_node("Concat", [FEATURES_INPUT], ["more"], axis=0)
    node.attribute.append(helper.make_attribute("axis", 1))
    refused(model([*identity(), node]), "attribute of Concat twice")


def test_a_second_graph_that_is_joined_to_the_first() -> None:
    node = helper.make_node("Sin", [FEATURES_INPUT], ["more"]).SerializeToString()
    refused(by_hand(b"", record(7, record(1, node))), "twice, or as something else")
    refused(by_hand(b"", record(20, b"")), "the field 20 of ModelProto, which no regressor needs")


@pytest.mark.parametrize("number", [1, 5, 11, 13])
def test_a_million_empty_fields(number: int) -> None:
    """Of two bytes each onnxruntime makes hundreds."""
    refused(by_hand(record(number, b"") * 10**6), "more than a regressor needs")


def test_a_million_numbers_and_sides_of_a_byte_each() -> None:
    refused(by_hand(record(5, record(7, bytes(10**6)))), "more than a regressor needs")
    sides = record(2, record(1, record(2, record(1, b"") * 10**6)))
    refused(by_hand(record(13, sides)), "more than a regressor needs")


def test_a_model_in_the_format_of_onnxruntime_itself() -> None:
    """Its mark is looked for in the fifth byte, whatever else the bytes are."""
    with pytest.raises(NetworkError, match="protobuf"):
        open_session(b"\x10\0\0\0ORTM" + bytes(64), "it")


@pytest.mark.parametrize("location", ["/etc/passwd", "../../secret", "/dev/zero"])
def test_data_outside_of_the_file(location: str) -> None:
    outside = TensorProto(name="secret", data_type=TensorProto.FLOAT, dims=[7], data_location=TensorProto.EXTERNAL)
    outside.external_data.add(key="location", value=location)
    among_constants = model(identity())
    among_constants.graph.initializer.append(outside)
    refused(among_constants, "data outside of itself")
    refused(model([helper.make_node("Neg", [FEATURES_INPUT], ["answer"], value=outside)]), "tensors inside operators")


def test_a_graph_larger_than_any_regressor(tmp_path: Path) -> None:
    with pytest.raises(RegressorError, match="the limit is 32 MB"):
        Regressor(bytes(2**25 + 1))
