"""Commands from a person's pictures to an avatar: capture, train, refine, and evaluate."""

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from .options import Seed, Size, Whole


def capture(
    out: Path,
    /,
    *,
    subject: str = "ada",
    cameras: Whole = 16,
    size: Size = "550x802",
    split: str = "96+32",
    held_out: Whole | None = None,
    background: str = "white",
    tracking_noise: float = 0.0,
    renderer: Literal["studio", "cycles"] = "studio",
    seed: Seed = 0,
) -> int:
    """Film a synthetic person with many cameras, for train, refine and fit. Stopped, the same command continues.

    Args:
        out: The capture's folder: a new one, or one that holds the same capture, finished or not.
        subject: Who performs.
        cameras: How many, over the front half.
        size: Width x height of each picture.
        split: How many moments to learn from + how many of other expressions to be judged by.
        held_out: Which camera is kept for judging, from 0. Default: the most frontal.
        background: #rrggbb or a name; the masks say where the person is.
        tracking_noise: Millimetres by which the tracked mesh is off, smoothly, as real trackers are.
        renderer: studio, or cycles: Blender's path tracer (pip install bpy), slower and closer to a photograph.
        seed: The same seed gives the same performance.
    """
    from ...models.studio.shoot import Plan
    from ..errors import UsageError
    from ..making.capturing import read_split, run_capturing
    from ..words import read_colour, read_size

    width, height = read_size(size)
    moments, held = read_split(split)
    colour = read_colour(background)
    if colour is None:
        raise UsageError("--background transparent: a picture has a ground; the masks say where the person is")
    plan = Plan(cameras, width, height, moments, held, held_out, colour, tracking_noise / 1000, seed, renderer)
    return run_capturing(out, subject, plan)


def train(
    capture: Path,
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
    model: Literal["cnn", "rigged", "blendshapes"] = "cnn",
    preset: str = "tiny",
    steps: Whole | None = None,
    maps: Whole | None = None,
    perceptual: bool = True,
    seed: Seed = 0,
) -> int:
    """Learn an avatar from a capture (extra: pip install 'gemheads[train]'). Stopped, the same command continues.

    Args:
        capture: The folder of a capture.
        out: The run's folder. If it already holds this run, training continues.
        model: The paper's CNN, or a baseline to judge it by: rigged (static splats that the mesh carries) or
            blendshapes (a mean and an offset for each ARKit shape).
        preset: tiny (minutes on two cores), small (hours), full (a GPU).
        steps: How long. Default: the preset's.
        maps: Texels along a side of the UV map, one splat each: 64, 128, 256 or 512. Default: the preset's.
        perceptual: With the VGG term of equation 2, whose weights are fetched once; --no-perceptual without.
        seed: The same seed and capture give the same avatar on a CPU.
    """
    from ..making.avatartraining import TrainWish, run_avatar_training

    return run_avatar_training(capture, out, TrainWish(preset, steps, perceptual, seed, model, maps))


def refine(
    avatar: str,
    capture: Path,
    /,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    iterations: Whole = 3000,
    coefficients: Literal["free", "fixed"] = "free",
    colors: Literal["free", "fixed"] = "free",
    start: Path | None = None,
    moments: Path | None = None,
    sheet: Path | None = None,
    perceptual: bool = True,
    seed: Seed = 0,
) -> int:
    """Change an avatar's bases until its pictures are those of a capture (extra: pip install 'gemheads[train]').

    Args:
        avatar: Name of an avatar or a .gem file, distilled from this person.
        capture: The folder of a capture.
        out: The .gem to write. Default: the same file, unless it ships or has a regressor, which refining drops. It
            stays as it was where held-out pictures get no better.
        iterations: Steps, each on one picture.
        coefficients: Whether the expressions of the moments are changed, too.
        colors: Whether the colours of the splats are changed, too.
        start: A track with the expressions of the training moments, of `distill --moments` or `fit --split train`.
            Default: what was tracked for an avatar of the bare mesh, else a fit.
        moments: Where to write those expressions as they are after.
        sheet: A PNG of held-out pictures: taken, before, after, and where it still differs.
        perceptual: With the VGG term of equation 2, whose weights are fetched once; --no-perceptual without.
        seed: The same seed, avatar and capture give the same avatar on a CPU.
    """
    from ..library import find_avatar
    from ..making.refining import RefineWish, run_refining

    path = find_avatar(avatar)
    wish = RefineWish(iterations, coefficients, colors, start, moments, sheet, perceptual, seed)
    return run_refining(path, capture, out, wish)


def evaluate(
    avatar: str,
    capture: Path | None = None,
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
    against: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    drivers: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    every: Whole | None = None,
    seconds: float | None = None,
    shots: Whole | None = None,
    everything: Annotated[bool, Parameter(name="--all", negative=())] = False,
    lpips: Literal["vgg", "alex", "none"] | None = None,
    components: Annotated[list[Whole] | None, Parameter(consume_multiple=True, negative=())] = None,
    jobs: Whole | None = None,
) -> int:
    """Judge avatars on pictures nothing was learned from, and driven by people never seen.

    Stopped, the same command continues.

    A held-out camera (val) and held-out expressions (test) of a capture, beside the paper's figures (extra:
    pip install 'gemheads[train]'); with --drivers, how the avatars follow strangers.

    Args:
        avatar: Name of an avatar, a .gem file, or a run of train.
        capture: The folder of a capture. It may be left out with --drivers.
        out: The report's folder: report.html, report.json, and what is not judged again.
        against: More avatars, as further columns on the same pictures.
        drivers: Videos of faces that nothing was learned from: they drive the avatars, and what the avatars then do is
            compared with them.
        every: Take each N-th frame of every driver. Default: 3.
        seconds: Take only the first so many seconds of every driver. Default: 30.
        shots: How many pictures of either kind, evenly over moments and cameras. Default: 24.
        everything: Every picture instead.
        lpips: By which network LPIPS is measured: vgg, alex or none; alex is 20 times faster, vgg, the default, is the
            paper's.
        components: Judge each GEM with so many of its components, too: quality, size of the file, frames a second.
        jobs: How many processes judge, with one thread each; the figures do not depend on it. Default: one for each
            core, if there is memory for them.
    """
    from ..evaluation.evaluating import EvaluateWish, run_evaluating
    from ..evaluation.strangers import CrossingWish
    from ..words import refuse

    if capture is not None and not drivers:
        refuse("a capture alone", every=every, seconds=seconds)
    if capture is None and drivers:
        refuse("drivers alone", shots=shots, all=everything or None, lpips=lpips, jobs=jobs)
    if everything:
        refuse("--all", shots=shots)
    crossing = CrossingWish(
        tuple(drivers or ()),
        CrossingWish.every if every is None else every,
        CrossingWish.seconds if seconds is None else seconds,
    )
    number = EvaluateWish.shots if shots is None else shots
    network = lpips or EvaluateWish.lpips
    wish = EvaluateWish(
        tuple(against or ()), None if everything else number, network, crossing, tuple(components or ()), jobs
    )
    return run_evaluating(avatar, capture, out, wish)
