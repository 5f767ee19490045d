"""An ONNX graph as it is written, node by node: the same bytes from the same numbers."""

from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper


class Graph:
    """Nodes and constants as they come; equal constants are kept once."""

    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []
        self._kept: dict[tuple[str, tuple[int, ...], bytes], str] = {}

    def constant(self, name: str, array: NDArray[Any] | np.generic) -> str:
        """Its name; float32, or whole numbers."""
        key = (str(array.dtype), array.shape, array.tobytes())
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
        """The name of its output."""
        output = f"{operator.lower()}_{len(self.nodes)}"
        made = helper.make_node(operator, list(inputs), [output], name=output)
        made.attribute.extend(helper.make_attribute(name, value) for name, value in attributes.items())
        self.nodes.append(made)
        return output

    def clipped(self, value: str, lower: str, upper: str) -> str:
        """Between two constants."""
        return self.node("Min", self.node("Max", value, lower), upper)
