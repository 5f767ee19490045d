"""The first minute: a shipped avatar acts what the shipped clip does."""

from pathlib import Path

from ..render.enginename import EngineName
from .errors import ExitCode
from .library import demo_clip, find_avatar
from .machine import has_display
from .performing.casting import open_avatar
from .reenacting.reenact import reenact
from .reenacting.wish import Wish


def run_demo(out: str, avatar: str | None, engine: EngineName, window: bool, no_badge: str = "") -> ExitCode:
    """Write the demo video, say where it is, and open the live window with it where there is a display.

    Raises CommandError.
    """
    clip = str(demo_clip())
    path = find_avatar(avatar)
    learned = open_avatar(path).gem.regressor is not None
    driving = "learned" if learned else "baseline"
    wish = Wish(path, side_by_side=True, engine=engine, driving=driving, no_badge=no_badge, name_driver=True)
    code = reenact([clip], out, wish)
    if code is ExitCode.OK:
        print(f"Done: open {Path(out).resolve()}; the face of the clip is on the left, the avatar on the right.")
        if window and has_display():
            from .desk.command import live_command
            from .desk.wish import LiveWish

            return live_command(LiveWish(clip, avatar, engine=engine, no_badge=no_badge))
    return code
