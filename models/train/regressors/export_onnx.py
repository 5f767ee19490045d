"""Writes RegressorNetworks as one self-contained ONNX graph, by hand: the same bytes from the same weights."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from onnx import TensorProto, helper

from ...driver.features import DIMENSION, FEATURE_VERSION, SCORES
from ...driver.regressor import FEATURES_INPUT, OUTPUT, ROTATION_INPUT, VERSION_KEY
from .leaks import FACTORS
from .network import FACING, KAPPA_LIMIT, TURN_LIMIT, RegressorNetwork
from .onnx_graph import ENDS, Graph, written
from .response import TYPICAL

OPSET = 17
TO_COEFFICIENTS = "to_coefficients"
"""The constant with which the control weights are multiplied; as it is called in the graph."""
SHARED = ("lower", "upper", "rest", "to_coefficients", "limit", "straight", "least")
"""Buffers that are the avatar's: the same in all its networks."""


def export_onnx(members: Sequence[RegressorNetwork]) -> bytes:
    """The graph: float32 ``relative_features`` [1, D] and ``head_rotation`` [1, 3] (radians) in, ``coefficients``
    [1, coefficients] out, already inside +-3 sigma. Operators: Cast Sub MatMul Min Max Slice Concat Gemm Relu Tanh Mul
    Add Div.

    Args:
        members: networks for the same avatar; the mean of the control weights that they answer counts. What they
            learned is kept in float16.
    """
    graph = Graph()
    features, rotation = FEATURES_INPUT, ROTATION_INPUT
    shared = {name: getattr(members[0], name).cpu().numpy() for name in SHARED}
    heeded = graph.node("Max", features, graph.constant("least", shared["least"]))
    turn = _turn(graph, rotation)
    answers = [
        _answer(graph, heeded, turn, f"member_{number}_", member, shared) for number, member in enumerate(members)
    ]
    weights = graph.mean(answers, "share")
    offset = graph.node("MatMul", weights, graph.constant(TO_COEFFICIENTS, shared["to_coefficients"]))
    free = graph.node("Add", offset, graph.constant("rest", shared["rest"]))
    limit = graph.constant("limit", shared["limit"])
    squashed = _squashed(graph, graph.node("Div", free, limit), shared["straight"])
    graph.nodes.append(helper.make_node("Mul", [squashed, limit], [OUTPUT], name=OUTPUT))
    made = helper.make_graph(
        graph.nodes,
        "regressor",
        [
            helper.make_tensor_value_info(features, TensorProto.FLOAT, [1, DIMENSION]),
            helper.make_tensor_value_info(rotation, TensorProto.FLOAT, [1, 3]),
        ],
        [helper.make_tensor_value_info(OUTPUT, TensorProto.FLOAT, [1, len(shared["rest"])])],
        graph.constants,
    )
    model = helper.make_model(made, opset_imports=[helper.make_opsetid("", OPSET)], producer_name="gemheads")
    model.ir_version = 8
    helper.set_model_props(model, {VERSION_KEY: str(FEATURE_VERSION)})
    return written(model)


def _squashed(graph: Graph, free: str, straight: NDArray[np.float32]) -> str:
    """Within 1, and as it is within ``straight`` (see Controls.coefficients)."""
    left = graph.constant("bent_share", 1 - straight)
    core = graph.clipped(free, graph.constant("straight_lower", -straight), graph.constant("straight_upper", straight))
    bent = graph.node("Tanh", graph.node("Div", graph.node("Sub", free, core), left))
    return graph.node("Add", core, graph.node("Mul", bent, left))


def _turn(graph: Graph, rotation: str) -> str:
    """How all networks read the head's rotation, see RegressorNetwork.turn."""
    facing, wide = (
        graph.node("Div", rotation, graph.constant(name, np.float32(unit)))
        for name, unit in (("facing", FACING), ("typical", TYPICAL))
    )
    factors = [graph.node("MatMul", wide, graph.constant(f"factor_{i}", factor)) for i, factor in enumerate(FACTORS)]
    terms = graph.node("Concat", wide, graph.node("Mul", *factors), axis=1)
    parts = [
        graph.clipped(part, *(graph.constant(f"{name}_{end}", np.float32(sign * bound)) for end, sign in ENDS))
        for part, name, bound in ((facing, "facing", 1.0), (terms, "turn", TURN_LIMIT))
    ]
    return graph.node("Concat", *parts, axis=1)


def _answer(
    graph: Graph,
    features: str,
    turn: str,
    prefix: str,
    member: RegressorNetwork,
    shared: Mapping[str, NDArray[np.float32]],
) -> str:
    """The control weights [1, E] that one network answers to ``features`` of a head with this ``turn``; what all have
    in common is ``shared``."""
    own = {name: tensor.detach().cpu().numpy() for name, tensor in member.state_dict().items()}
    if any((own[name] != array).any() for name, array in shared.items()):
        raise ValueError("these networks are for different avatars")
    lower, upper = graph.constant("lower", shared["lower"]), graph.constant("upper", shared["upper"])
    centred = graph.node("Sub", features, graph.constant(f"{prefix}feature_mean", own["feature_mean"]))
    kappa = graph.node("MatMul", centred, graph.learned(f"{prefix}projection", own["projection"]))
    bound = np.float32(KAPPA_LIMIT)
    kappa = graph.clipped(kappa, graph.constant("kappa_lower", -bound), graph.constant("kappa_upper", bound))
    first, behind, axis = (np.array([place], np.int64) for place in (SCORES.start, SCORES.stop, 1))
    ends = (graph.constant("first", first), graph.constant("behind", behind), graph.constant("axis", axis))
    scores = graph.node("Slice", features, *ends)
    start = graph.node("MatMul", scores, graph.constant(f"{prefix}start", own["start"]))
    start = graph.clipped(start, lower, upper)
    hidden = graph.node("Concat", kappa, turn, start, axis=1)
    indices = sorted({int(name.split(".")[1]) for name in own if name.startswith("layers.")})
    for position, index in enumerate(indices):
        rows = own["leaders"] if index == indices[-1] else slice(None)
        weight = graph.learned(f"{prefix}weight_{position}", own[f"layers.{index}.weight"][rows])
        bias = graph.learned(f"{prefix}bias_{position}", own[f"layers.{index}.bias"][rows])
        hidden = graph.node("Gemm", hidden, weight, bias, transB=1)
        if index != indices[-1]:
            hidden = graph.node("Relu", hidden)
    moved = graph.node("Mul", graph.node("Tanh", hidden), graph.constant(f"{prefix}reach", own["reach"]))
    return graph.clipped(graph.node("Add", start, moved), lower, upper)
