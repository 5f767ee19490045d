"""Writes a RegressorNetwork as one self-contained ONNX graph, by hand: the same bytes from the same weights."""

import numpy as np
import onnx
from numpy.typing import ArrayLike
from onnx import TensorProto, helper, numpy_helper

from ..driver.features import FEATURE_VERSION, SCORES
from ..driver.regressor import VERSION_KEY
from .network import KAPPA_LIMIT, RegressorNetwork

OPSET = 17
INPUTS = ("relative_features", "head_rotation")
OUTPUT = "coefficients"


def export_onnx(network: RegressorNetwork) -> bytes:
    """The graph: float32 ``relative_features`` [1, D] and ``head_rotation`` [1, 3] (radians) in, ``coefficients``
    [1, coefficients] out, already inside +-3 sigma. Operators: Sub MatMul Min Max Slice Concat Gemm Relu Tanh
    Mul Add Div."""
    nodes: list[onnx.NodeProto] = []
    constants: list[onnx.TensorProto] = []
    tensors = {name: tensor.detach().cpu().numpy() for name, tensor in network.state_dict().items()}

    def constant(name: str, array: ArrayLike) -> str:
        constants.append(numpy_helper.from_array(np.asarray(array, np.float32), name))
        return name

    def place(name: str, index: int) -> str:
        constants.append(numpy_helper.from_array(np.array([index], np.int64), name))
        return name

    def node(operator: str, *inputs: str, **attributes: int) -> str:
        output = f"{operator.lower()}_{len(nodes)}"
        made = helper.make_node(operator, list(inputs), [output], name=output)
        made.attribute.extend(helper.make_attribute(name, value) for name, value in attributes.items())
        nodes.append(made)
        return output

    def clipped(value: str, lower: str, upper: str) -> str:
        return node("Min", node("Max", value, lower), upper)

    features, rotation = INPUTS
    lower, upper = constant("lower", tensors["lower"]), constant("upper", tensors["upper"])
    centred = node("Sub", features, constant("feature_mean", tensors["feature_mean"]))
    kappa = node("MatMul", centred, constant("projection", tensors["projection"]))
    bound = np.float32(KAPPA_LIMIT)
    kappa = clipped(kappa, constant("kappa_lower", -bound), constant("kappa_upper", bound))
    scores = node("Slice", features, place("first", SCORES.start), place("behind", SCORES.stop), place("axis", 1))
    start = clipped(node("MatMul", scores, constant("start", tensors["start"])), lower, upper)
    hidden = node("Concat", kappa, rotation, start, axis=1)
    indices = sorted({int(name.split(".")[1]) for name in tensors if name.startswith("layers.")})
    for position, index in enumerate(indices):
        weight = constant(f"weight_{position}", tensors[f"layers.{index}.weight"])
        bias = constant(f"bias_{position}", tensors[f"layers.{index}.bias"])
        hidden = node("Gemm", hidden, weight, bias, transB=1)
        if index != indices[-1]:
            hidden = node("Relu", hidden)
    moved = node("Mul", node("Tanh", hidden), constant("reach", tensors["reach"]))
    weights = clipped(node("Add", start, moved), lower, upper)
    offset = node("MatMul", weights, constant("to_coefficients", tensors["to_coefficients"]))
    free = node("Add", offset, constant("rest", tensors["rest"]))
    limit = constant("limit", tensors["limit"])
    squashed = node("Tanh", node("Div", free, limit))
    nodes.append(helper.make_node("Mul", [squashed, limit], [OUTPUT], name=OUTPUT))
    graph = helper.make_graph(
        nodes,
        "regressor",
        [
            helper.make_tensor_value_info(features, TensorProto.FLOAT, [1, len(tensors["feature_mean"])]),
            helper.make_tensor_value_info(rotation, TensorProto.FLOAT, [1, 3]),
        ],
        [helper.make_tensor_value_info(OUTPUT, TensorProto.FLOAT, [1, len(tensors["rest"])])],
        constants,
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], producer_name="gemheads")
    model.ir_version = 8
    helper.set_model_props(model, {VERSION_KEY: str(FEATURE_VERSION)})
    onnx.checker.check_model(model)
    return model.SerializeToString(deterministic=True)
