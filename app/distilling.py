"""``gemheads distill``: somebody else's avatar, or frames of splats, become an avatar of our own."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..models.gem import MODALITIES
from ..models.gemfile import GemFormatError, save_gem
from ..models.heads.performance import perform
from ..models.importers.adopt import TooLargeError, adopt
from ..models.importers.foreign import ForeignFormatError
from ..models.importers.gaussianavatars import SPLATS, is_bound, open_bound
from ..models.importers.lam import MESH, load_lam
from ..models.importers.plysequence import MAX_FRAMES, open_sequence
from ..models.importers.source import Source
from .errors import ExitCode, InputError, OutputError, UsageError
from .progress import ProgressBar

LEAST_FRAMES = 150
"""A performance shorter than this leaves out single shapes."""
ORIGIN = ("author", "licence", "consent")
"""What only the person at the keyboard knows, and the file keeps."""


@dataclass(frozen=True)
class Wanted:
    """What the avatar shall be."""

    name: str | None = None
    """None takes the name of the file that is written."""
    components: int = 50
    frames: int = 600
    """How many expressions a source that ARKit weights drive is asked for."""
    seed: int = 0
    """Of the performance."""
    scale: float = 1.0
    """Metres of one unit of PLY files."""
    meshes: Path | None = None
    """Where the mesh of a GaussianAvatars PLY is frame by frame; None looks beside it."""
    about: Mapping[str, str] = field(default_factory=dict)
    """author, licence, consent; empty texts are not stated."""


def run_distilling(place: str, out: Path, wanted: Wanted) -> ExitCode:
    """Read, distil, save, and say what came of it. Raises CommandError."""
    if out.suffix != ".gem":
        raise UsageError(f"{out}: an avatar's file is called .gem, such as -o {out.with_suffix('.gem').name}")
    about = {key: wanted.about[key] for key in ORIGIN if wanted.about.get(key, "").strip()}
    with ProgressBar() as bar:
        for key in ORIGIN[1:]:
            if key not in about:
                bar.say(f"{out}: will say '{key}: not stated'; give --{key} TEXT ({_WHY[key]})")
        try:
            source = open_source(place, wanted)
            about["source"] = f"{source.kind} {Path(place).name}, {source.count} frames"
            gem, distilled = adopt(source, wanted.name or out.stem, wanted.components, about, bar.reach)
        except TooLargeError as error:
            raise UsageError(f"{place}: {error}") from error
        except ForeignFormatError as error:
            raise InputError(str(error)) from error
        except ValueError as error:
            raise InputError(f"{place}: {error}; leave that frame out") from error
        for note in source.notes:
            bar.say(f"{place}: {note}")
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        save_gem(gem, out)
    except GemFormatError as error:
        raise InputError(f"{place}: gives no sound avatar: {error.what}; {error.cure}") from error
    except OSError as error:
        raise OutputError(f"{out}: cannot be written ({error.strerror}); check the folder and the space") from error
    for modality in MODALITIES:
        print(f"{modality:9}{_kept(distilled.variance_kept[modality], wanted.components)}")
    print(f"{out}: {len(gem)} splats from {distilled.frames} frames, {out.stat().st_size / 1e6:.2f} MB")
    return ExitCode.OK


def open_source(place: str, wanted: Wanted) -> Source:
    """The importer that fits: a folder with ``skin.glb`` (or one folder that has it) is a LAM avatar, a PLY whose
    splats are bound to triangles one of GaussianAvatars, all else a sequence of PLY files.

    Raises UsageError and ForeignFormatError.
    """
    path = Path(place)
    if not LEAST_FRAMES <= wanted.frames <= MAX_FRAMES:
        raise UsageError(f"--frames {wanted.frames}: choose from {LEAST_FRAMES} to {MAX_FRAMES}")
    if not 1e-6 <= wanted.scale <= 1e6:
        raise UsageError(f"--scale {wanted.scale}: give the metres of one of its units, such as 0.01 for centimetres")
    inner = [path, *(sub for sub in sorted(path.iterdir()) if sub.is_dir())] if path.is_dir() else []
    lams = [folder for folder in inner if (folder / MESH).exists()]
    if len(lams) == 1:
        return load_lam(lams[0]).source(perform(np.random.default_rng(wanted.seed), wanted.frames))
    if lams:
        raise UsageError(f"{place}: holds {len(lams)} avatars; give one, such as {lams[0]}")
    if path.suffix in (".zip", ".glb", ".gem"):
        raise UsageError(f"{place}: give a folder with {MESH} and offset.ply (unpack a .zip first), or PLY files")
    splats = path / SPLATS if path.is_dir() else path
    if wanted.meshes is not None or (splats.suffix == ".ply" and splats.is_file() and is_bound(splats)):
        return open_bound(splats, wanted.meshes, wanted.scale)
    return open_sequence(path, wanted.scale)


def _kept(shares: np.ndarray, components: int) -> str:
    if not len(shares):
        return "does not move"
    some = sorted({min(len(shares), 10), min(len(shares), 20), len(shares)})
    fewer = "" if len(shares) >= components else " (there is no more motion in it)"
    return ", ".join(f"{count} components keep {shares[count - 1]:.3%}" for count in some) + fewer


_WHY = {
    "licence": "under which terms may it be passed on?",
    "consent": "whose likeness is it, and what did they agree to?",
}
