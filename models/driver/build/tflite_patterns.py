"""What TFLite spells in several operations and an ONNX graph does sooner in others, without another result."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import tflite
from numpy.typing import NDArray

from .tflite_operation import ends, options_of

if TYPE_CHECKING:
    from .tflite_to_onnx import Conversion

BOTTLENECK = ("CONV_2D", "PRELU", "DEPTHWISE_CONV_2D", "CONV_2D")
_HALF_A_BLOCK = 8
"""onnxruntime keeps channels in blocks of 16 where processors have vectors of 512 bits: twice as many as so few cost
nothing."""
LAYER_NORM = ("MEAN", "NEG", "SQUARED_DIFFERENCE", "MEAN", "ADD", "RSQRT", "MUL", "MUL", "MUL", "ADD")
"""How TFLite spells x / sqrt(variance + epsilon) * gain, less the mean times the same."""


def layer_norm(graph: "Conversion", operations: Sequence[Any]) -> bool:
    """Adds one LayerNormalization for ``operations`` where they are one; False, and nothing is added, where not."""
    if tuple(graph.name_of(operation) for operation in operations) != LAYER_NORM:
        return False
    inputs, outputs = zip(*(ends(operation) for operation in operations), strict=True)
    (value, axes), epsilon, gain = inputs[0], inputs[4][1], inputs[6][1]
    mean, minus, squares, variance, padded, root, scaled, larger, offset, _ = outputs
    wired = ([value, axes], [mean], [value, mean], [squares, axes], [variance, epsilon], [padded], [root, gain],
             [value, scaled], [minus, scaled], [larger, offset])  # fmt: skip
    if inputs != wired or (graph.constants[axes] % len(graph.shape(value))).tolist() != [len(graph.shape(value)) - 1]:
        return False
    arguments = graph.weight_after(value, "source", graph.constants[gain])
    spare = float(graph.constants[epsilon].item())
    graph.values[outputs[-1]] = (graph.node("LayerNormalization", arguments, axis=-1, epsilon=spare), "source")
    return True


def bottleneck(graph: "Conversion", operations: Sequence[Any]) -> bool:
    """Adds three convolutions for a narrow one, PReLU, a depthwise and a wide one; False, and nothing is added,
    where ``operations`` are not these.

    The narrow one gives Relu(x) and Relu(-x), of which PReLU is the first less a times the second; the depthwise
    one treats both alike, and the wide one adds them up. Three passes over the picture less.
    """
    if tuple(graph.name_of(operation) for operation in operations) != BOTTLENECK:
        return False
    parts = [ends(operation) for operation in operations]
    (narrow, slope, depthwise, wide), outputs = (list(part) for part in zip(*parts, strict=True))
    weights, bias = (graph.constants[tensor] for tensor in narrow[1:])
    wired = all(one[0] == before for one, before in zip((slope, depthwise, wide), outputs, strict=False))
    alone = all(graph.uses[tensor] == 1 for tensor in outputs[:3])
    plain = all(_is_pointwise(operations[place], graph.constants[parts[place][0][1]]) for place in (0, 3))
    if not wired or not alone or not plain or len(weights) > _HALF_A_BLOCK:
        return False
    steps = graph.constants[slope[1]].reshape(-1).astype(np.float32)
    signs = np.repeat(np.array([1, -1], np.float32), len(steps))
    value = graph.conv(
        graph.get(narrow[0], "nchw"),
        np.concatenate([weights, -weights]).transpose(0, 3, 1, 2),
        signs * np.tile(bias, 2),
    )
    kernel, offset = (graph.constants[tensor] for tensor in depthwise[1:])
    options = options_of(operations[2], tflite.DepthwiseConv2DOptions)
    if options.FusedActivationFunction() != tflite.ActivationFunctionType.NONE:
        raise NotImplementedError("a depthwise convolution with an activation between a narrow and a wide one")
    value = graph.conv(
        graph.node("Relu", [value]),
        np.tile(kernel, 2).transpose(3, 0, 1, 2),
        np.concatenate([offset, 0 * offset]),
        strides=[options.StrideH(), options.StrideW()],
        pads=graph.padding(options.Padding(), graph.shape(depthwise[0])[1:3], kernel.shape[1:3], options),
        group=2 * len(steps),
    )
    last, end = (graph.constants[tensor] for tensor in wide[1:])
    both = np.concatenate([last, -steps * last], 3)
    graph.values[outputs[3]] = (graph.conv(value, both.transpose(0, 3, 1, 2), end), "nchw")
    return True


def _is_pointwise(operation: Any, weights: NDArray[Any]) -> bool:
    """Whether a convolution is 1x1, of every place, and nothing follows in it."""
    options = options_of(operation, tflite.Conv2DOptions)
    once = (options.StrideH(), options.StrideW()) == (1, 1) and weights.shape[1:3] == (1, 1)
    return once and options.FusedActivationFunction() == tflite.ActivationFunctionType.NONE
