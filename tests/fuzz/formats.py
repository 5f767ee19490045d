"""Every kind of file that comes from somebody else: how it is made, mutated and read, and its reader's one error."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from random import Random

import numpy as np
from gemheads.app.desk.keys import keymap
from gemheads.app.desk.settings import load_settings, recalled
from gemheads.app.desk.state import DeskState
from gemheads.app.errors import InputError
from gemheads.app.files.sources import open_source
from gemheads.app.inputs.packets import PacketError, read_ifacialmocap, read_vmc
from gemheads.app.making.cameras import load_camera
from gemheads.app.performing.tracks import load_track
from gemheads.app.performing.weights import load_weights
from gemheads.app.person.profiles import kept_cameras, load_profile, profile_path
from gemheads.models import mediafile, picturefile
from gemheads.models.captures.layout import TEMPLATE, CaptureError, transforms_name
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.regressor import Regressor, RegressorError
from gemheads.models.gemfile import GemFormatError, load_gem, read_info
from gemheads.models.importers.foreign import ForeignFormatError
from gemheads.models.importers.lam import load_lam
from gemheads.models.importers.plysequence import open_sequence

from . import captures, glbs, graphs, honest, pngs, tensorfiles, texts
from .damage import damaged


@dataclass(frozen=True)
class Format:
    """One kind of file."""

    honest: Callable[[Path], bytes]
    """A folder -> a small file that opens; what it needs beside it is put into the folder."""
    mutated: Callable[[bytes, Random], bytes]
    read: Callable[[Path], object]
    """All that the program ever reads of such a file."""
    error: type[Exception]
    """The one exception that ``read`` may raise."""
    name: str = "input"
    """What the file is called in the folder."""
    memory: int = 24 * 2**20
    """Bytes that reading may take beyond twice what the honest file takes: buffers of decoders and threads, and the
    pixels of the largest picture that a file may claim to hold."""


def _gem(path: Path) -> None:
    for read in (lambda: load_gem(path), lambda: read_info(path)):
        with suppress(GemFormatError):
            read()


def _track(path: Path) -> None:
    track = load_track(path)
    assert float(track.time_base) > 0
    assert all(np.isfinite(pose.coefficients).all() for _, pose, _ in track)


def _weights(path: Path) -> None:
    assert np.isfinite(load_weights(path).weights).all()


def _lam(path: Path) -> None:
    assert np.isfinite(load_lam(path.parent).frame(np.ones(52)).positions).all()


def _ply(path: Path) -> None:
    for frame in open_sequence(path).frames():
        assert np.isfinite(frame.positions).all()


def _settings(path: Path) -> None:
    settings, _ = load_settings(path)
    recalled(DeskState(), settings)
    keymap(settings.keys)


def _onnx(path: Path) -> None:
    answer = Regressor(path.read_bytes(), honest.COMPONENTS)(np.ones(DIMENSION), np.ones(3))
    assert answer.coefficients.shape == (honest.COMPONENTS,)
    assert answer.turn.shape == (3,)
    assert np.isfinite(answer.coefficients).all()
    assert np.isfinite(answer.turn).all()


def _profile(path: Path) -> None:
    kept_cameras(path.parent)
    load_profile(honest.CAMERA_NAME, path.parent)


def _driver(path: Path) -> None:
    source = open_source(str(path))
    for _ in source.frames():
        pass
    source.samples(4)


def _osc(path: Path) -> None:
    for read in (read_vmc, read_ifacialmocap):
        with suppress(PacketError):
            read(path.read_bytes())


def _gem_bytes(content: bytes, rng: Random) -> bytes:
    return tensorfiles.mutated(content, rng, tensorfiles.seal_gem)


PICTURE = 2 * 3 * picturefile.MAX_PIXELS
VIDEO = 24 * 2 * mediafile.MAX_PIXELS
FORMATS = {
    "gem": Format(honest.gem, _gem_bytes, _gem, GemFormatError, "input.gem"),
    "track": Format(honest.track, tensorfiles.mutated, _track, InputError),
    "weights": Format(honest.weights, tensorfiles.mutated, _weights, InputError),
    "profile": Format(
        honest.profile, tensorfiles.mutated, _profile, InputError, profile_path(honest.CAMERA_NAME, Path()).name
    ),
    "ply": Format(honest.ply, texts.mutated_ply, _ply, ForeignFormatError, "input.ply"),
    "glb": Format(honest.glb, glbs.mutated, _lam, ForeignFormatError, "skin.glb"),
    "camera": Format(honest.camera, texts.mutated_json, load_camera, InputError),
    "capture": Format(captures.transforms, texts.mutated_json, captures.read, CaptureError, transforms_name("train")),
    "template": Format(captures.template, captures.mutated_npz, captures.read, CaptureError, TEMPLATE),
    "settings": Format(honest.settings, texts.mutated_text, _settings, AssertionError, "live.toml"),
    "onnx": Format(honest.onnx, graphs.mutated, _onnx, RegressorError),
    "video": Format(honest.video, damaged, _driver, InputError, "input.mp4", VIDEO),
    "png": Format(honest.png, pngs.mutated, _driver, InputError, "input.png", PICTURE),
    "jpeg": Format(honest.jpeg, damaged, _driver, InputError, "input.jpg", PICTURE),
    "webp": Format(honest.webp, damaged, _driver, InputError, "input.webp", PICTURE),
    "tiff": Format(honest.tiff, damaged, _driver, InputError, "input.tiff", PICTURE),
    "bmp": Format(honest.bmp, damaged, _driver, InputError, "input.bmp", PICTURE),
    "osc": Format(honest.osc, damaged, _osc, PacketError),
}
"""Name -> format."""
