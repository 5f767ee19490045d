"""THE frame: ``drive`` turns a picture of a person into what the avatar does, ``draw`` turns that into pixels.

``run_offline`` does so for a clip, ``run_live`` for a window.
"""

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import numpy as np

from ..models.gem import Gem
from ..models.posing import pose_head
from ..render.arrays import Image
from ..render.camera import Camera
from ..render.compositing import over, to_rgba8
from ..render.engines import Engine
from ..render.gaussians import RawGaussians
from .desk.actions import Order
from .files.frames import Frame
from .files.sinks import Sink
from .performing import idle
from .performing.performance import Pose
from .performing.presence import Phase
from .performing.threads import Behind, ahead, at_most
from .performing.timing import Watch
from .person.following import Actor, Memory, count_faces, follow, look, turned_gain

if TYPE_CHECKING:
    from .desk.session import Session
    from .desk.view import DeskView

WAIT_SECS = 0.01
"""How long the window waits for keys and pointer, unless a shot or a picture wakes it before."""
NO_SHIFT = np.zeros(3, np.float32)


@dataclass(frozen=True)
class Stage:
    """What draws: the same for every frame of a clip."""

    gem: Gem
    engine: Engine
    camera: Camera
    background: tuple[float, float, float] | None
    """sRGB in [0, 1]; None keeps the picture transparent."""
    watch: Watch
    components: int | None = None
    """How many components a modality; None for all."""

    @cached_property
    def splats(self) -> RawGaussians:
        """Composed splats, overwritten by every frame."""
        return self.gem.compose(self.gem.rest_coefficients, self.components)

    @cached_property
    def posed(self) -> RawGaussians:
        """The same with the head posed, overwritten by every frame."""
        return pose_head(self.splats, self.gem.neck_weights, self.gem.neck_pivot, NO_SHIFT, NO_SHIFT)


def drive(actor: Actor, before: Memory, frame: Frame) -> tuple[Memory, Pose]:
    """One frame: image -> face -> features - neutral -> coefficients; smoothed, held, eased to rest, or idle."""
    memory, seen = look(actor.tracker, before, frame)
    if seen.face is not None:
        memory = count_faces(actor.tracker, follow(actor, memory, seen.face, seen.dt), frame)
    return act(actor, memory, seen.face is not None, seen.cut)


def act(actor: Actor, memory: Memory, seen: bool, cut: bool = False) -> tuple[Memory, Pose]:
    """What the avatar does at the time of ``memory``: the driver's expression as far as it is followed, idle beside it.

    ``seen``: whether the driver's face is there right now.
    """
    attention, now = memory.attention, memory.seconds or 0.0
    if attention.phase in (Phase.TRACKING, Phase.HOLD):
        memory = replace(memory, idle_since=now)
    gain, rest, idle_secs = attention.gain, 1 - attention.gain, now - memory.idle_since
    expression = rest * idle.lids_closed(idle_secs) * actor.lids
    turn = rest * idle.breath(idle_secs)
    translation = NO_SHIFT
    if memory.expression is not None and memory.turn is not None:
        expression = expression + gain * turned_gain(memory.turn.value) * memory.expression.value * actor.gem.sigma
        turn = turn + gain * memory.shown_turn
        translation = gain * memory.translation
    return memory, Pose(
        coefficients=(actor.gem.rest_coefficients + expression).astype(np.float32),
        turn=turn.astype(np.float32) if actor.head_pose else NO_SHIFT,
        phase=attention.phase,
        faces=memory.faces if seen else 0,
        clamped=memory.clamped if seen else 0.0,
        cut=cut,
        translation=translation.astype(np.float32) if actor.head_pose else NO_SHIFT,
    )


def perform(actor: Actor, frames: Iterable[Frame], watch: Watch) -> Iterator[tuple[Frame, Pose, int]]:
    """``drive`` over a whole clip: each frame, what the avatar does, and when (PTS)."""
    memory = Memory()
    for frame in frames:
        with watch("track"):
            memory, pose = drive(actor, memory, frame)
        yield frame, pose, frame.pts


def draw(stage: Stage, pose: Pose) -> Image:
    """One picture: compose, pose the head, splat; [H, W, 3] over the background, or [H, W, 4] with straight alpha."""
    gem, watch = stage.gem, stage.watch
    with watch("compose"), at_most(1):  # a millisecond's work: another core would come too late
        splats = gem.compose(pose.coefficients, stage.components, out=stage.splats)
        splats = pose_head(splats, gem.neck_weights, gem.neck_pivot, pose.turn, pose.translation, out=stage.posed)
    with watch("draw"):
        rgba = stage.engine.draw(splats, stage.camera)
    with watch("over"):
        return to_rgba8(rgba) if stage.background is None else over(rgba, stage.background)


def run_offline(
    performance: Iterable[tuple[Frame | None, Pose, int]],
    stage: Stage,
    finish: Callable[[Image, Frame | None], Image],
    sink: Sink,
    tell: Callable[[int, Pose, Frame | None], None],
) -> None:
    """Draw a performance into a sink, in order: reading and tracking run ahead in their threads, encoding runs behind.

    Args:
        performance: frame (None when only a track is played), what the avatar does, presentation time.
        finish: the last touch on a picture: puts the driver beside it, or nothing.
        tell: called after each frame with its index, what the avatar did, and the frame.

    Whatever interrupts it (Ctrl-C, a full disk), the sink is closed, so that what was written stays playable.
    """
    whole = False
    writer: Behind[tuple[int, Image, int]] = Behind(lambda shot: sink.write(*shot))
    try:
        with closing(ahead(performance)) as shots:
            for index, (frame, pose, pts) in enumerate(shots):
                picture = NOTHING if sink.has(index) else finish(draw(stage, pose), frame)
                writer.put((index, picture, pts))
                tell(index, pose, frame)
        writer.finish()
        whole = True
    finally:
        if not whole:
            writer.abandon()
        sink.close(whole)


NOTHING = np.empty((0, 0, 3), np.uint8)
"""Stands for a picture that is already written."""


class Desk(Protocol):
    """A window, or what stands for one."""

    def poll(self, wait: float = 0.0) -> list[Order]:
        """What was asked for since the last call; waits so many seconds for it."""
        ...

    def wake(self) -> None:
        """End the wait in ``poll``; from any thread."""
        ...

    def show(self, picture: Image | None, view: "DeskView") -> None:
        """Draw a frame; the picture stays until another one comes."""
        ...

    def clean(self, picture: Image | None) -> bool:
        """Show the picture by itself, too, or no longer; False when the person closed it."""
        ...


def run_live(desk: Desk, session: "Session") -> None:
    """The window's thread until somebody quits: orders -> state; newest shot -> picture -> outputs; panels -> screen.

    Nothing here waits for the driver, a file, an output or, where the engine allows it, a picture: the newest shot
    wins, and what is not ready comes later.
    """
    session.rouse(desk.wake)
    while not session.state.quitting:
        for order in (*desk.poll(WAIT_SECS), *session.orders()):
            session.obey(order)
        started = time.perf_counter()
        session.settle(started)
        session.draw(started)
        drawn = session.drawn()
        if drawn is None and not session.due(started):
            continue
        if drawn is not None:
            session.draw(started, beside=True)  # the next one, while this one is shown
            session.offer(drawn, started)  # before any panel is drawn, and never with one
            if not desk.clean(drawn.picture if session.state.clean_window else None):
                session.obey(Order("clean_window", 0.0))
        desk.show(None if drawn is None else drawn.preview, session.view(started))
        session.shown(drawn, time.perf_counter())
