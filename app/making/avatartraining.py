"""``gemheads train``: a capture becomes a run, the avatar that `distill` makes a .gem of."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from ...models.captures.layout import CaptureError
from ..errors import ExitCode, InputError, TrainingExtra, UsageError, cannot_write
from ..progress import ProgressBar
from .opencapture import opened

if TYPE_CHECKING:
    from ...models.train.avatars.plan import Model, Plan
    from ...models.train.avatars.train_avatar import Outcome
    from ...models.train.perceptual import Perceptual

MAPS = (64, 128, 256, 512)
LEAST_STEPS, MOST_STEPS = 1, 10_000_000


@dataclass(frozen=True)
class TrainWish:
    """What the command line asks for."""

    preset: str = "tiny"
    steps: int | None = None
    """None takes the preset's."""
    perceptual: bool = True
    seed: int = 0
    model: "Model" = "cnn"
    maps: int | None = None
    """Texels along a side of the UV map; None takes the preset's."""


def run_avatar_training(capture: Path, out: Path, wish: TrainWish) -> ExitCode:
    """Train, or go on; then say how good it is. Raises CommandError; stopped with Ctrl-C it can go on later."""
    with TrainingExtra("training"):
        from ...models.train.avatars.runs import RunError
        from ...models.train.avatars.train_avatar import train_avatar
    plan = _planned(wish)
    if out.is_file():
        raise UsageError(f"{out}: is a file; name a folder for the run")
    footage = opened(capture)
    try:
        with ProgressBar() as bar:
            outcome = train_avatar(footage, out, plan, _perceptual(plan), progress=bar.reach)
    except (CaptureError, RunError) as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise cannot_write(out, error) from error
    print(_told(out, plan, outcome))
    return ExitCode.OK


def _planned(wish: TrainWish) -> "Plan":
    from ...models.train.avatars.plan import PRESETS

    if wish.preset not in PRESETS:
        raise UsageError(f"--preset {wish.preset}: choose from {', '.join(PRESETS)}")
    if wish.steps is not None and not LEAST_STEPS <= wish.steps <= MOST_STEPS:
        raise UsageError(f"--steps {wish.steps}: choose from {LEAST_STEPS} to {MOST_STEPS}")
    if wish.maps is not None and wish.maps not in MAPS:
        raise UsageError(f"--maps {wish.maps}: choose from {', '.join(map(str, MAPS))}")
    return PRESETS[wish.preset].changed(wish.steps, wish.perceptual, wish.seed, wish.model, wish.maps)


def _perceptual(plan: "Plan") -> "Perceptual | None":
    """The network of the VGG term, fetched once. Raises InputError where it cannot be had."""
    if not plan.perceptual:
        return None
    from ...models.train.avatars.runs import default_device
    from ...models.train.perceptual import Perceptual, WeightsMissing

    try:
        return Perceptual("vgg", default_device())
    except WeightsMissing as error:
        raise InputError(f"{error}; --no-perceptual trains without the VGG term") from error


def _told(out: Path, plan: "Plan", outcome: "Outcome") -> str:
    lines = [f"{out}: trained for {outcome.steps} steps, loss {outcome.loss:.4f}, {outcome.seconds:.0f} s"]
    known = {"the held-out camera": outcome.val_psnr, "held-out expressions": outcome.test_psnr}
    if quality := [f"{value:.1f} dB on {what}" for what, value in known.items() if isfinite(value)]:
        lines.append(", ".join(quality))
    if not plan.perceptual:
        lines.append("without the VGG term: it will look softer")
    if outcome.skipped:
        lines.append(f"{outcome.skipped} steps were not finite and were skipped")
    if outcome.restored:
        lines.append(f"taken back to its last checkpoint {outcome.restored} times: it had left what it had learned")
    lines.append(f"look at {out / 'previews'} and {out / 'loss.png'}; then: gemheads distill {out} -o NAME.gem")
    return "\n".join(lines)
