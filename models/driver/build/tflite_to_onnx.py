"""A TFLite network as an ONNX graph: only the operations the three face networks use.

Convolutions keep their activations in NCHW, everything else stays in the source's NHWC, with transposes where the two
meet. Of rows of tokens, which are pictures one pixel high, convolutions are matrix products, and what ten operations
make of a layer's norm is one. The names of nodes and weights are counted in visiting order, so the same source gives
the same bytes. Needs the packages onnx and tflite.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import onnx
import tflite
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper

from .tflite_operation import ends, options_of
from .tflite_patterns import BOTTLENECK, LAYER_NORM, bottleneck, layer_norm

Layout = Literal["nchw", "source", "turned"]
"""turned: [1, 1, n, c] held as [1, 1, c, n], so that a transposition of tokens moves nothing."""
Array = NDArray[Any]

_OPSET = 17
_IR_VERSION = 8
_PRODUCER = "tfl2onnx-mini"
_HALF_FROM = 65
"""Weights of at least this many values are stored as float16 where that loses nothing."""
_OP_NAMES = {value: name for name, value in vars(tflite.BuiltinOperator).items() if isinstance(value, int)}
_DTYPES = {
    tflite.TensorType.FLOAT32: np.float32,
    tflite.TensorType.FLOAT16: np.float16,
    tflite.TensorType.INT32: np.int32,
    tflite.TensorType.INT64: np.int64,
}
_BINARY = {"ADD": "Add", "SUB": "Sub", "MUL": "Mul", "DIV": "Div"}
_UNARY = {"RELU": "Relu", "LOGISTIC": "Sigmoid", "NEG": "Neg", "SQRT": "Sqrt"}


@dataclass(frozen=True)
class _Operation:
    """One of the source's, read."""

    name: str
    inputs: list[int]
    """Source tensors."""
    output: int
    options: Any
    """Of the kind that its rule asks for, or None."""


def convert(source: bytes, name: str, outputs: Sequence[str], extra_tensors: Sequence[int] = ()) -> onnx.ModelProto:
    """The ONNX model of a TFLite file with one input, which is called ``input``.

    ``outputs`` names the source's outputs and, behind them, ``extra_tensors``: inner tensors, by their index, that are
    made outputs too. Outputs of rank 4 are flattened to [1, n].
    Raises NotImplementedError naming an operation that none of the face networks has.
    """
    return Conversion(source).run(name, outputs, extra_tensors)


class Conversion:
    """Of one file: what of its graph is done."""

    def __init__(self, source: bytes) -> None:
        self.model = tflite.Model.GetRootAsModel(source, 0)
        self.graph: Any = self.model.Subgraphs(0)
        self.nodes: list[onnx.NodeProto] = []
        self.weights: list[onnx.TensorProto] = []
        self.constants: dict[int, Array] = {}
        self.values: dict[int, tuple[str, Layout]] = {}
        """Source tensor -> its ONNX name and layout."""
        self.transposed: dict[tuple[int, Layout], str] = {}
        self.weight_names: dict[tuple[str, tuple[int, ...], bytes], str] = {}
        self.count = 0
        self.uses = Counter(
            int(tensor)
            for place in range(self.graph.OperatorsLength())
            for tensor in self.graph.Operators(place).InputsAsNumpy()
        )
        """Source tensor -> how many operations read it."""
        for i in range(self.graph.TensorsLength()):
            tensor = self.graph.Tensors(i)
            buffer = self.model.Buffers(tensor.Buffer())
            if buffer.DataLength():
                flat = np.frombuffer(buffer.DataAsNumpy().tobytes(), _DTYPES[tensor.Type()])
                self.constants[i] = flat.reshape(self.shape(i))

    def run(self, name: str, outputs: Sequence[str], extra_tensors: Sequence[int]) -> onnx.ModelProto:
        source_input = int(self.graph.InputsAsNumpy()[0])
        self.values[source_input] = ("input", "source")
        inputs = [helper.make_tensor_value_info("input", TensorProto.FLOAT, self.shape(source_input))]
        operations = self.dequantized([self.graph.Operators(i) for i in range(self.graph.OperatorsLength())])
        while operations:
            if layer_norm(self, operations[: len(LAYER_NORM)]):
                del operations[: len(LAYER_NORM)]
            elif bottleneck(self, operations[: len(BOTTLENECK)]):
                del operations[: len(BOTTLENECK)]
            else:
                self.add_operation(operations.pop(0))
        infos: list[onnx.ValueInfoProto] = []
        tensors = [int(i) for i in self.graph.OutputsAsNumpy()] + list(extra_tensors)
        for output, tensor in zip(outputs, tensors, strict=True):
            value, shape = self.get(tensor, "source"), self.shape(tensor)
            if len(shape) == 4:
                value = self.node("Reshape", [value, self.weight(np.array([1, -1], np.int64))])
                shape = [1, int(np.prod(shape))]
            self.nodes.append(helper.make_node("Identity", [value], [output]))
            infos.append(helper.make_tensor_value_info(output, TensorProto.FLOAT, shape))
        graph = helper.make_graph(self.nodes, name, inputs, infos, self.weights)
        model = helper.make_model(
            graph,
            opset_imports=[helper.make_opsetid("", _OPSET)],
            producer_name=_PRODUCER,
            ir_version=_IR_VERSION,
        )
        onnx.checker.check_model(model)
        return model

    def shape(self, tensor: int) -> list[int]:
        source = self.graph.Tensors(tensor)
        return [int(n) for n in source.ShapeAsNumpy()] if source.ShapeLength() else []

    def fresh(self, prefix: str) -> str:
        self.count += 1
        return f"{prefix}{self.count}"

    def node(self, operation: str, inputs: Sequence[str], **attributes: Any) -> str:
        output = self.fresh(operation.lower())
        self.nodes.append(helper.make_node(operation, inputs, [output], **attributes))
        return output

    def weight(self, array: Array) -> str:
        """The name of a constant, stored once however often it is used."""
        key = (array.dtype.str, array.shape, array.tobytes())
        if key not in self.weight_names:
            name = self.fresh("w")
            half = array.astype(np.float16) if array.dtype == np.float32 and array.size >= _HALF_FROM else None
            if half is not None and np.array_equal(half.astype(np.float32), array):
                self.weights.append(numpy_helper.from_array(half, name))
                name = self.node("Cast", [name], to=TensorProto.FLOAT)
            else:
                self.weights.append(numpy_helper.from_array(np.ascontiguousarray(array), name))
            self.weight_names[key] = name
        return self.weight_names[key]

    def get(self, tensor: int, layout: Layout) -> str:
        """The ONNX name of a source tensor in the layout wanted."""
        if tensor in self.constants:
            array = self.constants[tensor]
            if layout == "nchw":
                array = array.reshape((1,) * (4 - array.ndim) + array.shape).transpose(0, 3, 1, 2)
            return self.weight(array)
        name, held = self.values[tensor]
        if held == layout or len(self.shape(tensor)) != 4:
            return name
        if (tensor, layout) not in self.transposed:
            if held == "turned":
                name = self.node("Transpose", [name], perm=[0, 1, 3, 2])
            if layout == "nchw" or held == "nchw":
                name = self.node("Transpose", [name], perm=[0, 3, 1, 2] if layout == "nchw" else [0, 2, 3, 1])
            self.transposed[tensor, layout] = name
        return self.transposed[tensor, layout]

    def shared_layout(self, inputs: Sequence[int]) -> Layout:
        moving = [self.values[i][1] for i in inputs if i not in self.constants]
        return "nchw" if "nchw" in moving else "source"

    def activated(self, value: str, activation: int) -> str:
        if activation == tflite.ActivationFunctionType.NONE:
            return value
        if activation == tflite.ActivationFunctionType.RELU:
            return self.node("Relu", [value])
        raise NotImplementedError(f"fused activation {activation}")

    def name_of(self, operation: Any) -> str:
        code = self.model.OperatorCodes(operation.OpcodeIndex())
        return _OP_NAMES[max(code.BuiltinCode(), code.DeprecatedBuiltinCode())]

    def dequantized(self, operations: Sequence[Any]) -> list[Any]:
        """Those that do not only widen weights, after these have been done."""
        left: list[Any] = []
        for operation in operations:
            inputs, output = ends(operation)
            if self.name_of(operation) == "DEQUANTIZE":
                self.constants[output] = self.constants[inputs[0]].astype(np.float32)
            else:
                left.append(operation)
        return left

    def add_operation(self, operation: Any) -> None:
        """Adds the nodes of one operation, and remembers where its output is."""
        name = self.name_of(operation)
        if name not in _RULES:
            raise NotImplementedError(f"TFLite operation {name}")
        rule, kind = _RULES[name]
        inputs, output = ends(operation)
        options = options_of(operation, kind) if kind else None
        self.values[output] = rule(self, _Operation(name, inputs, output, options))

    def weight_after(self, tensor: int, layout: Layout, constant: Array) -> list[str]:
        """A moving input and a constant, named in this order."""
        value = self.get(tensor, layout)
        return [value, self.weight(constant)]

    def padding(self, kind: int, size: Sequence[int], kernel: Sequence[int], options: Any) -> list[int]:
        """ONNX pads (top, left, bottom, right) of TFLite's SAME or VALID."""
        if kind == tflite.Padding.VALID:
            return [0, 0, 0, 0]
        before_after: list[tuple[int, int]] = []
        for n, k, stride in zip(size, kernel, (options.StrideH(), options.StrideW()), strict=True):
            missing = max((-(-n // stride) - 1) * stride + k - n, 0)
            before_after.append((missing // 2, missing - missing // 2))
        (top, bottom), (left, right) = before_after
        return [top, left, bottom, right]

    def convolution(self, inputs: Sequence[int], options: Any, depthwise: bool) -> str:
        weights = self.constants[inputs[1]]
        if (options.DilationHFactor(), options.DilationWFactor()) != (1, 1):
            raise NotImplementedError("dilated convolution")
        shape, kernel = self.shape(inputs[0]), list(weights.shape[1:3])
        oihw = weights.transpose(3, 0, 1, 2) if depthwise else weights.transpose(0, 3, 1, 2)
        arguments = [self.get(inputs[0], "nchw"), self.weight(np.ascontiguousarray(oihw))]
        if len(inputs) > 2 and inputs[2] >= 0:
            arguments.append(self.weight(self.constants[inputs[2]]))
        value = self.node(
            "Conv",
            arguments,
            kernel_shape=kernel,
            strides=[options.StrideH(), options.StrideW()],
            dilations=[1, 1],
            pads=self.padding(options.Padding(), shape[1:3], kernel, options),
            group=shape[3] if depthwise else 1,
        )
        return self.activated(value, options.FusedActivationFunction())

    def product(self, inputs: Sequence[int], options: Any) -> tuple[str, Layout]:
        """A 1x1 convolution of tokens [1, 1, n, in] as the matrix product that it is, in the layout of the tokens."""
        if (options.StrideH(), options.StrideW()) != (1, 1):
            raise NotImplementedError("1x1 convolution with a stride")
        rows = self.constants[inputs[1]].reshape(len(self.constants[inputs[1]]), -1)
        bias = self.constants[inputs[2]]
        if self.values[inputs[0]][1] == "turned":
            factors = [self.weight(rows), self.values[inputs[0]][0]]
            bias, layout = bias[:, None], "turned"
        else:
            factors, layout = self.weight_after(inputs[0], "source", np.ascontiguousarray(rows.T)), "source"
            bias = bias[None, None, None]  # of one row, it would be joined with the product by two more reshapes
        value = self.node("Add", [self.node("MatMul", factors), self.weight(bias)])
        return self.activated(value, options.FusedActivationFunction()), layout

    def conv(self, value: str, oihw: Array, bias: Array, **attributes: Any) -> str:
        """A convolution of stride 1 without padding, unless ``attributes`` say otherwise."""
        arguments = [value, self.weight(np.ascontiguousarray(oihw, np.float32)), self.weight(bias.astype(np.float32))]
        attributes.setdefault("kernel_shape", list(oihw.shape[2:]))
        return self.node("Conv", arguments, **attributes)

    def prelu(self, inputs: Sequence[int]) -> str:
        """PReLU(x) = (1 - a) Relu(x) + a x as two depthwise 1x1 convolutions.

        onnxruntime's own PRelu leaves the blocked layout of its convolutions and makes the landmark network 3x slower.
        """
        slope = self.constants[inputs[1]].reshape(-1).astype(np.float32)
        value = self.get(inputs[0], "nchw")

        def scaled(x: str, factor: Array) -> str:
            kernel = self.weight(np.ascontiguousarray(factor.reshape(-1, 1, 1, 1)))
            return self.node("Conv", [x, kernel], group=len(slope), kernel_shape=[1, 1])

        positive = scaled(self.node("Relu", [value]), np.float32(1) - slope)
        return self.node("Add", [positive, scaled(value, slope)])

    def max_pool(self, inputs: Sequence[int], options: Any) -> str:
        kernel = [options.FilterHeight(), options.FilterWidth()]
        pads = self.padding(options.Padding(), self.shape(inputs[0])[1:3], kernel, options)
        strides = [options.StrideH(), options.StrideW()]
        value = self.get(inputs[0], "nchw")
        value = self.node("MaxPool", [value], kernel_shape=kernel, strides=strides, pads=pads)
        return self.activated(value, options.FusedActivationFunction())

    def reduction(self, name: str, inputs: Sequence[int], options: Any) -> str:
        rank = len(self.shape(inputs[0]))
        axes = [int(axis) % rank for axis in np.atleast_1d(self.constants[inputs[1]])]
        value, keep = self.get(inputs[0], "source"), int(options.KeepDims())
        if name == "MEAN":
            return self.node("ReduceMean", [value], axes=axes, keepdims=keep)
        return self.node("ReduceSum", [value, self.weight(np.array(axes, np.int64))], keepdims=keep)

    def strided_slice(self, inputs: Sequence[int], output: int, options: Any) -> str:
        begin, end, stride = (self.constants[i].astype(np.int64).copy() for i in inputs[1:4])
        shape = self.shape(inputs[0])
        for axis in range(len(begin)):
            if options.BeginMask() >> axis & 1:
                begin[axis] = 0
            if options.EndMask() >> axis & 1:
                end[axis] = shape[axis]
            if options.ShrinkAxisMask() >> axis & 1:
                end[axis] = begin[axis] + 1
        arguments = [self.get(inputs[0], "source")]
        arguments += [self.weight(a) for a in (begin, end, np.arange(len(begin), dtype=np.int64), stride)]
        sliced = self.node("Slice", arguments)
        return self.node("Reshape", [sliced, self.weight(np.array(self.shape(output), np.int64))])


_Value = tuple[str, Layout]


def _convolved(graph: Conversion, one: _Operation) -> _Value:
    """Of rows of tokens, which are pictures one pixel high, a product."""
    pointwise = graph.constants[one.inputs[1]].shape[1:3] == (1, 1)
    if graph.shape(one.inputs[0])[1] == 1 and pointwise:
        return graph.product(one.inputs, one.options)
    return graph.convolution(one.inputs, one.options, depthwise=False), "nchw"


def _padded(graph: Conversion, one: _Operation) -> _Value:
    layout = graph.shared_layout(one.inputs[:1])
    pads = graph.constants[one.inputs[1]]
    if layout == "nchw":
        pads = pads[[0, 3, 1, 2]]
    before_after = np.concatenate([pads[:, 0], pads[:, 1]]).astype(np.int64)
    return graph.node("Pad", graph.weight_after(one.inputs[0], layout, before_after)), layout


def _unary(graph: Conversion, one: _Operation) -> _Value:
    layout = graph.shared_layout(one.inputs)
    return graph.node(_UNARY[one.name], [graph.get(one.inputs[0], layout)]), layout


def _one_over_root(graph: Conversion, one: _Operation) -> _Value:
    layout = graph.shared_layout(one.inputs)
    root = graph.node("Sqrt", [graph.get(one.inputs[0], layout)])
    return graph.node("Reciprocal", [root]), layout


def _binary(graph: Conversion, one: _Operation) -> _Value:
    layout = graph.shared_layout(one.inputs)
    value = graph.node(_BINARY[one.name], [graph.get(i, layout) for i in one.inputs])
    return graph.activated(value, one.options.FusedActivationFunction()), layout


def _squared_difference(graph: Conversion, one: _Operation) -> _Value:
    layout = graph.shared_layout(one.inputs)
    difference = graph.node("Sub", [graph.get(i, layout) for i in one.inputs])
    return graph.node("Mul", [difference, difference]), layout


def _reshaped(graph: Conversion, one: _Operation) -> _Value:
    shape = np.array(graph.shape(one.output), np.int64)
    return graph.node("Reshape", graph.weight_after(one.inputs[0], "source", shape)), "source"


def _transposed(graph: Conversion, one: _Operation) -> _Value:
    axes = [int(i) for i in graph.constants[one.inputs[1]]]
    value, held = graph.values[one.inputs[0]]
    if axes == [0, 1, 3, 2] and held != "nchw":
        return value, "source" if held == "turned" else "turned"
    return graph.node("Transpose", [graph.get(one.inputs[0], "source")], perm=axes), "source"


def _joined(graph: Conversion, one: _Operation) -> _Value:
    return graph.node("Concat", [graph.get(i, "source") for i in one.inputs], axis=one.options.Axis()), "source"


_RULES: dict[str, tuple[Callable[[Conversion, _Operation], _Value], Any]] = {
    "CONV_2D": (_convolved, tflite.Conv2DOptions),
    "DEPTHWISE_CONV_2D": (
        lambda g, o: (g.convolution(o.inputs, o.options, True), "nchw"),
        tflite.DepthwiseConv2DOptions,
    ),
    "PRELU": (lambda g, o: (g.prelu(o.inputs), "nchw"), None),
    "MAX_POOL_2D": (lambda g, o: (g.max_pool(o.inputs, o.options), "nchw"), tflite.Pool2DOptions),
    "PAD": (_padded, None),
    **dict.fromkeys(_UNARY, (_unary, None)),
    "RSQRT": (_one_over_root, None),
    "ADD": (_binary, tflite.AddOptions),
    "SUB": (_binary, tflite.SubOptions),
    "MUL": (_binary, tflite.MulOptions),
    "DIV": (_binary, tflite.DivOptions),
    "SQUARED_DIFFERENCE": (_squared_difference, None),
    "MEAN": (lambda g, o: (g.reduction(o.name, o.inputs, o.options), "source"), tflite.ReducerOptions),
    "SUM": (lambda g, o: (g.reduction(o.name, o.inputs, o.options), "source"), tflite.ReducerOptions),
    "RESHAPE": (_reshaped, None),
    "TRANSPOSE": (_transposed, None),
    "CONCATENATION": (_joined, tflite.ConcatenationOptions),
    "STRIDED_SLICE": (
        lambda g, o: (g.strided_slice(o.inputs, o.output, o.options), "source"),
        tflite.StridedSliceOptions,
    ),
}
"""TFLite operation -> what makes its nodes and tells its output's name and layout, and the kind of its options."""
