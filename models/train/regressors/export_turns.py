"""Writes how an avatar's head turns into its regressor's graph, beside what that answers already."""

from collections.abc import Sequence

import numpy as np
import onnx
from onnx import TensorProto, helper

from ...driver.regressor import OUTPUT, ROTATION_INPUT, TURN_OUTPUT, RegressorError
from .export_onnx import TO_COEFFICIENTS
from .onnx_graph import ENDS, Graph, written
from .pose_response import MOST, TIMES, UNIT, PoseResponse
from .response import TYPICAL


def with_turns(regressor: bytes, poses: Sequence[PoseResponse]) -> bytes:
    """A regressor's ONNX graph with the output ``head_turn`` [1, 3], radians, in the place of the one that it may have:
    the rotation that is read on the driver, less the mean of what ``poses`` say is read beyond it on the avatar.

    Raises RegressorError for a graph that export_onnx did not write.
    """
    model = onnx.load_from_string(regressor)
    graph = Graph.up_to(OUTPUT, model)
    answers = [node.input[0] for node in graph.nodes if node.op_type == "MatMul" and TO_COEFFICIENTS in node.input]
    if len(answers) != 1:
        raise RegressorError(
            "the avatar's regressor is not one that train-regressor wrote, so it cannot learn how its head turns;"
            " train it without --turns-only"
        )
    each = [_added(graph, answers[0], f"pose_{number}_", pose) for number, pose in enumerate(poses)]
    graph.nodes.append(
        helper.make_node("Sub", [ROTATION_INPUT, graph.mean(each, "poses_share")], [TURN_OUTPUT], name=TURN_OUTPUT)
    )
    outputs = [output for output in model.graph.output if output.name == OUTPUT]
    outputs.append(helper.make_tensor_value_info(TURN_OUTPUT, TensorProto.FLOAT, [1, 3]))
    for field, values in (("node", graph.nodes), ("initializer", graph.constants), ("output", outputs)):
        model.graph.ClearField(field)
        getattr(model.graph, field).extend(values)
    return written(model)


def _added(graph: Graph, weights: str, prefix: str, pose: PoseResponse) -> str:
    """What the avatar adds to the turn with which the driver's rotation is read on it, see PoseResponse.turn."""
    learned = {name: tensor.detach().cpu().numpy() for name, tensor in pose.state_dict().items()}
    own = {name: graph.learned(f"{prefix}{name}", learned[name]) for name, _ in pose.named_parameters()}
    farthest = [graph.constant(f"pose_{end}", sign * learned["farthest"]) for end, sign in ENDS]
    most = [graph.constant(f"misread_{end}", np.float32(sign * MOST)) for end, sign in ENDS]
    straight = graph.node("Gemm", weights, own["linear.weight"], transB=1)
    expression = graph.node("Gemm", weights, own["expression.weight"], transB=1)

    def bent(hidden: str) -> str:
        for layer in (1, 3):
            shared = graph.node("Mul", hidden, graph.node("Sigmoid", hidden))
            hidden = graph.node("Gemm", shared, own[f"bend.{layer}.weight"], own[f"bend.{layer}.bias"], transB=1)
        return hidden

    def turned_by(asked: str) -> str:
        wide = graph.node("Div", graph.clipped(asked, *farthest), graph.constant("typical", np.float32(TYPICAL)))
        return graph.node("Gemm", wide, own["rotation.weight"], own["rotation.bias"], transB=1)

    ahead = graph.node("Mul", ROTATION_INPUT, graph.constant("ahead", np.float32(0)))
    not_left = graph.node("Mul", bent(turned_by(ahead)), graph.constant("pose_not_left", 1 - learned["left"]))

    def added_at(asked: str) -> str:
        turned = turned_by(asked)
        left = graph.node("Mul", bent(turned), graph.constant("pose_left", learned["left"]))
        beyond = graph.node("Sub", bent(graph.node("Add", turned, expression)), graph.node("Add", left, not_left))
        added = graph.node("Mul", graph.node("Add", straight, beyond), graph.constant("misread_unit", np.float32(UNIT)))
        return graph.clipped(added, *most)

    added = added_at(ROTATION_INPUT)
    for _ in range(TIMES - 1):
        added = added_at(graph.node("Sub", ROTATION_INPUT, added))
    return added
