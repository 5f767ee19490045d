"""Commands about an avatar by itself: info, modes, export, distill, fit and train-regressor."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import ExitCode, UsageError
from .options import EngineName, Out, Seed, Size, Whole


def info(file: str | None = None, /) -> int:
    """Say what is in an avatar's file; without one, list the avatars there are.

    Args:
        file: Name of an avatar or a .gem file.
    """
    from ..library import avatars, find_avatar, user_folder

    if file is None:
        for entry in avatars():
            print(f"{entry.name:16} {'shipped' if entry.shipped else 'yours':8} {entry.path}")
        print(f"Your own avatars belong in {user_folder()}")
        return ExitCode.OK
    from ..info import describe

    print(describe(find_avatar(file)))
    return ExitCode.OK


def modes(
    file: str, /, *, out: Out, components: Whole | None = None, size: Size = "256x256", engine: EngineName = "auto"
) -> int:
    """Draw what single components do, from -3 to +3 sigma (figure 3 of the paper).

    Args:
        file: Name of an avatar or a .gem file.
        out: The PNG to write.
        components: How many components of each modality. Default: the first 5.
        size: Width x height of each picture.
        engine: What draws.
    """
    from ..library import find_avatar
    from ..modes import draw_modes
    from ..words import read_size

    draw_modes(find_avatar(file), Path(out), components, read_size(size), engine)
    print(out)
    return ExitCode.OK


def export(
    file: str,
    /,
    *,
    out: Out,
    weights: Annotated[list[str] | None, Parameter(name="--set", consume_multiple=True)] = None,
    track: Path | None = None,
    components: Whole | None = None,
) -> int:
    """Write splats as PLY: one expression, or with --track a numbered sequence in a folder.

    Args:
        file: Name of an avatar or a .gem file.
        out: The .ply to write; with --track a folder.
        weights: ARKit weights of the expression, such as --set jawOpen=0.5 mouthSmileLeft=1. Default: at rest.
        track: A file of `gemheads track`.
        components: How many components a modality. Default: all.
    """
    from ..export import export_expression, export_track
    from ..library import find_avatar

    if track is not None and weights:
        raise UsageError("--set: a track says itself what the face does; leave out one of the two")
    path = find_avatar(file)
    if track is None:
        export_expression(path, Path(out), weights or [], components)
    else:
        export_track(path, track, Path(out), components)
    print(out)
    return ExitCode.OK


def distill(
    source: str,
    /,
    *,
    out: Out,
    components: Whole = 50,
    name: str | None = None,
    author: str = "",
    licence: str = "",
    consent: str = "",
    frames: Whole | None = None,
    scale: float | None = None,
    meshes: Path | None = None,
    maps: Whole | None = None,
    moments: Path | None = None,
    seed: Seed = 0,
) -> int:
    """Make an avatar of a training run, a capture's bare mesh, or somebody else's avatar.

    Args:
        source: The folder of a run or of a capture; a folder with skin.glb and offset.ply (LAM); point_cloud.ply of
            GaussianAvatars, or its folder; or a PLY file of splats, a folder of them, or a quoted pattern.
        out: The .gem to write.
        components: How many components to keep of each modality.
        name: What people call it. Default: the name of the file.
        author: Who made it.
        licence: Under which terms it may be passed on; those of the source hold for the avatar too.
        consent: Whose likeness it is, and what they agreed to.
        frames: How many expressions a LAM avatar performs for it. Default: 600.
        scale: Metres of one unit of the PLY files (y up, the face looks along +z). Default: 1.
        meshes: The mesh of a GaussianAvatars PLY frame by frame: a folder of .npz or .obj. Default: meshes beside it.
        maps: Texels along a side of the UV map of a capture's splats. Default: 128.
        moments: Where to write what the avatar does at each moment of its capture, for `refine --start`.
        seed: Of the performance; the same seed and source give the same file.
    """
    from ..making.distilling import Wanted, run_distilling

    about = {"author": author, "licence": licence, "consent": consent}
    wanted = Wanted(name, components, frames, seed, scale, maps, moments, meshes, about)
    return run_distilling(source, Path(out), wanted)


def fit(
    avatar: str,
    picture: str,
    /,
    *,
    out: Out,
    camera: str | None = None,
    background: str | None = None,
    errors: Path | None = None,
    thorough: Annotated[bool, Parameter(negative="")] = False,
    rate: str | None = None,
    split: str | None = None,
    cameras: str | None = None,
) -> int:
    """Find the expression and the head's pose in pictures of an avatar (extra: pip install 'gemheads[train]').

    Args:
        avatar: Name of an avatar or a .gem file.
        picture: A picture or video of that avatar or person, a folder of pictures, numbered pictures, or a capture.
        out: The track to write, for `reenact --track`.
        camera: portrait, the default, is the view of `reenact`; else a JSON file with the camera of the pictures.
        background: The colour behind the head (#rrggbb or a name); auto, the default, takes that of the first picture's
            upper edge.
        errors: A PNG of the frame that fits least: picture, fit, and where they differ.
        thorough: Take some seconds more for the first frame.
        rate: Frames per second of pictures. Default: 30.
        split: Of a capture: train, val or test. Default: test.
        cameras: Of a capture: which cameras, such as 0,3. Default: four, spread over all.
    """
    from ..library import find_avatar
    from ..making.capturefitting import CaptureWish, run_capture_fitting
    from ..making.fitting import AUTO, PORTRAIT, FitWish, run_fitting
    from ..making.opencapture import is_capture
    from ..words import read_rate, refuse

    if is_capture(Path(picture)):
        refuse("a capture", camera=camera, background=background, rate=rate)
        footage = CaptureWish(split or CaptureWish.split, cameras, errors, thorough)
        return run_capture_fitting(Path(picture), Path(out), find_avatar(avatar), footage)
    refuse("pictures and videos", split=split, cameras=cameras)
    wish = FitWish(camera or PORTRAIT, background or AUTO, errors, thorough, read_rate(rate or "30"))
    return run_fitting(picture, Path(out), find_avatar(avatar), wish)


def train_regressor(
    avatar: str,
    /,
    *sources: Path,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    companions: Annotated[list[str] | None, Parameter(consume_multiple=True)] = None,
    rehearse_with: str | None = None,
    take_over: str | None = None,
    turns_only: bool = False,
    pictures: Whole | None = None,
    steps: Whole | None = None,
    seed: Seed | None = None,
    jobs: Whole | None = None,
    labels: Path | None = None,
    report: Path | None = None,
    strip: Path | None = None,
) -> int:
    """Learn how an avatar answers a face (needs the extra: pip install 'gemheads[train]').

    Args:
        avatar: Name of an avatar or a .gem file.
        sources: The capture of the avatar's person, if there is one, whose frames are then learned from; and face
            videos whose motion the training also learns from, without labels.
        out: Where the avatar with its regressor goes. Default: the same file, unless it ships.
        companions: Other avatars, which play strangers. Default: the other shipped ones.
        rehearse_with: An avatar with ARKit shapes and a regressor: what it would answer is what this one acts first, to
            learn how that reads on it. Default: what it has learned before, if it has.
        take_over: An avatar with ARKit shapes and a regressor: this one does what it has learned, and nothing is
            trained; for an avatar that was baked anew and reads as before.
        turns_only: Learn only how the avatar's head turns, and keep how it answers faces; for an avatar that has a
            regressor.
        pictures: How many random faces of the avatar are drawn and read; 0 with a capture learns from its frames alone.
            Default: 4,000.
        steps: Training steps of a network. Default: 9,000; with a capture 6,000.
        seed: The same seed, avatar and sources give the same regressor. Default: 0.
        jobs: How many processes draw pictures and learn, with one thread each; the regressor does not depend on it.
            Default: one for each core, if there is memory for them.
        labels: With a capture: a track of `distill --moments`, `refine --moments` or `fit --split train` with what the
            avatar does at its moments. Default: they are fitted.
        report: With a capture: where figures on its held-out pictures go, as JSON.
        strip: With a capture: a PNG of held-out moments: the person, at rest, driven, fitted, and where it differs.
    """
    from ..errors import UsageError
    from ..library import SHIPPED, avatars, find_avatar
    from ..making.opencapture import is_capture
    from ..making.owntraining import OwnWish, run_own_training
    from ..making.training import TrainingWish, run_taking_over, run_training
    from ..words import refuse

    path = find_avatar(avatar)
    if take_over is not None:
        learns = companions, rehearse_with, turns_only or None, pictures, steps, seed, jobs, labels, report, strip
        if sources or any(given is not None for given in learns):
            raise UsageError("--take-over trains nothing; leave out captures, videos and what else training takes")
        return run_taking_over(path, out, find_avatar(take_over))
    others = [entry.path for entry in avatars(((SHIPPED, True),)) if entry.name != path.stem]
    if companions is not None:
        others = [find_avatar(name) for name in companions]
    drawn = TrainingWish.pictures if pictures is None else pictures
    chance = TrainingWish.seed if seed is None else seed
    captures = [source for source in sources if is_capture(source)]
    videos = [source for source in sources if source not in captures]
    if not captures:
        if labels or report or strip:
            raise UsageError("--labels, --report and --strip need a capture; give its folder, too")
        former = None if rehearse_with is None else find_avatar(rehearse_with)
        lasting = TrainingWish.steps if steps is None else steps
        if turns_only and former is not None:
            raise UsageError("--rehearse-with has no effect with --turns-only; leave one of them out")
        wish = TrainingWish(tuple(videos), tuple(others), former, drawn, lasting, chance, jobs, turns_only)
        return run_training(path, out, wish)
    if turns_only:
        raise UsageError("--turns-only does not go with a capture; leave out one of them")
    if rehearse_with is not None:
        raise UsageError("--rehearse-with does not go with a capture, whose own frames say how its person moves")
    if len(captures) > 1:
        raise UsageError(f"{captures[1]}: is a second capture; an avatar is of one person, give one")
    if drawn == 0:
        refuse("--pictures 0, which learns from the capture's frames alone", companions=companions, jobs=jobs)
        if videos:
            raise UsageError(f"{videos[0]}: does nothing for --pictures 0; leave it out")
    lasting = OwnWish.steps if steps is None else steps
    own = OwnWish(tuple(videos), tuple(others), drawn, lasting, chance, labels, report, strip, jobs)
    return run_own_training(path, captures[0], out, own)
