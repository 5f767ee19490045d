"""ONNX graphs with fields exchanged, lost, doubled, and with what attackers would add."""

from contextlib import suppress
from random import Random
from typing import Any

import onnx
from onnx import helper

from .damage import NUMBERS, damaged

_OPERATORS = (
    *("Loop", "If", "Scan", "RandomNormal", "ConstantOfShape", "Expand", "Tile", "Pad", "Resize", "Range", "OneHot"),
    *("Add", "Constant", "Reshape", "Gather", "MatMul", "Concat", "Pow", "Slice", "Split", "Squeeze", "Transpose", ""),
    *("Cast", "Div", "Flatten", "Unsqueeze", "Identity", "Gemm", "Clip", "Max"),
)
_TEXTS = (
    "",
    "../../../../etc/passwd",
    "/dev/zero",
    "x" * 5000,
    "relative_features",
    "coefficients",
    "a",
    "ai.onnx",
    "com.microsoft",
    "\0",
)


def mutated(content: bytes, rng: Random) -> bytes:
    """One mutation of a graph: of its bytes, or of its fields."""
    if rng.random() < 0.3:
        return damaged(content, rng)
    model = onnx.load_from_string(content)
    for _ in range(rng.choice((1, 1, 2, 3))):
        with suppress(ValueError):  # no such number among the names of a field
            rng.choice((_field, _field, _field, _operator, _operator, _external, _added))(model, rng)
    return model.SerializeToString()


def _messages(message: Any) -> list[Any]:
    """The message and all that lie in it."""
    found = [message]
    for field, value in message.ListFields():
        if field.type == field.TYPE_MESSAGE:
            for inner in value if not hasattr(value, "ListFields") else [value]:
                found += _messages(inner)
    return found


def _field(model: onnx.ModelProto, rng: Random) -> None:
    message = rng.choice(_messages(model))
    fields = list(message.ListFields())
    if not fields:
        return
    field, value = rng.choice(fields)
    if rng.random() < 0.15:
        message.ClearField(field.name)
    elif hasattr(value, "append") or hasattr(value, "add"):
        _repeated(field, value, rng)
    elif field.type == field.TYPE_STRING:
        setattr(message, field.name, rng.choice(_TEXTS))
    elif field.type == field.TYPE_BYTES:
        setattr(message, field.name, damaged(value, rng))
    elif field.type in (field.TYPE_FLOAT, field.TYPE_DOUBLE):
        setattr(message, field.name, rng.choice((float("nan"), float("inf"), 1e38, -1.0, 0.0)))
    elif field.type != field.TYPE_MESSAGE:
        setattr(message, field.name, _number(field, rng))


def _repeated(field: Any, values: Any, rng: Random) -> None:
    place = rng.randrange(len(values))
    if rng.random() < 0.3:
        del values[place]
    elif field.type == field.TYPE_MESSAGE:
        for _ in range(rng.choice((1, 1, 600))):
            values.add().CopyFrom(values[place])
    elif field.type == field.TYPE_STRING:
        values[place] = rng.choice(_TEXTS)
    elif field.type == field.TYPE_BYTES:
        values[place] = damaged(values[place], rng)
    elif field.type in (field.TYPE_INT32, field.TYPE_INT64, field.TYPE_UINT64):
        values[place] = _number(field, rng)
    else:
        values[place] = float("nan")


def _number(field: Any, rng: Random) -> int:
    number = rng.choice((*NUMBERS, *range(2, 20), -1))
    if field.type in (field.TYPE_INT32, field.TYPE_ENUM):
        return number if abs(number) < 2**31 else -1
    return number if number < 2**63 else -(2**63)


def _operator(model: onnx.ModelProto, rng: Random) -> None:
    if model.graph.node:
        rng.choice(model.graph.node).op_type = rng.choice(_OPERATORS)


def _external(model: onnx.ModelProto, rng: Random) -> None:
    if model.graph.initializer:
        tensor = rng.choice(model.graph.initializer)
        tensor.data_location = onnx.TensorProto.EXTERNAL
        entry = tensor.external_data.add()
        entry.key, entry.value = "location", rng.choice(_TEXTS)


def _added(model: onnx.ModelProto, rng: Random) -> None:
    """A node of one of the allowed operators, somewhere."""
    names = [name for node in model.graph.node for name in (*node.input, *node.output)] or [""]
    inputs = [rng.choice(names) for _ in range(rng.randint(0, 3))]
    node = helper.make_node(rng.choice(_OPERATORS), inputs, [rng.choice((*names, "new"))])
    model.graph.node.insert(rng.randrange(len(model.graph.node) + 1), node)
