"""What an operation of a TFLite graph is made of."""

from typing import Any


def ends(operation: Any) -> tuple[list[int], int]:
    """The tensors that go into an operation, and the one that comes out."""
    return [int(i) for i in operation.InputsAsNumpy()], int(operation.OutputsAsNumpy()[0])


def options_of(operation: Any, kind: Any) -> Any:
    """An operation's options, which are of this kind."""
    read = kind()
    read.Init(operation.BuiltinOptions().Bytes, operation.BuiltinOptions().Pos)
    return read
