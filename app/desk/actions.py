"""Everything a person can ask of the window, in one table: keys, menus, OSC and the help all read it."""

from dataclasses import dataclass
from typing import Literal

Argument = Literal["none", "switch", "number", "text"]
MENUS = ("Avatar", "Driver", "View", "Outputs", "Window")


@dataclass(frozen=True)
class Action:
    """One thing that can be asked for."""

    name: str
    title: str
    """What menus and the help call it."""
    menu: str
    """One of MENUS."""
    keys: tuple[tuple[str, float | None], ...]
    """Default keys (names as in ``keys``), each with the value it gives; None where the action takes none."""
    argument: Argument = "none"
    """What an OSC message carries: nothing, 0 or 1 (nothing toggles), a number, or a text."""
    relative: bool = False
    """Whether the keys' values are added to what is there; a value from OSC or a slider always replaces it."""

    @property
    def osc(self) -> str:
        """The address that asks for it."""
        return f"/gemheads/{self.name}"


@dataclass(frozen=True)
class Order:
    """An action that somebody asked for just now."""

    name: str
    value: float | str | None = None
    relative: bool = False
    """Whether the value is added to what is there."""


def _one(name: str, title: str, menu: str, key: str, argument: Argument = "none") -> Action:
    return Action(name, title, menu, ((key, None),), argument)


def _dial(name: str, title: str, menu: str, less: str, more: str, step: float) -> Action:
    return Action(name, title, menu, ((less, -step), (more, step)), "number", relative=True)


ACTIONS: tuple[Action, ...] = (
    Action("avatar", "Avatar by number", "Avatar", tuple((str(n), float(n)) for n in range(1, 10)), "number"),
    _one("previous_avatar", "Previous avatar", "Avatar", "A"),
    _one("next_avatar", "Next avatar", "Avatar", "D"),
    _one("open", "Open a file or folder ...", "Avatar", "Ctrl+O", "text"),
    _dial("components", "Components", "Avatar", "-", "+", 5),
    _one("position", "Positions move", "Avatar", "Ctrl+1", "switch"),
    _one("rotation", "Rotations move", "Avatar", "Ctrl+2", "switch"),
    _one("scale", "Scales move", "Avatar", "Ctrl+3", "switch"),
    _one("opacity", "Opacities move", "Avatar", "Ctrl+4", "switch"),
    _one("compare", "Compare with all components (A/B)", "Avatar", "B", "switch"),
    _one("error_map", "Error map in the comparison", "Avatar", "E", "switch"),
    _dial("split", "Split of the comparison", "Avatar", "Shift+Left", "Shift+Right", 0.05),
    _one("curve", "Compression plot", "Avatar", "K", "switch"),
    _one("explore", "Explore the components", "Avatar", "X", "switch"),
    _one("explored_modality", "Next modality to explore", "Avatar", "Shift+X", "text"),
    _dial("explored_component", "Component to explore", "Avatar", "Shift+Down", "Shift+Up", 1),
    _dial("sigma", "Explored component in sigma", "Avatar", "Shift+PageDown", "Shift+PageUp", 0.25),
    _one("sweep", "Sweep from -3 to +3 sigma", "Avatar", "S", "switch"),
    _one("unexplore", "Explored components back to rest", "Avatar", "Backspace"),
    _one("camera", "My camera", "Driver", "C", "text"),
    _one("demo", "The demo", "Driver", "Ctrl+D"),
    _one("no_source", "Close the source", "Driver", "Ctrl+W"),
    _one("play", "Freeze, or play and pause", "Driver", "Space", "switch"),
    _dial("step", "Frame by frame", "Driver", ",", ".", 1),
    _dial("seek", "Position in the source, seconds", "Driver", "Ctrl+Left", "Ctrl+Right", 5),
    _one("loop", "Loop", "Driver", "Ctrl+L", "switch"),
    _one("neutral", "Neutral: look at rest", "Driver", "N"),
    _dial("neutral_strength", "Strength of the neutral", "Driver", "Shift+N", "Alt+N", 0.1),
    _one("relock", "Follow another face", "Driver", "L"),
    _dial("smoothing", "Smoothing", "Driver", "[", "]", 0.1),
    _dial("gain_mouth", "Gain of the mouth", "Driver", "Shift+Alt+1", "Alt+1", 0.1),
    _dial("gain_eyes", "Gain of the eyes", "Driver", "Shift+Alt+2", "Alt+2", 0.1),
    _dial("gain_brows", "Gain of the brows", "Driver", "Shift+Alt+3", "Alt+3", 0.1),
    _dial("gain_head", "Gain of the head", "Driver", "Shift+Alt+4", "Alt+4", 0.1),
    _one("head_pose", "Head follows", "Driver", "H", "switch"),
    _dial("yaw", "Camera round the head, degrees", "View", "Left", "Right", 5),
    _dial("pitch", "Camera up and down, degrees", "View", "Down", "Up", 5),
    _dial("zoom", "Zoom", "View", "PageDown", "PageUp", 0.1),
    _one("frame", "Frame the avatar", "View", "F"),
    _one("reset_view", "Reset the view", "View", "Home"),
    _one("mirror", "Mirror the preview", "View", "M", "switch"),
    _one("background", "Next background", "View", "G", "text"),
    _dial("exposure", "Light on the avatar, stops", "View", "Ctrl+Down", "Ctrl+Up", 0.1),
    _dial("warmth", "Warmth of the light", "View", "Ctrl+PageDown", "Ctrl+PageUp", 0.1),
    _one("curtain", "Privacy curtain", "Outputs", "0", "switch"),
    _one("record", "Record", "Outputs", "R", "switch"),
    _one("microphone", "Record the microphone too", "Outputs", "Ctrl+M", "switch"),
    _one("picture", "Save a picture", "Outputs", "P"),
    _one("virtual_camera", "Virtual camera", "Outputs", "V", "switch"),
    _one("badge", "SYNTHETIC badge, or why there is none ...", "Outputs", "Ctrl+B", "text"),
    _one("camera_badge", "Badge in the virtual camera too", "Outputs", "Shift+V", "switch"),
    _one("clean_window", "Clean window", "Outputs", "W", "switch"),
    _one("coefficients", "Coefficients by OSC", "Outputs", "O", "switch"),
    _one("panels", "Panels", "Window", "Tab", "switch"),
    _one("figures", "Figures", "Window", "I", "switch"),
    _one("ladder", "Lower the quality when the machine is slow", "Window", "J", "switch"),
    _dial("ui_scale", "Size of text and panels", "Window", "Ctrl+-", "Ctrl++", 0.1),
    _one("walk", "Walk the panels by arrows and Enter", "Window", "F6", "switch"),
    _one("menu", "Menu", "Window", "F10", "switch"),
    _one("full_screen", "Full screen", "Window", "F11", "switch"),
    _one("help", "Keys and help", "Window", "?", "switch"),
    _one("leave", "Leave the mode", "Window", "Esc"),
    _one("quit", "Quit", "Window", "Ctrl+Q"),
)
BY_NAME = {action.name: action for action in ACTIONS}
