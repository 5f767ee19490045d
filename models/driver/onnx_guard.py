"""Looking through an ONNX graph of unknown origin before onnxruntime reads it; field numbers as in onnx.proto."""

from .onnx_fields import check_fields
from .onnx_rows import check_rows
from .protobuf import fields, message, text

_MAX_NODES = 512
_MODEL_GRAPH, _GRAPH_NODE, _NODE_DOMAIN = 7, 1, 7


def check_graph(model: bytes, input_width: int) -> None:
    """Makes sure that a model is one graph of at most 512 allowed operators with all its data inside, that nothing in
    it can be read in two ways, and that all it computes are rows of bounded width; the widest input has
    ``input_width`` numbers.

    Raises ValueError saying what is not so.
    """
    check_fields(model)
    graphs = [message(value) for number, _, value in fields(model) if number == _MODEL_GRAPH]
    if len(graphs) != 1:
        raise ValueError(f"it holds {len(graphs)} ONNX graphs instead of one")
    nodes = [message(value) for number, _, value in fields(graphs[0]) if number == _GRAPH_NODE]
    if not 0 < len(nodes) <= _MAX_NODES:
        raise ValueError(f"its ONNX graph has {len(nodes)} nodes, 1 to {_MAX_NODES} are allowed")
    for node in nodes:
        _check_node(node)
    check_rows(graphs[0], input_width)


def _check_node(node: memoryview) -> None:
    for number, _, value in fields(node):
        if number == _NODE_DOMAIN and text(value) not in ("", "ai.onnx"):
            raise ValueError(f"its ONNX graph uses an operator of the domain {text(value)[:40]!r}")
