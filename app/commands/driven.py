"""Commands in which an avatar acts a face: reenact, demo and track."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .options import AvatarName, DriverName, EngineName, NoBadge, Out, Size, Whole


def reenact(
    *drivers: str,
    out: Out,
    avatar: AvatarName = None,
    components: Whole | None = None,
    size: Size = "512x512",
    neutral: str = "auto",
    neutral_sheet: Path | None = None,
    crop: str = "whole",
    side_by_side: Annotated[bool, Parameter(negative="")] = False,
    background: str = "grey",
    no_head_pose: Annotated[bool, Parameter(negative="")] = False,
    report: Path | None = None,
    resume: Annotated[bool, Parameter(negative="")] = False,
    track: Path | None = None,
    engine: EngineName = "auto",
    driver: DriverName = "learned",
    rate: str | None = None,
    no_badge: NoBadge = None,
    name_driver: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Let an avatar act what the faces in videos do.

    Args:
        drivers: Videos, folders of pictures, or numbered pictures (shot_%04d.png). None is needed with --track.
        out: Result: .mp4, .mov, .webm, or a folder for PNGs; with several drivers a folder of results.
        avatar: Name of an avatar (`gemheads info` lists them) or a .gem file.
        components: How many components a modality to draw with; fewer is faster and coarser. Default: all.
        size: Width x height of the avatar's picture in pixels, both even.
        neutral: The driver's face at rest: auto, first, frame=N, time=S, image=PATH, or profile=NAME (taken live with
            that camera).
        neutral_sheet: A PNG of the best six frames auto chose from, and why; it shows the driver's face. With several
            drivers a folder.
        crop: Which part of the drivers' pictures is looked at, where several people are seen or the face is small: left
            or right (halves), X,Y,WIDTH,HEIGHT in percent, or whole.
        side_by_side: Put the driver's picture beside the avatar's.
        background: A colour (#rrggbb or a name) or transparent (.mov, .webm or PNGs).
        no_head_pose: Keep the head still; only the expression is followed.
        report: Write what happened as JSON: frames, losses, clamp share, neutral, milliseconds by stage.
        resume: Leave finished results alone; continue folders of PNGs.
        track: Play a file of `gemheads track`; a driver beside it adds its sound and picture.
        engine: What draws; auto measures once and takes the faster.
        driver: learned uses the avatar's regressor, baseline the tracker's scores directly. Not with --track.
        rate: Frames per second of pictures, such as 25 or 30000/1001. Default: 30.
        no_badge: Leave the SYNTHETIC badge out, and why: the reason goes into the report and the credentials.
        name_driver: Put the driver's file name into the credentials, beside the hash of its bytes.
    """
    from ..credentials.reasons import read_reason
    from ..files.crop import read_crop
    from ..files.sources import have_times
    from ..library import find_avatar
    from ..person.neutrals import read_rule
    from ..reenacting.reenact import reenact as run
    from ..reenacting.wish import Wish
    from ..words import read_colour, read_rate, read_size, refuse

    if have_times(drivers):
        refuse("videos and tracks, which have their own times", rate=rate)

    wish = Wish(
        avatar=find_avatar(avatar),
        components=components,
        size=read_size(size),
        neutral=read_rule(neutral, neutral_sheet),
        crop=read_crop(crop),
        side_by_side=side_by_side,
        background=read_colour(background),
        head_pose=not no_head_pose,
        resume=resume,
        engine=engine,
        driving=driver,
        rate=read_rate(rate or "30"),
        track=track,
        no_badge=read_reason(no_badge),
        name_driver=name_driver,
    )
    return run(list(drivers), out, wish, report)


def demo(
    *,
    out: Out = "demo.mp4",
    avatar: AvatarName = None,
    engine: EngineName = "auto",
    window: bool = True,
    no_badge: NoBadge = None,
) -> int:
    """Run a shipped avatar on the shipped clip, driver and avatar side by side, and show it where there is a display.

    Args:
        out: The video to write.
        avatar: Name of an avatar or a .gem file.
        engine: What draws; auto measures once and takes the faster.
        window: Then open the live window with the same clip (Ctrl+Q quits); only where there is a display.
        no_badge: Leave the SYNTHETIC badge out, and why.
    """
    from ..credentials.reasons import read_reason
    from ..demo import run_demo

    return run_demo(out, avatar, engine, window, read_reason(no_badge))


def track(
    driver: str,
    /,
    *,
    out: Out,
    avatar: AvatarName = None,
    neutral: str = "auto",
    neutral_sheet: Path | None = None,
    crop: str = "whole",
    with_driver: Annotated[DriverName, Parameter(name="--driver")] = "learned",
    rate: str | None = None,
) -> int:
    """Follow a face and keep what the avatar would do, as a file for `reenact --track` and `export --track`.

    Args:
        driver: A video, a folder of pictures, or numbered pictures.
        out: The track to write (safetensors).
        avatar: Name of an avatar or a .gem file; the track belongs to it.
        neutral: The driver's face at rest: auto, first, frame=N, time=S, image=PATH, or profile=NAME (taken live with
            that camera).
        neutral_sheet: A PNG of the best six frames auto chose from, and why; it shows the driver's face.
        crop: Which part of the pictures is looked at, where several people are seen or the face is small: left or right
            (halves), X,Y,WIDTH,HEIGHT in percent, or whole.
        with_driver: learned uses the avatar's regressor, baseline the tracker's scores directly.
        rate: Frames per second of pictures. Default: 30.
    """
    from ..files.crop import read_crop
    from ..files.sources import have_times
    from ..library import find_avatar
    from ..person.neutrals import read_rule
    from ..reenacting.tracking import run_tracking
    from ..words import read_rate, refuse

    if have_times([driver]):
        refuse("videos, which have their own times", rate=rate)
    rule = read_rule(neutral, neutral_sheet)
    return run_tracking(
        driver, Path(out), find_avatar(avatar), rule, with_driver, read_rate(rate or "30"), read_crop(crop)
    )
