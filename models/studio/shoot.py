"""A performance in the studio, written as a capture; what is already drawn is not drawn again."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ...render.camera import Camera
from ..captures.layout import Shot
from ..captures.writer import CaptureWriter
from .acting import perform
from .blender import require_blender
from .cycles import CyclesPainter
from .drawing import Painter
from .moment import Act, Moment, Stage
from .rig import frontal, rig
from .subject import Subject
from .tracking import TrackingNoise

Progress = Callable[[str, int, int], None]
Renderer = Literal["studio", "cycles"]
"""Who draws: ``drawing.Painter``, or Blender's path tracer where it is installed."""


class Draws(Protocol):
    """What both renderers do."""

    stage: Stage

    def draw(self, moment: Moment, camera: Camera) -> NDArray[np.float32]:
        """sRGB-encoded premultiplied RGBA [H, W, 4] in 0..1."""
        ...


@dataclass(frozen=True)
class Plan:
    """What shall be captured."""

    cameras: int = 16
    width: int = 550
    height: int = 802
    train: int = 96
    """Moments to learn from."""
    test: int = 32
    """Moments of expressions held out."""
    held_out: int | None = None
    """The camera of val; None takes the one that sees the face from the front."""
    background: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """sRGB in 0..1."""
    tracking_noise_m: float = 0.0
    """Root mean square of the tracked vertices' error, metres."""
    seed: int = 0
    renderer: Renderer = "studio"


@dataclass(frozen=True)
class Shooting:
    """What came of it."""

    drawn: int
    """Pictures that were drawn now; the others were there."""
    pictures: int


def shoot(subject: Subject, plan: Plan, writer: CaptureWriter, progress: Progress) -> Shooting:
    """Draw every picture of a plan that is not there yet, then write the lists that make the folder a capture.

    Raises OSError where the folder cannot be written, BlenderError where the renderer is not there.
    """
    writer.begin(subject.template)
    cameras = rig(plan.cameras, plan.width, plan.height, subject.viewing)
    held_out = frontal(cameras) if plan.held_out is None else plan.held_out
    acts = [*perform("train", plan.train, plan.seed), *perform("test", plan.test, plan.seed)]
    painter = _painter(plan.renderer, Stage(subject))
    noise = TrackingNoise(plan.tracking_noise_m, plan.seed) if plan.tracking_noise_m > 0 else None
    shots: dict[str, list[Shot]] = {"train": [], "val": [], "test": []}
    total, done, drawn = len(acts) * len(cameras), 0, 0
    progress("pictures", 0, total)
    for timestep, act in enumerate(acts):
        row = [writer.shot(timestep, index, camera) for index, camera in enumerate(cameras)]
        lacking = [shot for shot in row if not writer.is_drawn(shot)]
        done += len(row) - len(lacking)
        _write_mesh(painter.stage, writer, timestep, act, noise)
        if lacking:
            moment = painter.stage.moment(act)
            for shot in lacking:
                rgb, alpha = over(painter.draw(moment, shot.camera), plan.background)
                writer.write_picture(shot, rgb, alpha)
                done, drawn = done + 1, drawn + 1
                progress("pictures", done, total)
        for shot in row:
            test = timestep >= plan.train
            shots["test" if test else "val" if shot.camera_index == held_out else "train"].append(shot)
    view = subject.viewing
    about = {
        "subject": subject.name,
        "background": list(plan.background),
        "viewing": {"target": list(view.target), "head_height": view.head_height},
    }
    writer.finish(shots, about)
    return Shooting(drawn, total)


def require_renderer(renderer: Renderer) -> None:
    """Raises BlenderError where the renderer is not installed."""
    if renderer == "cycles":
        require_blender()


def _painter(renderer: Renderer, stage: Stage) -> Draws:
    return CyclesPainter(stage) if renderer == "cycles" else Painter(stage)


def _write_mesh(stage: Stage, writer: CaptureWriter, timestep: int, act: Act, noise: TrackingNoise | None) -> None:
    truth = stage.vertices(act)[: stage.subject.tracked]
    seen = truth
    if noise is not None:
        seen = truth + noise.at(stage.subject.template.vertices, timestep)
    writer.write_mesh(timestep, seen, act.rotation, act.translation, act.arkit, truth)


def over(
    image: NDArray[np.float32], background: tuple[float, float, float]
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Picture [H, W, 3] over its background, and mask [H, W], of premultiplied RGBA [H, W, 4]."""
    alpha = image[..., 3:]
    rgb = image[..., :3] + (1 - alpha) * np.array(background, np.float32)
    return _bytes(rgb), _bytes(alpha[..., 0])


def _bytes(values: NDArray[np.floating]) -> NDArray[np.uint8]:
    return np.round(255 * np.clip(values, 0, 1)).astype(np.uint8)
