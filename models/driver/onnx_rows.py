"""How large the numbers of an ONNX graph can become, told before anything of it runs.

Of a kilobyte of harmless operators one can make a bomb: 30 nodes that join a tensor with itself are a thousand million
numbers, and onnxruntime 1.31 takes gigabytes for them, or aborts. In a regressor every value that depends on the inputs
is one row of numbers, [1, n]; so that is asked for, and n and the work are bounded from above.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from math import prod

from .protobuf import fields, message, packed, text

MAX_WIDTH = 2**16
"""Numbers in a row: a regressor has 500."""
MAX_NUMBERS = 2**22
"""Numbers that all rows and what makes them have together: a regressor has 100,000."""
MAX_WORK = 2**25
"""Products of numbers in one run: a regressor has 600,000."""
MAX_WIDENED = 2**22
"""Numbers that are kept in float16 and made float32: a regressor has 600,000."""
ROW_BY_ROW = frozenset("Add Div Identity Max Min Mul Neg Pow Relu Sigmoid Softplus Sqrt Sub Tanh".split())
"""Operators on each number by itself, or on pairs of them."""
_WITH_CONSTANTS = frozenset("Clip Slice".split())
_PRODUCTS = frozenset("MatMul Gemm".split())
OPERATORS = ROW_BY_ROW | _WITH_CONSTANTS | _PRODUCTS | {"Concat", "Cast"}
"""All operators that a graph may have: arithmetic on rows that ends, no loops, no branches."""
_GRAPH_NODE, _GRAPH_INITIALIZER, _GRAPH_INPUT = 1, 5, 11
_NODE_INPUT, _NODE_OUTPUT, _NODE_NAME, _NODE_TYPE, _NODE_ATTRIBUTE = 1, 2, 3, 4, 5
_ATTRIBUTE_NAME, _ATTRIBUTE_INT = 1, 3
_TENSOR_DIMS, _TENSOR_TYPE, _TENSOR_NAME, _VALUE_NAME = 1, 2, 8, 1
_MAX_RANK = 8
_FLOAT, _FLOAT16 = 1, 10
"""Of TensorProto.DataType."""


@dataclass(frozen=True)
class _Node:
    operator: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    numbers: dict[str, int]
    """Attribute -> whole number, where it is one."""


def check_rows(graph: memoryview, input_width: int) -> None:
    """Makes sure that every value is one row of at most MAX_WIDTH numbers, and all products at most MAX_WORK.

    Args:
        graph: the GraphProto, whose fields ``check_fields`` knows.
        input_width: how many numbers the widest input has.

    Raises ValueError saying which node is not so.
    """
    tensors = list(_constants(graph))
    constants = {name: dims for name, dims, _ in tensors}
    halves = {name for name, _, kind in tensors if kind == _FLOAT16}
    if len(constants) < len(tensors):
        raise ValueError("its ONNX graph has two constants of one name")
    inputs = {name for name, _ in _named(graph, _GRAPH_INPUT, _VALUE_NAME)}
    if inputs & set(constants):
        raise ValueError("its ONNX graph has an input that is a constant too")
    widths = dict.fromkeys(inputs, input_width)
    work = widened = numbers = 0
    for node in _nodes(graph):
        where = f"its ONNX graph: {node.operator} of {', '.join(node.inputs)[:60]}"
        rows = [widths[name] for name in node.inputs if name in widths]
        others = [constants[name] for name in node.inputs if name in constants]
        known = len(rows) + len(others) == sum(map(bool, node.inputs)) and (rows or node.operator == "Cast")
        if not known or len(node.outputs) != 1:
            raise ValueError(f"{where} is not one row of what was there before")
        if set(node.outputs) & (set(widths) | set(constants)):
            raise ValueError(f"{where} gives a name that is taken")
        if node.operator == "Cast":
            if rows or len(others) != 1 or node.inputs[0] not in halves or node.numbers.get("to") != _FLOAT:
                raise ValueError(f"{where} is no constant of float16 made float32")
            widened += prod(others[0])
            if widened > MAX_WIDENED:
                raise ValueError(f"{where} is more than a regressor needs: {widened} numbers made float32")
            constants[node.outputs[0]] = others[0]
            continue
        if node.operator in _PRODUCTS:
            width = _product(node, widths, constants, where)
            work += prod(constants[node.inputs[1]])
        elif node.operator == "Concat":
            if others or node.numbers.get("axis") not in (1, -1):
                raise ValueError(f"{where} joins more than rows")
            width = sum(rows)
        else:
            width = _row(node, rows, others, where)
        numbers += width * (1 if node.operator == "Concat" else len(node.inputs))
        if width > MAX_WIDTH or numbers > MAX_NUMBERS or work > MAX_WORK:
            raise ValueError(f"{where} is more than a regressor needs: {width} numbers, {work} products")
        widths[node.outputs[0]] = width


def _row(node: _Node, rows: list[int], others: list[tuple[int, ...]], where: str) -> int:
    """The width of what is done number by number, or with some of the numbers."""
    if any(len(dims) > 2 or (len(dims) == 2 and dims[0] != 1) for dims in others):
        raise ValueError(f"{where} has a constant of more than a row")
    if node.operator in _WITH_CONSTANTS:
        if len(rows) != 1 or any(prod(dims) != 1 for dims in others):
            raise ValueError(f"{where} is by more than single constants")
        return rows[0]
    return max(rows + [prod(dims) for dims in others])


def _product(node: _Node, widths: dict[str, int], constants: dict[str, tuple[int, ...]], where: str) -> int:
    """The width of a row times a constant matrix, and another constant row."""
    first, second, *third = node.inputs if len(node.inputs) > 1 else ("", "")
    rest = [dims for name in third if name for dims in [constants.get(name, ())] if prod(dims[:-1]) != 1]
    if first not in widths or len(constants.get(second, ())) != 2 or rest or any(name in widths for name in third):
        raise ValueError(f"{where} is no row times a constant matrix")
    if node.numbers.get("transA"):
        raise ValueError(f"{where} makes a column of a row")
    return max(constants[second])


def _constants(graph: memoryview) -> Iterator[tuple[str, tuple[int, ...], int]]:
    """Name, dimensions and type of every initialiser."""
    for name, tensor in _named(graph, _GRAPH_INITIALIZER, _TENSOR_NAME):
        dims = tuple(islice(_integers(tensor, _TENSOR_DIMS), _MAX_RANK + 1))
        if len(dims) > _MAX_RANK or min(dims, default=0) < 0 or prod(dims) > len(tensor):
            raise ValueError("its ONNX graph has a constant that claims more numbers than are in it")
        yield name, dims, next(_integers(tensor, _TENSOR_TYPE), 0)


def _nodes(graph: memoryview) -> Iterator[_Node]:
    for _, node in _named(graph, _GRAPH_NODE, _NODE_NAME):
        (operator,) = _texts(node, _NODE_TYPE) or [""]
        if operator not in OPERATORS:
            raise ValueError(f"its ONNX graph uses the operator {operator[:40]!r}, which is not allowed")
        attributes = list(_named(node, _NODE_ATTRIBUTE, _ATTRIBUTE_NAME))
        if len(dict(attributes)) < len(attributes):
            raise ValueError(f"its ONNX graph has an attribute of {operator} twice")
        numbers = {name: whole for name, attribute in attributes for whole in _integers(attribute, _ATTRIBUTE_INT)}
        yield _Node(operator, tuple(_texts(node, _NODE_INPUT)), tuple(_texts(node, _NODE_OUTPUT)), numbers)


def _named(content: memoryview, kind: int, name: int) -> Iterator[tuple[str, memoryview]]:
    """Every message in the field ``kind`` with its name, which is in the field ``name``."""
    for number, _, value in fields(content):
        if number == kind:
            inner = message(value)
            yield (_texts(inner, name) or [""])[-1], inner


def _texts(content: memoryview, field: int) -> list[str]:
    return [text(value) for number, _, value in fields(content) if number == field]


def _integers(content: memoryview, field: int) -> Iterator[int]:
    """The int64s of a field, one by one or packed."""
    for number, _, value in fields(content):
        if number == field:
            numbers = [value] if isinstance(value, int) else packed(value)
            yield from (whole - 2**64 if whole >= 2**63 else whole for whole in numbers)
