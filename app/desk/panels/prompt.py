"""A line to type or paste the path of a file into."""

from imgui_bundle import imgui

from ..view import DeskView
from .controls import Ask, faint, scale, title

WIDTH = 520.0


class Prompt:
    """Keeps what is typed: it is there again when there was a slip in it."""

    def __init__(self) -> None:
        self._text = ""

    def draw(self, view: DeskView, ask: Ask) -> None:
        """In the middle: Enter opens, Esc leaves."""
        title("Open")
        faint(
            "An avatar (.gem), a video, a folder of pictures, a track, or osc:PORT. You can also drop it on the window."
        )
        if imgui.is_window_appearing() or not imgui.is_any_item_active():  # a click beside the line takes it away
            imgui.set_keyboard_focus_here()
        imgui.set_next_item_width(-88 * scale(view))
        entered, self._text = imgui.input_text("##path", self._text, imgui.InputTextFlags_.enter_returns_true.value)
        imgui.same_line()
        if (imgui.button("Open", imgui.ImVec2(-1, 0)) or entered) and self._text.strip():
            ask("open", self._text.strip())
