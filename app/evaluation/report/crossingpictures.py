"""What the page shows of drivers and avatars: film strips, worst frames and curves, small enough for a page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ....models.crossing.album import Album
from ....models.crossing.channels import CHANNELS, table
from ....models.crossing.clip import Clip
from ....models.crossing.compare import Compared, Worst
from ....models.crossing.loop import Echo
from .pictures import data_url, shrunk

STRIP = 9
"""Pictures in a film strip."""
SIDE = 112
"""Of one of them, pixels."""
CURVES = ("jawOpen", "mouthSmile", "mouthPucker", "eyeBlink", "browInnerUp", "browDown", "gaze horizontal", "yaw")
"""Channels that are drawn over time."""


@dataclass
class Scene:
    """Of one driver."""

    clip: Clip
    strips: dict[str, str] = field(default_factory=dict)
    """Who is in the row -> data URL."""
    worst: dict[str, list[tuple[Worst, str]]] = field(default_factory=dict)
    """Who follows -> frames that agree least, and driver above avatar as data URL."""
    curves: dict[str, dict[str, list[float | None]]] = field(default_factory=dict)
    """Channel of CURVES -> driver or avatar -> value in each frame; None where it was not seen."""

    @property
    def labels(self) -> list[str]:
        """Of the frames."""
        return [f"{seconds:.1f} s" for seconds in self.clip.times]


class CrossingPictures:
    """All drivers. Worst frames and curves are of each avatar's first way of being driven, strips of every one."""

    def __init__(self, clips: Mapping[str, Clip]) -> None:
        """``clips``: driver -> clip."""
        self.scenes = {name: Scene(clip) for name, clip in clips.items()}
        self._avatars: set[tuple[str, str]] = set()
        for scene in self.scenes.values():
            scene.strips["driver"] = _strip(scene.clip.pictures)
            values = table(scene.clip.readings, scene.clip.neutral)
            for name in CURVES:
                scene.curves[name] = {"driver": values[:, _place(name)].tolist()}

    def add(self, driver: str, avatar: str, driving: str, shown: Echo, compared: Compared) -> None:
        """One avatar driven by one clip; after this its pictures are not needed any more."""
        scene = self.scenes[driver]
        scene.strips[f"{avatar}, {driving}"] = _strip(shown.pictures)
        if (driver, avatar) in self._avatars:
            return
        self._avatars.add((driver, avatar))
        who = f"{avatar}, {driving}"
        scene.worst[who] = [
            (worst, _pair(scene.clip.pictures, shown.pictures, worst.frame)) for worst in compared.worst
        ]
        frames = np.flatnonzero(shown.seen)
        for name in CURVES:
            values: list[float | None] = [None] * len(shown.seen)
            for frame, value in zip(frames, compared.avatar[:, _place(name)], strict=True):
                values[frame] = float(value)
            scene.curves[name][who] = values


def _strip(album: Album) -> str:
    count = min(STRIP, len(album))
    places: Sequence[int] = [int((part + 0.5) * len(album) / count) for part in range(count)]
    return data_url(np.concatenate([shrunk(album[place], SIDE) for place in places], 1))


def _pair(driver: Album, avatar: Album, frame: int) -> str:
    return data_url(np.concatenate([shrunk(driver[frame], SIDE), shrunk(avatar[frame], SIDE)]))


def _place(channel: str) -> int:
    return [c.name for c in CHANNELS].index(channel)
