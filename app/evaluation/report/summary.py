"""Records of judged pictures as the plain values of report.json; the page is made of the same."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ....models.captures.layout import Shot
from ....models.captures.reader import Capture
from ....models.metrics.tables import DATA_SET, PUBLISHED

if TYPE_CHECKING:
    from ....models.train.judging.ledger import Record

VERSION = 2
TITLES = {"val": "Novel view", "test": "Novel expression"}
ABOUT = {
    "val": "a camera that was held out, at moments that were learned from (Table 1 of the paper)",
    "test": "expressions that were held out, from all cameras in turn (Table 2 of the paper)",
}
Values = Mapping[str, float | None]


@dataclass(frozen=True)
class Column:
    """One avatar of the tables."""

    name: str
    kind: str
    """GEM, or what model a run is: CNN, mesh-rigged, blendshapes."""
    driven_by: str
    sha256: str
    """Of its file; of a run's checkpoint."""
    splats: int
    components: int | None
    """Stored, of the largest basis; None for a run."""
    megabytes: float
    source: str
    """What the avatar says it was made of."""
    steps: int | None = None
    """That a run was trained for ..."""
    seconds: float | None = None
    """... and how long they took by the clock of whatever machine it was."""


def split_table(
    split: str, capture: Capture, shots: Sequence[Shot], records: Mapping[str, Sequence["Record"]]
) -> dict[str, Any]:
    """One split: means, means of each camera, and every picture.

    Args:
        split: val or test.
        capture: what the shots are of; pictures are named relative to its folder.
        shots: that were judged.
        records: avatar's name -> a record for each of them.
    """
    cameras = sorted({shot.camera_index for shot in shots})
    by_camera = {
        str(camera): {
            name: means([r.values for shot, r in zip(shots, of, strict=True) if shot.camera_index == camera])
            for name, of in records.items()
        }
        for camera in cameras
    }
    pictures = [
        {
            "picture": _named(shot, capture),
            "timestep": shot.timestep,
            "camera": shot.camera_index,
            "values": {name: dict(of[index].values) for name, of in records.items()},
            "fitted_in_cameras": {name: list(of[index].act.cameras) for name, of in records.items()},
        }
        for index, shot in enumerate(shots)
    ]
    return {
        "title": TITLES[split],
        "about": ABOUT[split],
        "means": {name: means([record.values for record in of]) for name, of in records.items()},
        "published": {name: dict(values) for name, values in PUBLISHED[split].items()},
        "published_of": DATA_SET,
        "cameras": by_camera,
        "seconds_to_find": {
            name: _middle([r.act.seconds for r in of if r.act.cameras]) for name, of in records.items()
        },
        "pictures": pictures,
    }


def means(measured: Sequence[Values]) -> dict[str, float | None]:
    """Metric -> mean over the pictures where it was measured; None where it nowhere was."""
    found: dict[str, float | None] = {}
    for metric in measured[0] if measured else ():
        known = [value for values in measured if (value := values[metric]) is not None]
        found[metric] = float(np.mean(known)) if known else None
    return found


def notes_of(tables: Mapping[str, Mapping[str, Any]], missing: Sequence[str], lpips: str | None) -> list[str]:
    """What the reader has to know beside the figures, one sentence each."""
    notes = [
        f"The capture has no {TITLES[split].lower()} ({split}) pictures, so that table is left out."
        for split in missing
    ]
    alone = 0
    for table in tables.values():
        for picture in table["pictures"]:
            alone += any(cameras == [picture["camera"]] for cameras in picture["fitted_in_cameras"].values())
    if alone:
        notes.append(f"{alone} pictures had no other camera: there the avatar was fitted to the judged picture itself.")
    if lpips is not None:
        notes.append(f"LPIPS is left out: {lpips}")
    if any(table["means"] and _unmeasured(table, "FLIP") for table in tables.values()):
        notes.append("FLIP is left out: pip install 'gemheads[train]' brings flip-evaluator.")
    return notes


def about_capture(capture: Capture) -> dict[str, Any]:
    """The capture as the report names it: no paths of this machine."""
    camera = capture.train[0].camera
    counts = {split: len(capture.shots(split)) for split in ("train", "val", "test")}
    size = f"{camera.width}x{camera.height}"
    return {"name": capture.folder.resolve().name, "subject": capture.subject, "size": size, "pictures": counts}


def columns_json(columns: Sequence[Column]) -> list[dict[str, Any]]:
    """Plain values of the avatars, in the order of the tables."""
    return [asdict(column) for column in columns]


def _named(shot: Shot, capture: Capture) -> str:
    inside = shot.picture.is_relative_to(capture.folder)
    return shot.picture.relative_to(capture.folder).as_posix() if inside else shot.picture.name


def _middle(values: Sequence[float]) -> float | None:
    return round(float(np.median(values)), 3) if values else None


def _unmeasured(table: Mapping[str, Any], metric: str) -> bool:
    return all(values.get(metric) is None for values in table["means"].values())
