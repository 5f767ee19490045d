"""What goes on beside the window, and what was asked of it: the state, the driver, the stage, the outputs."""

import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from ...models.brevity import brief
from ...render.engines import Engine
from ..inputs.opening import plain_path
from ..performing.casting import Avatar
from ..performing.ladder import Quality, said
from .actions import Order
from .driving import Driving
from .explore import sweep
from .gauges import Gauges
from .keys import Keymap
from .loader import Refused
from .onstage import Drawn, OnStage
from .outputs import Outputs
from .remote import Remote
from .roster import Roster
from .sources import is_avatar
from .state import BEYOND, DeskState, Limits, restaged, update
from .view import DeskView, Toast

TOAST_SECS = 6.0
SHOW_EVERY = 1 / 30
"""Seconds after which panels are drawn again though the picture is the same."""
REPEAT_SECS = 0.25
"""Seconds after which outputs get a picture again though it is the same: programs that look in meanwhile want one, and
so do sound, the safety of a recording, and a clean window that was resized or closed."""
TRANSPORT = ("play", "step", "seek")
LADDER_OFF = "Quality stays as it is, however slow the machine."
NO_FACE = "There is no picture to take a face at rest from: choose your camera, a video or pictures first."
NO_ROOM = "The window is too narrow for the panels: make it wider, or letters smaller (Ctrl+-). F10 is the menu."


class Session:
    """For the window's thread. Nothing here waits for anything."""

    def __init__(
        self,
        state: DeskState,
        roster: Roster,
        keymap: Keymap,
        engine: Callable[[], Engine],
        outputs: Outputs,
        size: tuple[int, int] = (512, 512),
        remote: Remote | None = None,
        driving: Driving | None = None,
        warm: Callable[[], None] = lambda: None,
        spare: Path | None = None,
        opened: Iterable[Avatar] = (),
    ) -> None:
        """
        Args:
            state: as remembered and as the command line has it.
            roster: the avatars there are; the current one is opened at once.
            keymap: what keys mean.
            engine: opens what draws, in the window's thread, when the first avatar is there.
            outputs: what is written and sent.
            size: width and height of the picture in pixels.
            remote: orders from other programs.
            driving: made here unless given.
            warm: compiles what ``engine`` needs, in another thread and before it is opened.
            spare: the avatar to be opened where the first one is refused.
            opened: avatars that were opened before the window was, and need not be read again.
        """
        self.state, self.keymap, self.outputs, self.remote = state, keymap, outputs, remote
        self.gauges = Gauges()
        self.driving = driving or Driving(self.tell)
        self.stage = OnStage(roster, engine, size, self.gauges, warm, opened)
        self._toasts: list[tuple[float, Toast]] = []
        self._shown_at, self._lowered = 0.0, ""
        self._ended: dict[str, str] = {}
        self._saving = False
        self._spare = spare
        for complaint in keymap.conflicts:
            self.tell(complaint)
        self.stage.call(roster.numbered(roster.current + 1))

    def rouse(self, waker: Callable[[], None]) -> None:
        """Have ``waker`` called, in whatever thread, when there is a new shot or a picture."""
        self.driving.rouse(waker)
        self.stage.rouse(waker)

    def obey(self, order: Order) -> None:
        """Do what was asked for; numbers beyond all sense, which other programs may send, ask for nothing."""
        if isinstance(order.value, float | int) and not abs(order.value) < BEYOND:
            return
        if order.name != "play" or self.driving.transport is None:
            self.state = update(self.state, order)
        source = self.driving.source
        self._carry_out(order)
        if self.driving.source is not source or order.name == "camera":
            # it was the other one that was to stand still; a camera is chosen to see what it sees
            self.state = replace(self.state, frozen=False)

    def settle(self, now: float) -> None:
        """Bring about what the state says, as far as it is ready."""
        answer = self.stage.arrived()
        if isinstance(answer, Refused):
            self.tell(answer.reason, alarm=True)
        elif answer is not None and self.driving.cast(answer):
            self.outputs.introduce(answer)
            self.stage.await_shot(answer, now)
        if answer is not None and self.stage.avatar is None and self.stage.coming is None:
            self.stage.call(self._spare)
            self._spare = None
        for order in self.outputs.settle(self.state):
            self.obey(order)
        self._tell_of_outputs()
        every = self.gauges.quality(self._components).detector_every
        if self.stage.avatar is not None and self.driving.settle(
            self.state, every, self.stage.avatar, self.stage.shot, now
        ):
            self.obey(Order("neutral"))
        if self.state.frozen and (transport := self.driving.transport) is not None:
            transport.pause()  # asked for while it was being opened
            self.state = replace(self.state, frozen=False)

    def draw(self, now: float, beside: bool = False) -> None:
        """Begin a picture of the newest shot, unless one is being drawn or the last one still holds.

        Another avatar comes on stage with its first shot. ``beside``: only where that takes none of this thread's time.
        """
        if not self.stage.free or (beside and self.stage.bound):
            return
        shot, changed = self.stage.take(self.driving.newest(), self.state.frozen, now)
        if changed and self.stage.avatar is not None:
            self.state = restaged(self.state, limits_of(self.stage.avatar))
        seen = self.outputs.fan.listening or self._saving or self.state.clean_window
        every = REPEAT_SECS if seen else float("inf")
        self.stage.draw(self.state, self._quality(self._still or self._saving), shot, now, every)

    def drawn(self) -> Drawn | None:
        """The picture that was begun, once, when it is done; nothing of the avatar where the curtain fell meanwhile."""
        drawn = self.stage.drawn()
        return drawn.behind_the_curtain() if drawn is not None and self.state.curtain else drawn

    def offer(self, drawn: Drawn, now: float) -> None:
        """Give the outputs a picture; behind the curtain no coefficients go with it.

        One that was asked for is saved when it comes whole: on a slow machine a smaller one may be under way.
        """
        if self._saving and drawn.whole:
            self._saving = False
            self.outputs.picture()
        self.outputs.fan.offer(drawn.picture, now, drawn.pose, drawn.avatar if drawn.pose is not None else "")

    def due(self, now: float) -> bool:
        """Whether panels want to be drawn again."""
        return now - self._shown_at >= SHOW_EVERY

    def shown(self, drawn: Drawn | None, now: float) -> None:
        """A frame was swapped at ``now``, with or without another picture in it."""
        self._shown_at = now
        if drawn is not None:
            ladder = self.state.ladder and not self.state.compare
            self.gauges.shown(drawn.shot, drawn.secs, self._components, ladder, now)

    def view(self, now: float) -> DeskView:
        """All that the panels show."""
        self._toasts = [(until, toast) for until, toast in self._toasts if until > now]
        stage, driving = self.stage, self.driving
        wanted = Quality(self._components)
        lowered = said(self.gauges.quality(self._components), wanted)
        if lowered and lowered != self._lowered:
            self.tell(f"{lowered} J switches this off.", topic="quality")
        self._lowered = lowered
        readings = self.gauges.read(driving.health, stage.engine, now)
        return DeskView(
            state=self.state,
            keymap=self.keymap,
            avatars=stage.roster.names,
            on_stage=stage.roster.current,
            loading=stage.loading,
            avatar=stage.facts,
            health=driving.health,
            shot=stage.shot,
            cameras=driving.cameras,
            transport=driving.transport,
            readings=replace(readings, lowered=said(self._quality(self._still), wanted)),
            curve=stage.curve,
            rest=driving.neutral.told(),
            outputs=self.outputs.lines(),
            swept=sweep(now),
            toasts=tuple(toast for _, toast in self._toasts[-3:]),
            error_db=stage.error_db if self.state.compare else None,
        )

    def orders(self) -> list[Order]:
        """What other programs ask for."""
        return self.remote.orders() if self.remote is not None else []

    def tell(self, words: str, alarm: bool = False, topic: str = "") -> None:
        """Say something over the picture for some seconds, in place of what was said on the same ``topic``."""
        if topic:
            self._toasts = [(until, toast) for until, toast in self._toasts if toast.topic != topic]
        self._toasts.append((time.perf_counter() + TOAST_SECS, Toast(words, alarm, topic)))

    def _tell_of_outputs(self) -> None:
        """What came of them, once, wherever their panel is: it may be out of sight."""
        for line in self.outputs.lines():
            words = f"{line.name}: {line.status}" if line.over else ""
            if words and words != self._ended.get(line.name):
                self.tell(f"{words.rstrip('.')}.", alarm=line.failed, topic=line.name)
            self._ended[line.name] = words

    def close(self) -> None:
        """End everything, in under a second."""
        self.driving.close()
        self.outputs.close()
        self.stage.close()
        if self.remote is not None:
            self.remote.close()

    @property
    def _still(self) -> bool:
        """Whether nothing moves."""
        transport, exploring = self.driving.transport, self.state.exploring
        paused = self.state.frozen or (transport is not None and not transport.playing)
        return paused and not (exploring.on and exploring.sweep)

    def _quality(self, whole: bool) -> Quality:
        """What is drawn: all of it where nothing moves, and of what is to be saved, however slow the machine is; and
        what is explored is seen."""
        quality = Quality(self._components) if whole else self.gauges.quality(self._components)
        return replace(quality, components=max(quality.components, self.state.explored_components))

    @property
    def _components(self) -> int:
        return self.state.used_components

    def _carry_out(self, order: Order) -> None:
        """What an order does besides changing the state."""
        name, value, roster = order.name, order.value, self.stage.roster
        words = value if isinstance(value, str) else ""
        if name in TRANSPORT:
            self.driving.press(order)
        elif name == "avatar" and isinstance(value, float | int):
            self.stage.call(roster.numbered(value))
        elif name in ("previous_avatar", "next_avatar"):
            self.stage.call(roster.beside(1 if name == "next_avatar" else -1, self.stage.coming))
        elif name == "open" and words:
            self._open(words)
        elif name == "camera":
            self.driving.open_camera(words)
        elif name == "demo":
            self.driving.open_demo()
        elif name == "no_source":
            self.driving.use(None, "")
        elif name == "relock":
            self.driving.relock()
        elif name == "picture":
            self._saving = True
        elif name == "neutral" and self.state.resting and not self.driving.health.pictured:
            self.state = replace(self.state, resting=False)
            self.tell(NO_FACE, topic="neutral")
        elif name == "ladder":
            kept = "Pictures are lowered when the machine is slow." if self.state.ladder else LADDER_OFF
            self.tell(kept, topic="quality")
        elif name == "no_room":
            self.tell(NO_ROOM, topic="room")

    def _open(self, words: str) -> None:
        """An avatar or a source, by whatever somebody typed or sent."""
        words = plain_path(words)
        try:
            if is_avatar(words):
                self.stage.call(Path(words).expanduser())
            else:
                self.driving.open(words)
        except (OSError, RuntimeError, ValueError) as error:  # nobody's home, too long a name, a NUL in it
            self.tell(f"{brief(words)}: no path that can be opened ({brief(error)}).", alarm=True)


def limits_of(avatar: Avatar) -> Limits:
    """What an avatar allows."""
    gem, viewing = avatar.gem, avatar.gem.viewing
    stored = {name: len(basis) for name, basis in gem.bases.items()}
    return Limits(gem.components, viewing.yaw_limit_deg, viewing.pitch_limit_deg, stored)
