"""The folder of a training run: what was asked for, how far it came, and the avatar in it."""

import hashlib
import io
import json
import math
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from ....render.diff import cuda
from ....render.diff.tensors import RawTensors
from ....render.gaussians import RawGaussians
from ...captures.layout import SPLITS, Tracked, transforms_name
from ...captures.reader import Capture, open_capture
from ...captures.texels import Texels, texels_of
from ...wholefile import file_sha256, open_ordinary, write_whole
from .avatar import Avatar
from .deform import moment_of
from .kinds import KINDS, untrained
from .plan import Plan

CONFIG, CHECKPOINT, PREVIEWS = "config.json", "checkpoint.pt", "previews"
VERSION = 1
MOST_CONFIG_BYTES = 2**16


class RunError(Exception):
    """A run that cannot be used or continued: what is wrong, in which file, and the cure."""

    def __init__(self, where: Path, what: str, cure: str) -> None:
        super().__init__(f"{where}: {what}; {cure}")
        self.where, self.what, self.cure = where, what, cure


@dataclass(frozen=True)
class Config:
    """config.json."""

    capture: Path
    subject: str
    plan: Plan
    seconds: float | None = 0.0
    """Spent so far, by the clock, previews and checkpoints included; None where the run is from before it was kept."""
    learned_from: str = ""
    """What ``known_by`` says of the capture; empty where the run is from before it was kept."""


@dataclass(frozen=True)
class Run:
    """A trained avatar, ready to answer tracked meshes."""

    folder: Path
    capture: Capture
    plan: Plan
    step: int
    """How many steps it was trained for ..."""
    seconds: float | None
    """... and how long that took; None where it was not kept."""
    texels: Texels
    avatar: Avatar

    def splats(self, tracked: Tracked) -> RawGaussians:
        """The splats of an expression in canonical space; the head's pose is for ``posing.pose_head``."""
        with torch.no_grad():
            raw, _ = self.avatar(
                moment_of(self.texels, tracked, self.avatar.rest.device), self.step <= self.plan.colors_first
            )
        return arrays_of(raw)


def arrays_of(raw: RawTensors) -> RawGaussians:
    """Tensors as NumPy arrays of their own."""
    return RawGaussians(*(np.array(tensor.detach().cpu().numpy(), np.float32, order="C") for tensor in raw))


def open_run(folder: Path, capture: Path | None = None) -> Run:
    """A run as far as it came.

    Args:
        folder: written by ``train_avatar``.
        capture: where its capture lies now; None looks where it lay.

    Raises RunError, and CaptureError where the capture is no longer what it was, or lacks what drives the model.
    """
    config = read_config(folder)
    if config is None:
        raise RunError(folder, "is no training run", f"a run holds {CONFIG}; make one: gemheads train CAPTURE -o RUN")
    state = read_checkpoint(folder)
    if state is None:
        raise RunError(folder, "holds nothing learned yet", "let gemheads train work on it for longer")
    if capture is None and not config.capture.is_dir():
        what = f"its capture is no longer at {config.capture}"
        raise RunError(folder, what, f"bring it back, or say where it is: gemheads train CAPTURE -o {folder}")
    opened = open_capture(config.capture if capture is None else capture)
    KINDS[config.plan.model].require(opened)
    _recognize(folder, config, opened)
    texels = texels_of(opened.template, config.plan.size)
    avatar = untrained(texels, config.plan)
    load(avatar, state["avatar"], folder)
    avatar = avatar.to(default_device()).eval()
    return Run(folder, opened, config.plan, int(state["step"]), config.seconds, texels, avatar)


def default_device() -> torch.device:
    """CUDA where gsplat draws, else the CPU."""
    return torch.device("cpu" if cuda.missing() else "cuda")


def load(avatar: Avatar, weights: Mapping[str, Any], folder: Path) -> None:
    """Puts weights into an avatar. RunError where they are of another one: the capture's template was changed."""
    try:
        avatar.load_state_dict(weights)
    except (RuntimeError, TypeError, AttributeError) as error:
        what = "does not fit its capture's template, which must have changed"
        raise RunError(folder / CHECKPOINT, what, "train again into another folder") from error


def write_config(folder: Path, config: Config) -> None:
    """Raises OSError."""
    told: dict[str, Any] = {"version": VERSION, "capture": str(config.capture.resolve()), "subject": config.subject}
    if config.learned_from:
        told["learned_from"] = config.learned_from
    told["seconds"] = None if config.seconds is None else round(config.seconds, 1)
    text = json.dumps({**told, "plan": asdict(config.plan)}, indent=1)
    write_whole(folder / CONFIG, [text.encode()])


def read_config(folder: Path) -> Config | None:
    """None where the folder holds none. Raises RunError where it cannot be understood."""
    path = folder / CONFIG
    if not path.is_file():
        return None
    try:
        with open_ordinary(path) as (file, size):
            if size > MOST_CONFIG_BYTES:
                raise ValueError(f"{size} bytes are more than a config takes")
            told = json.loads(file.read(MOST_CONFIG_BYTES).decode())
        version = told["version"]
        if version == VERSION:
            known = str(told.get("learned_from", ""))
            return Config(Path(told["capture"]), str(told["subject"]), Plan(**told["plan"]), _seconds(told), known)
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError, OSError) as error:
        raise RunError(path, f"cannot be understood ({str(error)[:200]})", "train again into another folder") from error
    what = f"has version {str(version)[:20]}, this program reads {VERSION}"
    raise RunError(path, what, "use the program that wrote it")


def _seconds(told: Mapping[str, Any]) -> float | None:
    """Raises ValueError, TypeError, OverflowError."""
    seconds = told.get("seconds")
    if seconds is not None and not 0 <= float(seconds) < math.inf:
        raise ValueError(f"seconds {seconds} have not been spent")
    return None if seconds is None else float(seconds)


def write_checkpoint(folder: Path, state: Mapping[str, Any]) -> None:
    """Whole or not at all. Raises OSError."""
    packed = io.BytesIO()
    torch.save(dict(state), packed)
    write_whole(folder / CHECKPOINT, [packed.getbuffer()])


def read_checkpoint(folder: Path) -> dict[str, Any] | None:
    """None where there is none yet. Raises RunError where it is broken; nothing in it is executed."""
    path = folder / CHECKPOINT
    if not path.is_file():
        return None
    try:
        _check_archive(path)
        state = torch.load(path, map_location="cpu", weights_only=True)
        if (step := int(state["step"])) < 0:
            raise ValueError(f"step {step}")
        return {**state, "step": step, "avatar": dict(state["avatar"])}
    except Exception as error:  # torch names many, and a broken archive has its own
        raise broken(folder, error) from error


def _check_archive(path: Path) -> None:
    """Torch writes archives whose entries are as large in the file as in memory; others would fill that. Raises
    ValueError, BadZipFile, OSError."""
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
    if any(entry.compress_type != zipfile.ZIP_STORED for entry in entries):
        raise ValueError("compressed")
    if sum(entry.file_size for entry in entries) > path.stat().st_size:
        raise ValueError("entries lie in one another")


def broken(folder: Path, error: Exception) -> RunError:
    """What to say where a checkpoint holds something else than it should."""
    cure = f"delete {CHECKPOINT} to begin anew"
    return RunError(folder / CHECKPOINT, f"is broken ({type(error).__name__})", cure)


def known_by(capture: Capture) -> str:
    """SHA-256 of what tells a capture from another in its folder: its lists of pictures, its template, all that was
    tracked, and how large pictures and masks are, whose contents would take minutes to read in a large capture.
    Wherever it is moved to, it stays the same. Raises OSError."""
    known = hashlib.sha256(capture.template.digest())
    for split in SPLITS:
        known.update((capture.folder / transforms_name(split)).read_bytes() if capture.shots(split) else b"")
        files = [file for shot in capture.shots(split) for file in (shot.picture, shot.mask) if file is not None]
        known.update(f"{split} {[file.stat().st_size for file in files]}".encode())
    for moment, mesh in sorted(capture.meshes.items()):
        known.update(f"{moment} {file_sha256(mesh)}".encode())
    return known.hexdigest()


def _recognize(folder: Path, config: Config, capture: Capture) -> None:
    """Raises RunError where the capture is another one than was learned of."""
    if config.learned_from and config.learned_from != known_by(capture):
        what = f"learned of another capture than {capture.folder} holds now"
        raise RunError(folder, what, "bring that one back, or train again into another folder")


def begin_run(folder: Path, capture: Capture, plan: Plan) -> Config:
    """Makes the folder and writes its config; a run of the same goes on, with its own. Raises RunError, OSError."""
    config = Config(capture.folder, capture.subject, plan, learned_from=known_by(capture))
    before = read_config(folder)
    if before is None and folder.is_dir() and any(not file.name.startswith(".") for file in folder.iterdir()):
        raise RunError(folder, "is no run, and there is something in it", "name a new folder")
    if before is not None and before.plan != config.plan:
        raise RunError(folder, "holds a run of other settings", "give the same ones to go on, or another folder")
    if before is not None:
        if before.capture.resolve() != config.capture.resolve():
            if before.learned_from != config.learned_from:
                what, cure = f"holds a run of {before.capture}", "give that capture to go on, or another folder"
                raise RunError(folder, what, cure)
            before = replace(before, capture=config.capture)  # it was moved
            write_config(folder, before)
        _recognize(folder, before, capture)
    else:
        folder.mkdir(parents=True, exist_ok=True)
        write_config(folder, config)
    return before or config
