"""What was found of drivers and avatars as the plain values of report.json; the page is made of the same."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...models.crossing.channels import CHANNELS, SCORE_CHANNELS
from ...models.crossing.clip import Clip
from ...models.crossing.compare import Compared
from ...models.crossing.embedding import Agreement
from ...models.metrics.tables import CROSSING, CROSSING_BY
from ..casting import Driving

if TYPE_CHECKING:
    from ..drivers import Driver

WORDS: Mapping[Driving, str] = {"learned": "regressor", "baseline": "baseline"}
"""What drives, as tables call it."""


@dataclass(frozen=True)
class Row:
    """One avatar by one way of driving it."""

    avatar: str
    driving: str
    """One of WORDS."""
    compared: Mapping[str, Compared]
    """Driver -> how well the avatar followed."""
    pooled: Agreement | None
    """Of the embeddings of all drivers; None where the avatar was hardly seen."""
    step_secs: float
    """Median over drivers of a reenactment step without tracking."""


def crossing_json(
    rows: Sequence[Row],
    drivers: Sequence["Driver"],
    clips: Mapping[str, Clip],
    size: int,
    every: int,
    seconds: float,
    notes: Sequence[str],
) -> dict[str, Any]:
    """The part of report.json."""
    tracking = float(np.median([clip.tracking_secs for clip in clips.values()]))
    return {
        "every": every,
        "seconds": seconds,
        "size": size,
        "channels": [
            {"name": c.name, "goal": c.goal, "floor": c.floor, "second_opinion": c not in SCORE_CHANNELS}
            for c in CHANNELS
        ],
        "drivers": [_driver_json(driver, clips[driver.name]) for driver in drivers],
        "tracking_ms": round(1000 * tracking, 2),
        "rows": [_row_json(row, tracking) for row in rows],
        "published": {name: dict(values) for name, values in CROSSING.items()},
        "published_by": CROSSING_BY,
        "notes": list(notes),
    }


def crossing_said(figures: Mapping[str, Any]) -> list[str]:
    """A line for each row."""
    lines = []
    for row in figures["rows"]:
        told = ", ".join(f"{name} {value:.2f}" for name, value in row["median"].items() if value is not None)
        lines.append(f"Driven by strangers, {row['avatar']}, {row['driving']}: {told}")
    return [*lines, *figures["notes"]]


def _driver_json(driver: "Driver", clip: Clip) -> dict[str, Any]:
    return {
        "name": driver.name,
        "sha256": driver.sha256,
        "frames": len(clip.readings),
        "without_face": clip.lost,
        "neutral_seconds": round(clip.neutral_time, 3),
        "neutral": clip.reason,
    }


def _row_json(row: Row, tracking_secs: float) -> dict[str, Any]:
    correlation = np.stack([compared.likeness.correlation for compared in row.compared.values()])
    names = [channel.name for channel in SCORE_CHANNELS]
    median = {name: _median(correlation[:, i]) for i, name in enumerate(names)}
    met = {
        channel.name: None if median[channel.name] is None else bool((median[channel.name] or 0) >= (channel.goal or 0))
        for channel in SCORE_CHANNELS
    }
    return {
        "avatar": row.avatar,
        "driving": row.driving,
        "median": median,
        "met": met,
        "embedding": _agreement_json(row.pooled),
        "step_ms": round(1000 * row.step_secs, 2),
        "fps": round(1 / row.step_secs, 1),
        "fps_with_tracking": round(1 / (row.step_secs + tracking_secs), 1),
        "drivers": {name: _compared_json(compared) for name, compared in row.compared.items()},
    }


def _compared_json(compared: Compared) -> dict[str, Any]:
    likeness = compared.likeness
    names = [channel.name for channel in CHANNELS]
    return {
        "correlation": dict(zip(names, _plain(likeness.correlation), strict=True)),
        "amplitude": dict(zip(names, _plain(likeness.amplitude), strict=True)),
        "unrest": dict(zip(names, _plain(likeness.unrest), strict=True)),
        "embedding": _agreement_json(compared.agreement),
        "unseen": compared.unseen,
        "worst": [asdict(worst) for worst in compared.worst],
    }


def _agreement_json(found: Agreement | None) -> dict[str, float] | None:
    return None if found is None else {name: round(value, 5) for name, value in asdict(found).items()}


def _plain(values: NDArray[np.floating]) -> list[float | None]:
    return [None if np.isnan(value) else round(float(value), 4) for value in values]


def _median(values: NDArray[np.floating]) -> float | None:
    known = values[~np.isnan(values)]
    return round(float(np.median(known)), 4) if len(known) else None
