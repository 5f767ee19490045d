"""``gemheads distill``: a capture, a run, or somebody else's avatar becomes an avatar of our own."""

import json
import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ...models.captures.layout import CaptureError
from ...models.gem import MODALITIES, Gem
from ...models.gemfile import GemFormatError, save_gem
from ...models.gemheader import MAX_HEADER_BYTES
from ...models.importers.adopt import TooLargeError, adopt
from ...models.importers.foreign import ForeignFormatError
from ...models.wholefile import file_sha256
from ..errors import ExitCode, InputError, OutputError, UsageError, cannot_write, no_way_to
from ..files.places import check_avatar_name, check_places
from ..performing.performance import Pose
from ..progress import ProgressBar
from .distillable import Opened, Wanted, open_source
from .moments import save_moments

ORIGIN = ("author", "licence", "consent")
"""What only the person at the keyboard knows, and the file keeps."""
MOST_TEXT = MAX_HEADER_BYTES // 2
"""Bytes of it in a file's header; the other half is for what else it says."""


def run_distilling(place: str, out: Path, wanted: Wanted) -> ExitCode:
    """Read, distil, save, and say what came of it. Raises CommandError."""
    check_avatar_name(out)
    about = {key: wanted.about[key] for key in ORIGIN if wanted.about.get(key, "").strip()}
    _check_texts(wanted.name or out.stem, about)
    with ProgressBar() as bar:
        for key in ORIGIN[1:]:
            if key not in about:
                bar.say(f"{out}: will say '{key}: not stated'; give --{key} TEXT ({_WHY[key]})")
        try:
            opened = open_source(place, wanted, bar.reach)
            source = opened.source
            about["source"] = f"{source.kind} {Path(place).name}, {source.count} frames"
            check_places(out, wanted.moments, read=[Path(place), wanted.meshes])
            gem, distilled = adopt(source, wanted.name or out.stem, wanted.components, about, bar.reach)
        except TooLargeError as error:
            raise UsageError(f"{place}: {error}") from error
        except (ForeignFormatError, CaptureError) as error:
            raise InputError(str(error)) from error
        except ValueError as error:
            raise InputError(f"{place}: {error}; leave that frame out") from error
        except OSError as error:  # frames wait on the disk
            if said := no_way_to(error):
                raise InputError(said) from error
            where = tempfile.gettempdir()
            raise OutputError(
                f"{where}: no room for the frames ({error.strerror}); free some space, or set TMPDIR to a larger place"
            ) from error
        for note in source.notes:
            bar.say(f"{place}: {note}")
        if not gem.coefficient_count:
            bar.say(f"{out}: does not move, so no face can drive it; give several frames that differ")
    try:
        save_gem(gem, out)
    except GemFormatError as error:
        raise InputError(f"{place}: gives no sound avatar: {error.what}; {error.cure}") from error
    except OSError as error:
        raise cannot_write(out, error) from error
    if wanted.moments is not None:
        _save_moments(gem, out, opened, wanted.moments)
    for modality in MODALITIES:
        print(f"{modality:9}{_kept(distilled.variance_kept[modality], wanted.components)}")
    print(f"{out}: {len(gem)} splats from {distilled.frames} frames, {out.stat().st_size / 1e6:.2f} MB")
    return ExitCode.OK


def _check_texts(name: str, about: Mapping[str, str]) -> None:
    """Raises UsageError for more than a file's header keeps: it is written as JSON in JSON."""
    length = len(json.dumps(json.dumps([name, about])))
    if length > MOST_TEXT:
        raise UsageError(f"--name, --author, --licence, --consent: {length} bytes, {MOST_TEXT} are kept; shorten them")


def _save_moments(gem: Gem, avatar: Path, opened: Opened, out: Path) -> None:
    """What the avatar does at each moment of its capture, as a track."""
    assert opened.capture is not None
    moments = {}
    for timestep, frame in zip(opened.source.moments, opened.source.frames(), strict=True):
        tracked = opened.capture.tracked(timestep)
        moments[timestep] = Pose(gem.project(frame), tracked.rotation, translation=tracked.translation)
    save_moments(gem.name, file_sha256(avatar), moments, out)


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
