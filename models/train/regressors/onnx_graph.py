"""An ONNX graph as it is written, node by node: the same bytes from the same numbers."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper

ENDS = (("lower", -1), ("upper", 1))
"""Of a range, and on which side of zero."""


class Graph:
    """Nodes and constants as they come; equal ones are kept once."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []
        self._kept: dict[tuple[str, tuple[int, ...], bytes], str] = {}
        self._made: dict[tuple[str, tuple[str, ...], tuple[tuple[str, int], ...]], str] = {}

    @classmethod
    def up_to(cls, output: str, model: onnx.ModelProto) -> "Graph":
        """What a model needs for one of its outputs, to be written on."""
        graph, needed = cls(), {output}
        for node in reversed(model.graph.node):
            if needed.intersection(node.output):
                graph.nodes.insert(0, node)
                needed.update(node.input)
        for tensor in model.graph.initializer:
            if tensor.name in needed:
                graph.constants.append(tensor)
                graph._kept.setdefault(_key(numpy_helper.to_array(tensor)), tensor.name)
        return graph

    def constant(self, name: str, array: NDArray[Any] | np.generic) -> str:
        """Its name; float32, or whole numbers."""
        key = _key(array)
        if key not in self._kept:
            self._kept[key] = name
            self.constants.append(numpy_helper.from_array(np.asarray(array), name))
        return self._kept[key]

    def learned(self, name: str, array: NDArray[np.float32]) -> str:
        """Kept in float16; used in float32. Raises ValueError for numbers beyond its range."""
        with np.errstate(over="ignore"):
            half = array.astype(np.float16)
        if not np.isfinite(half).all():
            raise ValueError(f"{name} is beyond what float16 can say; train again with another seed")
        return self.node("Cast", self.constant(name, half), to=TensorProto.FLOAT)

    def node(self, operator: str, *inputs: str, **attributes: int) -> str:
        """The name of its output; that of the node that does the same already, where there is one."""
        key = (operator, inputs, tuple(sorted(attributes.items())))
        if key in self._made:
            return self._made[key]
        output = f"{operator.lower()}_{len(self.nodes)}"
        made = helper.make_node(operator, list(inputs), [output], name=output)
        made.attribute.extend(helper.make_attribute(name, value) for name, value in attributes.items())
        self.nodes.append(made)
        self._made[key] = output
        return output

    def mean(self, values: Sequence[str], share: str) -> str:
        """Of several values; ``share`` is what the constant is called."""
        total = values[0]
        for value in values[1:]:
            total = self.node("Add", total, value)
        return self.node("Mul", total, self.constant(share, np.float32(1 / len(values))))

    def clipped(self, value: str, lower: str, upper: str) -> str:
        """Between two constants."""
        return self.node("Min", self.node("Max", value, lower), upper)


def written(model: onnx.ModelProto) -> bytes:
    """The model's bytes. Raises an error of onnx's for one that is wrong."""
    onnx.checker.check_model(model)
    return model.SerializeToString(deterministic=True)


def _key(array: NDArray[Any] | np.generic) -> tuple[str, tuple[int, ...], bytes]:
    return str(array.dtype), array.shape, array.tobytes()
