"""What has been judged of an avatar, kept so that an evaluation goes on where it was stopped."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...captures.heldout import viewers
from ...captures.layout import TEMPLATE, CaptureError, Shot
from ...captures.reader import Capture
from ...metrics.tables import METRICS
from ...wholefile import file_sha256, write_whole
from .contestants import Act

VERSION = 1
"""Of the file, and of how things are judged: another one, and all is judged anew."""
AT_STAKE = 50
"""One part in so many of what is judged may be lost by a kill: the file is written whole each time."""


@dataclass(frozen=True)
class Record:
    """One picture, judged."""

    act: Act
    values: dict[str, float | None]
    """METRICS -> value."""


class Ledger:
    """The records of one avatar, by the key of what was judged. Call ``save`` at the end, whatever ends it."""

    def __init__(self, path: Path, sha256: str) -> None:
        """Goes on with the file at ``path`` where it is sound and of the avatar with this hash, else begins anew."""
        self._path, self._sha256 = path, sha256
        self._records = _read(path, sha256)
        self._unsaved = 0

    def __len__(self) -> int:
        return len(self._records)

    def get(self, key: str) -> Record | None:
        """None where it has not been judged."""
        return self._records.get(key)

    def put(self, key: str, record: Record) -> None:
        """One more. Raises OSError."""
        self._records[key] = record
        self._unsaved += 1
        if self._unsaved * AT_STAKE >= len(self._records):
            self.save()

    def save(self) -> None:
        """Whole or not at all. Raises OSError."""
        if not self._unsaved:
            return
        told = {key: {"values": record.values, "act": _act_json(record.act)} for key, record in self._records.items()}
        text = json.dumps({"version": VERSION, "avatar": self._sha256, "judged": told})
        self._path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(self._path, [text.encode()])
        self._unsaved = 0


class ShotKeys:
    """Names what a record depends on beside the avatar: pixels, cameras and meshes, and how they are judged."""

    def __init__(self, capture: Capture, judged_by: Sequence[str]) -> None:
        """``judged_by``: what else changes the figures, such as the network of LPIPS."""
        self._capture = capture
        self._hashes: dict[Path, str] = {}
        self._common = [VERSION, list(judged_by), list(capture.background), self._hash(capture.folder / TEMPLATE)]

    def key(self, split: str, shot: Shot) -> str:
        """SHA-256 in hexadecimal. Raises CaptureError where a file is gone."""
        seen = [shot, *viewers(self._capture, split, shot)]
        mesh = self._hash(self._capture.meshes[shot.timestep])
        parts = [*self._common, split, shot.timestep, mesh, [self._picture(other) for other in seen]]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    def _picture(self, shot: Shot) -> list[Any]:
        camera = shot.camera
        lens = [camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height]
        mask = None if shot.mask is None else self._hash(shot.mask)
        place = camera.world_to_camera.ravel().tolist()
        ground = self._capture.ground(shot)
        other = [] if ground == self._capture.background else [list(ground)]
        return [shot.camera_index, self._hash(shot.picture), mask, lens, place, *other]

    def _hash(self, path: Path) -> str:
        if path not in self._hashes:
            try:
                self._hashes[path] = file_sha256(path)
            except OSError as error:
                what = f"cannot be read ({error.strerror})"
                raise CaptureError(path, what, "the capture changed while it was used") from error
        return self._hashes[path]


def _read(path: Path, sha256: str) -> dict[str, Record]:
    """Empty where there is nothing, or nothing to be trusted: all can be judged again."""
    try:
        told = json.loads(path.read_text("utf-8"))
        if told["version"] != VERSION or told["avatar"] != sha256:
            return {}
        return {str(key): _record(record) for key, record in told["judged"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, OverflowError):
        return {}


def _record(told: Any) -> Record:
    act = told["act"]
    coefficients, turn, move = (
        None if act[name] is None else np.array(act[name], np.float32) for name in ("coefficients", "turn", "move")
    )
    values = {name: None if told["values"][name] is None else float(told["values"][name]) for name in METRICS}
    return Record(Act(coefficients, turn, move, tuple(map(int, act["cameras"])), float(act["seconds"])), values)


def _act_json(act: Act) -> dict[str, Any]:
    """Nine digits give a float32 back as it was."""
    arrays = {"coefficients": act.coefficients, "turn": act.turn, "move": act.move}
    plain = {
        name: None if values is None else [float(f"{value:.9g}") for value in values] for name, values in arrays.items()
    }
    return {**plain, "cameras": list(act.cameras), "seconds": round(act.seconds, 3)}
