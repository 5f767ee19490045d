"""The command that opens the window."""

from typing import Annotated

from cyclopts import Parameter

from .options import AvatarName, EngineName, NoBadge, Size, Whole


def live(
    driver: str | None = None,
    /,
    *,
    avatar: AvatarName = None,
    camera: Annotated[str | None, Parameter(name="--camera")] = None,
    components: Whole | None = None,
    size: Size = "512x512",
    engine: EngineName = "auto",
    listen: str | None = None,
    no_badge: NoBadge = None,
) -> int:
    """Open a window with an avatar in it that does what your face does; nothing leaves this computer.

    Without a driver and a camera it plays a shipped performance until you choose. Press ? in the window for all keys.

    Args:
        driver: A video, a folder of pictures, a track, osc:PORT (VMC) or ifacialmocap:PORT; both also as
            NAME:0.0.0.0:PORT, for what other devices send. demo is the shipped clip, performance what plays at first.
        avatar: Name of an avatar or a .gem file. Default: the one of the last time.
        camera: Name of a camera, or a part of it; any is the one of the last time, or the first.
        components: How many components a modality to draw with; fewer is faster and coarser. Default: all.
        size: Width x height of the avatar's picture in pixels, both even; the window may be of any size.
        engine: What draws; auto measures once and takes the faster.
        listen: Take orders by OSC at HOST:PORT, or at PORT of this computer only; `?` in the window names them.
        no_badge: Leave the SYNTHETIC badge out of what is recorded, and why: the reason goes into the credentials.
    """
    from ..credentials.reasons import read_reason
    from ..desk.command import live_command
    from ..desk.wish import LiveWish
    from ..errors import UsageError
    from ..words import read_size

    if driver is not None and camera is not None:
        raise UsageError("give a driver or --camera, not both")
    if components is not None and components < 1:
        raise UsageError(f"--components {components}: choose at least 1")
    reason = read_reason(no_badge)
    wanted = "" if camera is not None and camera.lower() == "any" else camera
    return live_command(LiveWish(driver, avatar, wanted, components, read_size(size), engine, listen, reason))
