"""Commands that make an avatar of a person's pictures: train."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter


def train(
    capture: Path,
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
    preset: str = "tiny",
    steps: int | None = None,
    perceptual: bool = True,
    seed: int = 0,
) -> int:
    """Learn a CNN avatar from a capture (extra: pip install 'gemheads[train]'); the same again goes on.

    Args:
        capture: The folder of a capture.
        out: The run's folder; one that holds the same run is gone on with.
        preset: tiny (minutes on two cores), small (hours), full (a GPU).
        steps: How long. Default: the preset's.
        perceptual: With the VGG term of equation 2, whose weights are fetched once; --no-perceptual without.
        seed: The same seed and capture give the same avatar on a CPU.
    """
    from ..avatartraining import TrainWish, run_avatar_training

    return run_avatar_training(capture, out, TrainWish(preset, steps, perceptual, seed))
