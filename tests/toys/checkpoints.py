"""Whether two runs came to the same."""

from collections.abc import Iterator
from pathlib import Path

import torch
from gemheads.models.train.avatars.runs import read_checkpoint


def flat(value: object) -> Iterator[tuple[str, torch.Tensor]]:
    """Every tensor of a checkpoint, and every number as one."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from ((f"{key}.{name}", tensor) for name, tensor in flat(inner))
    elif isinstance(value, list):
        yield from flat(dict(enumerate(value)))
    elif isinstance(value, torch.Tensor | int | float):
        yield "", torch.as_tensor(value)


def assert_identical(first: Path, second: Path) -> None:
    """Bit for bit, weights and the optimiser's state and the losses."""
    one, two = (dict(flat(read_checkpoint(folder))) for folder in (first, second))
    assert one.keys() == two.keys()
    assert len(one) > 20
    for name, tensor in one.items():
        assert torch.equal(tensor, two[name]), name
