"""A line to type why recordings and pictures carry no badge."""

from imgui_bundle import imgui

from ...credentials.reasons import EXAMPLE, LONGEST, SHORTEST, is_reason
from ..view import DeskView
from .controls import Ask, faint, scale, title

WIDTH = 520.0


class Reason:
    """Keeps what is typed from one frame to the next."""

    def __init__(self) -> None:
        self._text = ""

    def draw(self, view: DeskView, ask: Ask) -> None:
        """In the middle: Enter takes the badge away once there is a reason, Esc leaves it."""
        title("Without the SYNTHETIC badge")
        faint(
            f"Say why, in {SHORTEST} to {LONGEST} characters, such as: {EXAMPLE}. It goes into the credentials of what"
            " is recorded, and the badge is back at the next start."
        )
        if imgui.is_window_appearing() or not imgui.is_any_item_active():  # a click beside the line takes it away
            imgui.set_keyboard_focus_here()
        imgui.set_next_item_width(-120 * scale(view))
        entered, self._text = imgui.input_text("##reason", self._text, imgui.InputTextFlags_.enter_returns_true.value)
        imgui.same_line()
        words = " ".join(self._text.split())
        imgui.begin_disabled(not is_reason(words))
        pressed = imgui.button("Leave it out", imgui.ImVec2(-1, 0))
        imgui.end_disabled()
        if (pressed or entered) and is_reason(words):
            ask("badge", words)
            self._text = ""
