"""Looking through an ONNX graph of unknown origin before onnxruntime reads it; field numbers as in onnx.proto."""

from .onnx_rows import OPERATORS, check_rows
from .protobuf import fields, message, text

ALLOWED_OPERATORS = OPERATORS
"""Arithmetic on rows that ends: no loops, no branches, no operators of foreign domains."""
_MAX_NODES = 512
_MODEL_GRAPH, _MODEL_FUNCTIONS = 7, 25
_GRAPH_NODE, _GRAPH_INITIALIZER, _GRAPH_SPARSE = 1, 5, 15
_NODE_TYPE, _NODE_ATTRIBUTE, _NODE_DOMAIN = 4, 5, 7
_ATTRIBUTE_TENSOR, _ATTRIBUTE_GRAPH, _ATTRIBUTE_TENSORS, _ATTRIBUTE_GRAPHS = 5, 6, 10, 11
_ATTRIBUTE_SPARSE, _ATTRIBUTE_SPARSES = 22, 23
_TENSOR_EXTERNAL, _TENSOR_LOCATION = 13, 14


def check_graph(model: bytes, input_width: int) -> None:
    """Makes sure that a model is one graph of at most 512 allowed operators with all its data inside, and that all it
    computes are rows of bounded width; the widest input has ``input_width`` numbers.

    Raises ValueError saying what is not so.
    """
    graphs = 0
    for number, value in fields(model):
        if number == _MODEL_FUNCTIONS:
            raise ValueError("its ONNX graph defines functions of its own")
        if number == _MODEL_GRAPH:
            graphs += 1
            _check_contents(message(value))
            check_rows(message(value), input_width)
    if graphs != 1:
        raise ValueError(f"it holds {graphs} ONNX graphs instead of one")


def _check_contents(graph: memoryview) -> None:
    nodes = 0
    for number, value in fields(graph):
        if number == _GRAPH_NODE:
            nodes += 1
            _check_node(message(value))
        elif number == _GRAPH_INITIALIZER:
            _check_tensor(message(value))
        elif number == _GRAPH_SPARSE:
            raise ValueError("its ONNX graph has sparse tensors")
    if not 0 < nodes <= _MAX_NODES:
        raise ValueError(f"its ONNX graph has {nodes} nodes, 1 to {_MAX_NODES} are allowed")


def _check_node(node: memoryview) -> None:
    for number, value in fields(node):
        if number == _NODE_TYPE and text(value) not in ALLOWED_OPERATORS:
            raise ValueError(f"its ONNX graph uses the operator {text(value)[:40]!r}, which is not allowed")
        if number == _NODE_DOMAIN and text(value) not in ("", "ai.onnx"):
            raise ValueError(f"its ONNX graph uses an operator of the domain {text(value)[:40]!r}")
        if number == _NODE_ATTRIBUTE:
            for inner, content in fields(message(value)):
                if inner in (_ATTRIBUTE_GRAPH, _ATTRIBUTE_GRAPHS):
                    raise ValueError("its ONNX graph holds graphs inside operators")
                if inner in (_ATTRIBUTE_SPARSE, _ATTRIBUTE_SPARSES):
                    raise ValueError("its ONNX graph has sparse tensors")
                if inner in (_ATTRIBUTE_TENSOR, _ATTRIBUTE_TENSORS):
                    _check_tensor(message(content))


def _check_tensor(tensor: memoryview) -> None:
    for number, value in fields(tensor):
        if number == _TENSOR_EXTERNAL or (number == _TENSOR_LOCATION and value != 0):
            raise ValueError("its ONNX graph keeps data outside of itself")
