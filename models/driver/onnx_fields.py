"""The fields of onnx.proto that a regressor may have, so that onnxruntime finds in a graph what was looked at, no more.

Two readers of one protobuf message can understand it differently: one does not know a field, one cuts a number to 32
bits, one takes the first and the other the last of two values. What could be read so is refused.
"""

from dataclasses import dataclass, replace

from .protobuf import BYTES, FIXED32, VARINT, fields, message

MAX_FIELDS = 2**14
"""Fields and packed whole numbers: a regressor has 1,000. Empty ones would fill the memory a hundred times over."""


@dataclass(frozen=True)
class _Field:
    wire: int
    many: bool = False
    within: str = ""
    """Of which kind the message in it is, where it is one."""
    below: int = 2**64


def _one(kind: str) -> _Field:
    return _Field(BYTES, within=kind)


def _many(kind: str) -> _Field:
    return _Field(BYTES, many=True, within=kind)


_INT, _TEXT, _FLOAT = _Field(VARINT), _Field(BYTES), _Field(FIXED32)
_INTS, _TEXTS, _FLOATS = (replace(field, many=True) for field in (_INT, _TEXT, _FLOAT))
_INT32 = _Field(VARINT, below=2**31)
_ZERO = _Field(VARINT, below=1)
_TENSOR_LOCATION = 14
_FIELDS: dict[str, dict[int, _Field]] = {
    "ModelProto": {
        **{1: _INT, 2: _TEXT, 3: _TEXT, 4: _TEXT, 5: _INT, 6: _TEXT},
        **{7: _one("GraphProto"), 8: _many("OperatorSetIdProto"), 14: _many("StringStringEntryProto")},
    },
    "OperatorSetIdProto": {1: _TEXT, 2: _INT},
    "StringStringEntryProto": {1: _TEXT, 2: _TEXT},
    "GraphProto": {
        **{1: _many("NodeProto"), 2: _TEXT, 5: _many("TensorProto"), 10: _TEXT},
        **{number: _many("ValueInfoProto") for number in (11, 12, 13)},
        16: _many("StringStringEntryProto"),
    },
    "NodeProto": {
        **{1: _TEXTS, 2: _TEXTS, 3: _TEXT, 4: _TEXT, 5: _many("AttributeProto"), 6: _TEXT, 7: _TEXT},
        9: _many("StringStringEntryProto"),
    },
    "AttributeProto": {1: _TEXT, 2: _FLOAT, 3: _INT, 4: _TEXT, 7: _FLOATS, 8: _INTS, 9: _TEXTS, 13: _TEXT, 20: _INT32},
    "TensorProto": {
        **{1: _INTS, 2: _INT32, 4: _FLOATS, 5: _INTS, 7: _INTS, 8: _TEXT, 9: _TEXT, 12: _TEXT},
        **{_TENSOR_LOCATION: _ZERO, 16: _many("StringStringEntryProto")},
    },
    "ValueInfoProto": {1: _TEXT, 2: _one("TypeProto"), 3: _TEXT, 4: _many("StringStringEntryProto")},
    "TypeProto": {1: _one("TypeProto.Tensor"), 6: _TEXT},
    "TypeProto.Tensor": {1: _INT32, 2: _one("TensorShapeProto")},
    "TensorShapeProto": {1: _many("TensorShapeProto.Dimension")},
    "TensorShapeProto.Dimension": {1: _INT, 2: _TEXT, 3: _TEXT},
}
_REASONS = {
    ("ModelProto", 25): "defines functions of its own",
    ("GraphProto", 15): "has sparse tensors",
    ("AttributeProto", 22): "has sparse tensors",
    ("AttributeProto", 23): "has sparse tensors",
    ("AttributeProto", 5): "holds tensors inside operators",
    ("AttributeProto", 10): "holds tensors inside operators",
    ("AttributeProto", 6): "holds graphs inside operators",
    ("AttributeProto", 11): "holds graphs inside operators",
    ("TensorProto", 13): "keeps data outside of itself",
    ("TensorProto", _TENSOR_LOCATION): "keeps data outside of itself",
}
"""What is said of fields that are not above, or not so large."""


def check_fields(model: bytes) -> None:
    """Makes sure that a ModelProto has only fields that are known here, each written and repeated as onnx.proto says.

    Raises ValueError saying which is not so.
    """
    _check(memoryview(model), "ModelProto", MAX_FIELDS)


def _check(content: memoryview, kind: str, left: int) -> int:
    """How many fields may still come behind this message, of which ``left`` might come before."""
    seen: set[int] = set()
    for number, wire, value in fields(content):
        field = _FIELDS[kind].get(number)
        if field is None or (isinstance(value, int) and value >= field.below):
            reason = _REASONS.get((kind, number), f"has the field {number} of {kind}, which no regressor needs")
            raise ValueError(f"its ONNX graph {reason}")
        packed = wire == BYTES and field.many and field.wire != BYTES
        if (wire != field.wire and not packed) or (number in seen and not field.many):
            raise ValueError(f"its ONNX graph has the field {number} of {kind} twice, or as something else")
        seen.add(number)
        left -= len(message(value)) if packed and field.wire == VARINT else 1
        if left < 0:
            raise ValueError(f"its ONNX graph has more than {MAX_FIELDS} fields, more than a regressor needs")
        if field.within:
            left = _check(message(value), field.within, left)
    return left
