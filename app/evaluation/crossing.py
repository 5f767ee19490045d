"""The page's section on people never seen: tables, and driver above avatar."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

import numpy as np

from ...models.crossing.album import Album
from ...models.crossing.clip import Clip
from ...models.crossing.compare import Compared
from ...models.crossing.loop import Echo
from .pictures import STRIP, data_url, shrunk
from .pieces import row, table

SIDE = 112
"""Of a picture in a strip, pixels."""


@dataclass
class CrossingPictures:
    """Packed strips."""

    clips: Mapping[str, Clip]
    strips: dict[str, dict[str, str]] = field(default_factory=dict)
    """Driver -> who is in the row -> data URL."""

    def add(self, driver: str, avatar: str, driving: str, shown: Echo, compared: Compared) -> None:
        """One avatar driven by one clip; after this, its pictures are not needed any more."""
        clip = self.clips[driver]
        count = min(STRIP, len(clip.pictures))
        places = [int((part + 0.5) * len(clip.pictures) / count) for part in range(count)]
        rows = self.strips.setdefault(driver, {"driver": _strip(clip.pictures, places)})
        rows[f"{avatar}, {driving}"] = _strip(shown.pictures, places)


def crossing_section(figures: Mapping[str, Any], pictures: CrossingPictures) -> str:
    """HTML of ``figures``, which report.json holds, and the pictures."""
    parts = ["<h2>Driving people never seen</h2>"]
    parts += [f"<p class='note'>{escape(note)}</p>" for note in figures["notes"]]
    parts.append(_correlations(figures))
    for driver in figures["drivers"]:
        strips = "".join(
            f"<tr><th>{escape(who)}</th><td><img alt='{escape(who)}' src='{url}'></td></tr>"
            for who, url in pictures.strips[driver["name"]].items()
        )
        parts.append(f"<h3>{escape(driver['name'])}</h3><table class='strip'>{strips}</table>")
    return "".join(parts)


def _correlations(figures: Mapping[str, Any]) -> str:
    channels = [channel for channel in figures["channels"] if not channel["second_opinion"]]
    rows = []
    for told in figures["rows"]:
        cells = [escape(f"{told['avatar']}, {told['driving']}")]
        for channel in channels:
            value = told["median"][channel["name"]]
            cells.append("-" if value is None else f"{value:.3f}")
        rows.append(row(cells))
    goals = row(["goal", *(f"{channel['goal']:g}" for channel in channels)])
    return table(["", *(channel["name"] for channel in channels)], [goals, *rows])


def _strip(album: Album, places: Sequence[int]) -> str:
    return data_url(np.concatenate([shrunk(album[place], SIDE) for place in places], 1))
