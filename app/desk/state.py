"""What the window shows and how, as one value; ``update`` is the only way it changes. Pure."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ...models.gem import CLAMP_SIGMAS, MODALITIES
from ..credentials.reasons import is_reason
from .actions import BY_NAME, Order

BACKGROUNDS = ("studio", "grey", "white", "black", "green", "blue", "transparent")
LEAST_COMPONENTS = 1
ZOOMS = (0.5, 4.0)
UI_SCALES = (0.75, 2.5)
EXPOSURES = (-2.0, 2.0)
BEYOND = 1e9
"""No dial goes as far. Whole numbers from outside can have hundreds of digits, and then are no float."""


@dataclass(frozen=True)
class Limits:
    """What the avatar on stage allows."""

    components: int = 50
    """K, as stored."""
    yaw_deg: float = 45.0
    pitch_deg: float = 25.0
    stored: Mapping[str, int] = field(default_factory=dict)
    """Modality -> components stored, where that is not K."""

    def stored_of(self, modality: str) -> int:
        """How many components of a modality there are to be explored."""
        return self.stored.get(modality, self.components)


@dataclass(frozen=True)
class Exploring:
    """The explorer of components."""

    on: bool = False
    modality: str = "position"
    component: int = 0
    """From 0."""
    sigmas: tuple[tuple[str, int, float], ...] = ()
    """(modality, component, value in sigma) of every slider that is not at 0."""
    sweep: bool = False

    def value(self, modality: str, component: int) -> float:
        """Where a slider stands, in sigma."""
        return next((value for *place, value in self.sigmas if place == [modality, component]), 0.0)

    @property
    def reach(self) -> int:
        """How many components a modality it takes to see what is moved; 0 while nothing is explored."""
        return 1 + max(self.component, *(component for _, component, _ in self.sigmas), 0) if self.on else 0


@dataclass(frozen=True)
class DeskState:
    """Everything a person set; what happens by itself (loading, tracking, figures) is elsewhere."""

    limits: Limits = field(default_factory=Limits)
    panels: bool = True
    help: bool = False
    menu: bool = False
    prompt: bool = False
    """Whether the path of a file is being typed."""
    welcome: bool = True
    """The card of the first run."""
    figures: bool = True
    walk: bool = False
    full_screen: bool = False
    ui_scale: float = 1.0
    curtain: bool = False
    frozen: bool = False
    mirror: bool = True
    components: int | None = None
    """None shows all."""
    off: frozenset[str] = frozenset()
    """Modalities that stay at rest."""
    compare: bool = False
    error_map: bool = False
    split: float = 0.5
    curve: bool = False
    exploring: Exploring = field(default_factory=Exploring)
    loop: bool = True
    head_pose: bool = True
    neutral_strength: float = 1.0
    smoothing: float = 0.5
    gain_mouth: float = 1.0
    gain_eyes: float = 1.0
    gain_brows: float = 1.0
    gain_head: float = 1.0
    yaw: float = 0.0
    """Degrees; the camera goes to the avatar's left where positive."""
    pitch: float = 0.0
    at_limit: bool = False
    """Whether the last turn of the camera wanted to go beyond where the avatar was made to be seen from."""
    zoom: float = 1.0
    background: str = "studio"
    exposure: float = 0.0
    """Stops."""
    warmth: float = 0.0
    """-1 cold to 1 warm."""
    record: bool = False
    microphone: bool = False
    """Whether the next recording has sound."""
    virtual_camera: bool = False
    no_badge: str = ""
    """Why recordings and pictures carry no SYNTHETIC badge; empty: they carry one, as at every start."""
    asking_reason: bool = False
    """Whether the reason is being typed."""
    camera_badge: bool = False
    """Whether the virtual camera carries the badge too."""
    clean_window: bool = False
    coefficients: bool = False
    ladder: bool = True
    resting: bool = False
    """Whether the neutral is being taken."""
    quitting: bool = False

    @property
    def walking(self) -> bool:
        """Whether arrows, Enter and Tab move about in panels or menu."""
        return self.walk or self.menu

    @property
    def writing(self) -> bool:
        """Whether a card with a line to type into is open: letters are for that alone, wherever the pointer clicked."""
        return self.prompt or self.asking_reason

    @property
    def used_components(self) -> int:
        """How many components a modality are shown."""
        return self.limits.components if self.components is None else min(self.components, self.limits.components)

    @property
    def explored_components(self) -> int:
        """How many of them the explorer needs, however few are chosen, or left by a slow machine."""
        return min(self.exploring.reach, self.limits.components)


SWITCHES = frozenset(
    "compare curve loop head_pose mirror curtain record microphone virtual_camera camera_badge clean_window"
    " coefficients panels figures ladder walk menu full_screen help".split()
)
RANGES: dict[str, tuple[float, float]] = {
    "split": (0.0, 1.0),
    "neutral_strength": (0.0, 1.0),
    "smoothing": (0.0, 1.0),
    "gain_mouth": (0.0, 2.0),
    "gain_eyes": (0.0, 2.0),
    "gain_brows": (0.0, 2.0),
    "gain_head": (0.0, 2.0),
    "zoom": ZOOMS,
    "exposure": EXPOSURES,
    "warmth": (-1.0, 1.0),
    "ui_scale": UI_SCALES,
}
"""Numbers that stay between two others."""


def update(state: DeskState, order: Order) -> DeskState:
    """The state after an order. What the order's value makes no sense of leaves the state as it was."""
    name, value = order.name, order.value
    if name not in BY_NAME or (isinstance(value, float | int) and not abs(value) < BEYOND):
        return state
    if name in SWITCHES:
        return replace(state, **{name: _switched(getattr(state, name), value)})
    if name in RANGES:
        return replace(state, **{name: _dialled(order, getattr(state, name), *RANGES[name])})
    if name in MODALITIES:
        on = _switched(name not in state.off, value)
        return replace(state, off=state.off - {name} if on else state.off | {name})
    return _RULES.get(name, _unchanged)(state, order)


def restaged(state: DeskState, limits: Limits) -> DeskState:
    """The state when another avatar comes on stage: what the old one alone allowed is drawn in; of components as many
    are shown as it has, and when one with more is back, as many as were asked for."""
    kept = _explored(replace(state, limits=limits), sigmas=(), component=0)
    return _turned(_turned(kept, "yaw", kept.yaw), "pitch", kept.pitch)


def _unchanged(state: DeskState, order: Order) -> DeskState:
    return state


def _switched(before: bool, value: float | str | None) -> bool:
    return not before if value is None or isinstance(value, str) else bool(value)


def _dialled(order: Order, before: float, low: float, high: float) -> float:
    if not isinstance(order.value, float | int):
        return before
    wanted = before + order.value if order.relative else order.value
    return round(min(high, max(low, float(wanted))), 4)


def _turned(state: DeskState, axis: str, wanted: float) -> DeskState:
    limit = getattr(state.limits, f"{axis}_deg")
    kept = min(limit, max(-limit, wanted))
    return replace(state, **{axis: round(kept, 4)}, at_limit=kept != wanted)


def _orbit(state: DeskState, order: Order) -> DeskState:
    if not isinstance(order.value, float | int):
        return state
    before = getattr(state, order.name) if order.relative else 0.0
    return _turned(state, order.name, before + order.value)


def _components(state: DeskState, order: Order) -> DeskState:
    if not isinstance(order.value, float | int):
        return state
    stored, used = state.limits.components, state.used_components
    wanted = round(used + order.value if order.relative else order.value)
    if order.relative and used == LEAST_COMPONENTS and wanted > used:
        wanted -= LEAST_COMPONENTS  # back onto the multiples of the step
    kept = min(stored, max(LEAST_COMPONENTS, wanted))
    return replace(state, components=None if kept == stored else kept)


def _background(state: DeskState, order: Order) -> DeskState:
    if isinstance(order.value, str) and order.value:
        known = order.value.strip().lower()
        return replace(state, background=known) if known in BACKGROUNDS or _is_colour(known) else state
    index = BACKGROUNDS.index(state.background) if state.background in BACKGROUNDS else -1
    return replace(state, background=BACKGROUNDS[(index + 1) % len(BACKGROUNDS)])


def _is_colour(text: str) -> bool:
    return len(text) == 7 and text[0] == "#" and all(digit in "0123456789abcdef" for digit in text[1:])


def _explored(state: DeskState, **changes: Any) -> DeskState:
    """The state with these changes to what is explored, as far as the avatar stores it: nothing cannot be swept."""
    wanted = replace(state.exploring, **changes)
    stored = state.limits.stored_of(wanted.modality)
    component, sweep = max(0, min(wanted.component, stored - 1)), wanted.sweep and stored > 0
    return replace(state, exploring=replace(wanted, component=component, sweep=sweep))


def _explore(state: DeskState, order: Order) -> DeskState:
    return replace(state, exploring=replace(state.exploring, on=_switched(state.exploring.on, order.value)))


def _sweep(state: DeskState, order: Order) -> DeskState:
    on = _switched(state.exploring.sweep, order.value)
    return _explored(state, on=on or state.exploring.on, sweep=on)


def _explored_modality(state: DeskState, order: Order) -> DeskState:
    before = state.exploring.modality
    after = MODALITIES[(MODALITIES.index(before) + 1) % len(MODALITIES)] if order.value is None else order.value
    return state if after not in MODALITIES else _explored(state, modality=after)


def _explored_component(state: DeskState, order: Order) -> DeskState:
    return _explored(state, component=round(_dialled(order, state.exploring.component, 0, BEYOND)))


def _error_map(state: DeskState, order: Order) -> DeskState:
    """It is seen in the comparison, which it brings along."""
    on = _switched(state.compare and state.error_map, order.value)
    return replace(state, error_map=on, compare=state.compare or on)


def _sigma(state: DeskState, order: Order) -> DeskState:
    exploring = state.exploring
    place = (exploring.modality, exploring.component)
    value = _dialled(order, exploring.value(*place), -CLAMP_SIGMAS, CLAMP_SIGMAS)
    if not state.limits.stored_of(exploring.modality):
        return _explored(state, on=True)
    others = tuple(slider for slider in exploring.sigmas if slider[:2] != place)
    sigmas = others if value == 0 else (*others, (*place, value))
    return replace(state, exploring=replace(exploring, on=True, sigmas=sigmas))


def _badge(state: DeskState, order: Order) -> DeskState:
    """A reason takes the badge away; 1, or nothing while it is away, brings it back; else the reason is asked for."""
    if isinstance(order.value, str):
        reason = " ".join(order.value.split())
        return replace(state, no_badge=reason, asking_reason=False) if is_reason(reason) else state
    if order.value or (order.value is None and state.no_badge):
        return replace(state, no_badge="", asking_reason=False)
    return replace(state, asking_reason=not state.asking_reason and not state.no_badge)


def _leave(state: DeskState, order: Order) -> DeskState:
    """Esc: the topmost mode goes, one at a time."""
    for mode in ("prompt", "asking_reason", "menu", "help", "walk", "resting", "curve", "compare", "full_screen"):
        if getattr(state, mode):
            return replace(state, **{mode: False})
    if state.exploring.on:
        return replace(state, exploring=replace(state.exploring, on=False, sweep=False))
    return replace(state, welcome=False)


_RULES: dict[str, Callable[[DeskState, Order], DeskState]] = {
    "components": _components,
    "yaw": _orbit,
    "pitch": _orbit,
    "background": _background,
    "explore": _explore,
    "sweep": _sweep,
    "explored_modality": _explored_modality,
    "explored_component": _explored_component,
    "sigma": _sigma,
    "error_map": _error_map,
    "badge": _badge,
    "unexplore": lambda state, _: replace(state, exploring=replace(state.exploring, sigmas=(), sweep=False)),
    "frame": lambda state, _: replace(state, zoom=1.0),
    "reset_view": lambda state, _: replace(state, zoom=1.0, yaw=0.0, pitch=0.0, at_limit=False),
    "play": lambda state, order: replace(state, frozen=not _switched(not state.frozen, order.value)),
    "neutral": lambda state, _: replace(state, resting=not state.resting),
    "open": lambda state, order: replace(state, prompt=not order.value, welcome=state.welcome and not order.value),
    "camera": lambda state, _: replace(state, welcome=False),
    "demo": lambda state, _: replace(state, welcome=False),
    "leave": _leave,
    "quit": lambda state, _: replace(state, quitting=True),
}
