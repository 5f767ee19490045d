"""The ``gemheads`` command: one function per command.

What a command needs is imported when it runs, so that --help is instant.
"""

import os
import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, CycloptsError, Parameter

from .errors import CommandError, ExitCode

EXIT_CODES = """Exit codes: 0 done, 1 unexpected failure, 2 wrong usage, 3 an input cannot be used, 4 no face anywhere,
5 the output cannot be written, 130 stopped with Ctrl-C. Errors are one line on stderr; --debug adds the traceback."""

app = App(
    name="gemheads",
    help="A face video in, an acting 3D head out: offline, on an ordinary computer.",
    help_epilogue=EXIT_CODES,
    version_flags=["--version"],
    suppress_keyboard_interrupt=False,
)

Out = Annotated[str, Parameter(name=["--out", "-o"])]
AvatarName = Annotated[str | None, Parameter(name="--avatar")]
Size = Annotated[str, Parameter(name="--size")]
EngineName = Literal["auto", "quads", "software"]
DriverName = Literal["learned", "baseline"]


@app.command
def reenact(
    *drivers: str,
    out: Out,
    avatar: AvatarName = None,
    components: int | None = None,
    size: Size = "512x512",
    neutral: str = "auto",
    neutral_sheet: Path | None = None,
    side_by_side: Annotated[bool, Parameter(negative="")] = False,
    background: str = "grey",
    no_head_pose: Annotated[bool, Parameter(negative="")] = False,
    report: Path | None = None,
    resume: Annotated[bool, Parameter(negative="")] = False,
    track: Path | None = None,
    engine: EngineName = "auto",
    driver: DriverName = "learned",
    rate: str = "30",
) -> int:
    """Let an avatar act what the faces in videos do.

    Args:
        drivers: Videos, folders of pictures, or numbered pictures (shot_%04d.png). None is needed with --track.
        out: Result: .mp4, .mov, .webm, or a folder for PNGs; with several drivers a folder of results.
        avatar: Name of an avatar (`gemheads info` lists them) or a .gem file.
        components: How many components a modality to draw with; fewer is faster and coarser. Default: all.
        size: Width x height of the avatar's picture in pixels, both even.
        neutral: The driver's face at rest: auto, first, frame=N, time=S or image=PATH.
        neutral_sheet: A PNG of the best six frames auto chose from, and why; it shows the driver's face. With several
            drivers a folder.
        side_by_side: Put the driver's picture beside the avatar's.
        background: A colour (#rrggbb or a name) or transparent (.mov, .webm or PNGs).
        no_head_pose: Keep the head still; only the expression is followed.
        report: Write what happened as JSON: frames, losses, clamp share, neutral, milliseconds by stage.
        resume: Leave finished results alone; continue folders of PNGs.
        track: Play a file of `gemheads track`; a driver beside it adds its sound and picture.
        engine: What draws; auto measures once and takes the faster.
        driver: learned uses the avatar's regressor, baseline the tracker's scores directly.
        rate: Frames per second of pictures, such as 25 or 30000/1001.
    """
    from .library import find_avatar
    from .neutrals import read_rule
    from .reenact import Wish
    from .reenact import reenact as run
    from .words import read_colour, read_rate, read_size

    wish = Wish(
        avatar=find_avatar(avatar),
        components=components,
        size=read_size(size),
        neutral=read_rule(neutral, neutral_sheet),
        side_by_side=side_by_side,
        background=read_colour(background),
        head_pose=not no_head_pose,
        resume=resume,
        engine=engine,
        driving=driver,
        rate=read_rate(rate),
        track=track,
    )
    return run(list(drivers), out, wish, report)


@app.command
def demo(
    *,
    out: Out = "demo.mp4",
    avatar: AvatarName = None,
    engine: EngineName = "auto",
    window: bool = True,
) -> int:
    """Run a shipped avatar on the shipped clip, driver and avatar side by side, and show it where there is a display.

    Args:
        out: The video to write.
        avatar: Name of an avatar or a .gem file.
        engine: What draws; auto measures once and takes the faster.
        window: Play the result in a window (closes with Esc or Ctrl+Q); only where there is a display.
    """
    from .demo import run_demo

    return run_demo(out, avatar, engine, window)


@app.command
def info(file: str | None = None, /) -> int:
    """Say what is in an avatar's file; without one, list the avatars there are.

    Args:
        file: Name of an avatar or a .gem file.
    """
    from .library import avatars, find_avatar, user_folder

    if file is None:
        for entry in avatars():
            print(f"{entry.name:16} {'shipped' if entry.shipped else 'yours':8} {entry.path}")
        print(f"Your own avatars belong in {user_folder()}")
        return ExitCode.OK
    from .info import describe

    print(describe(find_avatar(file)))
    return ExitCode.OK


@app.command
def modes(file: str, /, *, out: Out, components: int = 5, size: Size = "256x256", engine: EngineName = "auto") -> int:
    """Draw what single components do, from -3 to +3 sigma (figure 3 of the paper).

    Args:
        file: Name of an avatar or a .gem file.
        out: The PNG to write.
        components: How many components of each modality.
        size: Width x height of each picture.
        engine: What draws.
    """
    from .library import find_avatar
    from .modes import draw_modes
    from .words import read_size

    draw_modes(find_avatar(file), Path(out), components, read_size(size), engine)
    print(out)
    return ExitCode.OK


@app.command
def export(
    file: str,
    /,
    *,
    out: Out,
    weights: Annotated[list[str] | None, Parameter(name="--set", consume_multiple=True)] = None,
    track: Path | None = None,
    components: int | None = None,
) -> int:
    """Write splats as PLY: one expression, or with --track a numbered sequence in a folder.

    Args:
        file: Name of an avatar or a .gem file.
        out: The .ply to write; with --track a folder.
        weights: ARKit weights of the expression, such as --set jawOpen=0.5 mouthSmileLeft=1. Default: at rest.
        track: A file of `gemheads track`.
        components: How many components a modality. Default: all.
    """
    from .export import export_expression, export_track
    from .library import find_avatar

    path = find_avatar(file)
    if track is None:
        export_expression(path, Path(out), weights or [], components)
    else:
        export_track(path, track, Path(out), components)
    print(out)
    return ExitCode.OK


@app.command
def bench(
    *,
    avatar: AvatarName = None,
    json: Path | None = None,
    quick: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Measure drawing on this machine: median milliseconds by stage and frames per second.

    Args:
        avatar: Name of an avatar or a .gem file to measure besides the synthetic scenes.
        json: Also write the figures as JSON.
        quick: Only the smallest scene.
    """
    from .bench import run_bench

    run_bench(json=json, quick=quick, avatar=avatar)
    return ExitCode.OK


@app.command
def doctor() -> int:
    """Check what works on this machine, with the cure for what does not."""
    from .doctor import run_doctor

    return run_doctor()


@app.command
def track(
    driver: str,
    /,
    *,
    out: Out,
    avatar: AvatarName = None,
    neutral: str = "auto",
    neutral_sheet: Path | None = None,
    with_driver: Annotated[DriverName, Parameter(name="--driver")] = "learned",
    rate: str = "30",
) -> int:
    """Follow a face and keep what the avatar would do, as a file for `reenact --track` and `export --track`.

    Args:
        driver: A video, a folder of pictures, or numbered pictures.
        out: The track to write (safetensors).
        avatar: Name of an avatar or a .gem file; the track belongs to it.
        neutral: The driver's face at rest: auto, first, frame=N, time=S or image=PATH.
        neutral_sheet: A PNG of the best six frames auto chose from, and why; it shows the driver's face.
        with_driver: learned uses the avatar's regressor, baseline the tracker's scores directly.
        rate: Frames per second of pictures.
    """
    from .library import find_avatar
    from .neutrals import read_rule
    from .tracking import run_tracking
    from .words import read_rate

    rule = read_rule(neutral, neutral_sheet)
    return run_tracking(driver, Path(out), find_avatar(avatar), rule, with_driver, read_rate(rate))


@app.command
def train_regressor(
    avatar: str,
    /,
    *videos: Path,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    companions: Annotated[list[str] | None, Parameter(consume_multiple=True)] = None,
    pictures: int = 6000,
    steps: int = 8000,
    seed: int = 0,
) -> int:
    """Learn how an avatar answers a face (needs the extra: pip install 'gemheads[train]').

    Args:
        avatar: Name of an avatar or a .gem file.
        videos: Face videos whose motion the training also learns from; no labels needed.
        out: Where the avatar with its regressor goes. Default: the same file.
        companions: Other avatars, which play strangers. Default: the other shipped ones.
        pictures: How many pictures of the avatar are drawn and read.
        steps: Training steps.
        seed: The same seed, avatar and videos give the same regressor.
    """
    from .library import avatars, find_avatar
    from .training import run_training

    path = find_avatar(avatar)
    others = [entry.path for entry in avatars() if entry.shipped and entry.path != path]
    if companions is not None:
        others = [find_avatar(name) for name in companions]
    return run_training(path, out, list(videos), others, pictures, steps, seed)


def main(arguments: list[str] | None = None) -> int:
    """Run one command; returns the exit code of docs/commands.md. The entry point of ``gemheads``."""
    # Idle workers of BLAS (107 -> 87 ms a picture without) and of the kernels (beside a busy tracker, composing takes
    # 60 ms instead of 6) spin and starve the other stages. Both must be set before NumPy and numba come.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    arguments = sys.argv[1:] if arguments is None else arguments
    debug = "--debug" in arguments
    try:
        result = app(
            [word for word in arguments if word != "--debug"],
            exit_on_error=False,
            print_error=False,
            result_action="return_value",
        )
        return int(result or ExitCode.OK)
    except CycloptsError as error:
        print(f"error: {error} See gemheads --help.", file=sys.stderr)
        return ExitCode.USAGE
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return ExitCode.INTERRUPTED
    except BrokenPipeError:
        return ExitCode.OUTPUT
    except Exception as error:
        if debug:
            raise
        known = isinstance(error, CommandError)
        hint = "" if known else f"unexpected {type(error).__name__}: "
        print(f"error: {hint}{error}{'' if known else '; run again with --debug to see where'}", file=sys.stderr)
        return error.code if isinstance(error, CommandError) else ExitCode.UNEXPECTED


if __name__ == "__main__":
    sys.exit(main())
