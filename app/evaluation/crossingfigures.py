"""What was found of drivers and avatars as the plain values of report.json; the page is made of the same."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...models.crossing.channels import CHANNELS, SCORE_CHANNELS
from ...models.crossing.compare import Compared
from ...models.crossing.embedding import Agreement
from ...models.crossing.extent import Extent
from ...models.crossing.lips import PARTED_MM, SHUT_MM
from ...models.crossing.pace import Pace
from ...models.crossing.poseleak import GOAL, PITCH_DEG, YAW_DEG
from ...models.metrics.tables import CROSSING, CROSSING_BY

if TYPE_CHECKING:
    from .drivers import Tracked
    from .robustness import Robustness

JUDGED = [channel.name for channel in SCORE_CHANNELS]
"""Channels that have a goal."""


@dataclass(frozen=True)
class Row:
    """One avatar by one way of driving it."""

    avatar: str
    driving: str
    """regressor or baseline."""
    compared: Mapping[str, Compared]
    """Driver -> how well the avatar followed."""
    pooled: Agreement | None
    """Of the embeddings of all drivers; None where the avatar was hardly seen."""
    robustness: "Robustness"
    pace: Pace | None = None
    """How fast it was, by turns with the avatar's other rows; never kept, since it depends on the hour."""


def crossing_json(
    rows: Sequence[Row],
    clips: Sequence["Tracked"],
    size: int,
    every: int,
    seconds: float,
    notes: Sequence[str],
) -> dict[str, Any]:
    """The part of report.json.

    Args:
        rows: what was found.
        clips: the drivers.
        size: side of the avatars' pictures in pixels.
        every: each N-th frame was taken ...
        seconds: ... of at most so many of each clip; what was taken is beside each driver.
        notes: sentences for the reader.
    """
    return {
        "every": every,
        "seconds": seconds,
        "size": size,
        "channels": [
            {"name": c.name, "goal": c.goal, "floor": c.floor, "second_opinion": c.goal is None} for c in CHANNELS
        ],
        "lips": {"parted_mm": PARTED_MM, "shut_mm": SHUT_MM},
        "pose_leak": {"goal": GOAL, "yaw_deg": YAW_DEG, "pitch_deg": PITCH_DEG},
        "drivers": [_driver_json(tracked) for tracked in clips],
        "rows": [_row_json(row) for row in rows],
        "published": {name: dict(values) for name, values in CROSSING.items()},
        "published_by": CROSSING_BY,
        "notes": list(notes),
    }


def crossing_said(figures: Mapping[str, Any]) -> list[str]:
    """Lines for the terminal: one for each row, then the notes."""
    lines = []
    for row in figures["rows"]:
        told = ", ".join(f"{name} {value:.2f}" for name, value in row["median"].items() if value is not None)
        lines.append(f"Driven by strangers, {row['avatar']}, {row['driving']}: {told}; {_steady_said(row)}")
    return [*lines, *figures["notes"]]


def _steady_said(row: Mapping[str, Any]) -> str:
    found = row["robustness"]
    jitter = [found["jitter"][which]["sigma"] for which in ("raw", "smoothed")]
    told = [] if None in jitter else [f"jitter {jitter[0]:.3f} sigma, {jitter[1]:.3f} smoothed"]
    leaks = [f"{leak['yaw_ratio']['sigma']:.2f} ({head})" for head, leak in found["pose_leak"].items()]
    return ", ".join([*told, f"pose leak {', '.join(leaks)}" if leaks else "pose leak not seen"])


def _driver_json(tracked: "Tracked") -> dict[str, Any]:
    clip = tracked.clip
    return {
        "name": tracked.name,
        "sha256": tracked.driver.sha256,
        "frames": len(clip.readings),
        "seconds": round(clip.seconds, 2),
        "without_face": clip.lost,
        "neutral_seconds": round(clip.neutral_time, 3),
        "neutral": clip.reason,
        "other_neutrals": len(clip.others),
    }


def _row_json(row: Row) -> dict[str, Any]:
    correlation = np.stack([compared.likeness.correlation for compared in row.compared.values()])
    median = _medians(correlation[:, : len(JUDGED)])
    return {
        "avatar": row.avatar,
        "driving": row.driving,
        "median": median,
        "met": {channel.name: _met(median[channel.name], channel.goal) for channel in SCORE_CHANNELS},
        "embedding": _agreement_json(row.pooled),
        **_pace_json(row.pace),
        "robustness": _robustness_json(row.robustness),
        "drivers": {name: _compared_json(compared) for name, compared in row.compared.items()},
    }


def _pace_json(pace: Pace | None) -> dict[str, float | None]:
    if pace is None:
        return {"step_ms": None, "tracking_ms": None, "fps": None, "fps_with_tracking": None}
    return {
        "step_ms": round(1000 * pace.step, 2),
        "tracking_ms": round(1000 * pace.tracking, 2),
        "fps": round(1 / pace.step, 1),
        "fps_with_tracking": round(1 / (pace.step + pace.tracking), 1),
    }


def _compared_json(compared: Compared) -> dict[str, Any]:
    likeness = compared.likeness
    by_channel = asdict(likeness)
    names = [channel.name for channel in CHANNELS]
    return {
        **{kind: dict(zip(names, map(_plain, values), strict=True)) for kind, values in by_channel.items()},
        "embedding": _agreement_json(compared.agreement),
        "lips": {kind: _plain(value) for kind, value in asdict(compared.lips).items()},
        "unseen": compared.unseen,
        "worst": [asdict(worst) for worst in compared.worst],
    }


def _robustness_json(found: "Robustness") -> dict[str, Any]:
    """RMS of coefficients, in sigma and in millimetres that splats move; ratios are to the RMS of expression."""
    whole, jitters = found.expression, list(found.jitter.values())
    spreads = np.stack(list(found.correlations.values()))
    return {
        "expression": _extent_json(whole),
        "jitter": {
            "raw": _middle_json([jitter.raw for jitter in jitters]),
            "smoothed": _middle_json([jitter.smoothed for jitter in jitters]),
            "drivers": {
                name: {"raw": _extent_json(jitter.raw), "smoothed": _extent_json(jitter.smoothed)}
                for name, jitter in found.jitter.items()
            },
        },
        "pose_leak": {
            head: {
                "yaw": _extent_json(leak.at_yaw),
                "yaw_ratio": _extent_json(leak.at_yaw.over(whole)),
                "all": _extent_json(leak.all),
                "all_ratio": _extent_json(leak.all.over(whole)),
                "met": leak.at_yaw.over(whole).sigma <= GOAL,
            }
            for head, leak in found.leaks.items()
        },
        "neutrals": {
            "count": dict(found.neutrals),
            "correlation_spread": _medians(spreads[:, : len(JUDGED)]),
            "mean": _middle_json(list(found.means.values())),
            "mean_ratio": _middle_json([spread.over(whole) for spread in found.means.values()]),
            "drivers": {
                name: {
                    "correlation_spread": dict(zip(JUDGED, map(_plain, spread[: len(JUDGED)]), strict=True)),
                    "mean": _extent_json(found.means[name]),
                }
                for name, spread in found.correlations.items()
            },
        },
    }


def _extent_json(found: Extent) -> dict[str, float | None]:
    return {"sigma": _plain(found.sigma), "mm": _plain(found.mm)}


def _middle_json(found: Sequence[Extent]) -> dict[str, float | None]:
    """Medians."""
    return {"sigma": _median([e.sigma for e in found]), "mm": _median([e.mm for e in found])}


def _agreement_json(found: Agreement | None) -> dict[str, float] | None:
    return None if found is None else {name: round(value, 5) for name, value in asdict(found).items()}


def _met(value: float | None, goal: float | None) -> bool | None:
    return None if value is None or goal is None else value >= goal


def _medians(values: NDArray[np.floating]) -> dict[str, float | None]:
    """JUDGED channel -> median over the drivers [drivers, channels] that move it."""
    return {name: _median(values[:, i].tolist()) for i, name in enumerate(JUDGED)}


def _median(values: Sequence[float]) -> float | None:
    known = [value for value in values if not np.isnan(value)]
    return _plain(float(np.median(known))) if known else None


def _plain(value: float) -> float | None:
    """Four digits behind the point; None for what is not a number."""
    return None if np.isnan(value) else round(float(value), 4)
