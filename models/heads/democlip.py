"""The demo clip: the fourth person talks, blinks, smiles, frowns, looks and turns in front of a soft background."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from ...render.camera import Camera, orbit
from ...render.software import SoftwareEngine
from ..arkit import NAMES
from ..posing import pose_head
from .bake import PIVOT, Subject, neck_weights, viewing_of
from .expressions import weights_of
from .performance import EMOTIONS, VISEMES, gaze, plausible

SECONDS = 11.0
RATE = 30
SIZE = 512
HEAD_SHARE = 0.60
"""Of the picture's height."""


@dataclass(frozen=True)
class Gesture:
    """Weights that come, stay and go."""

    start: float
    """Seconds."""
    end: float
    weights: NDArray[np.float32]
    rise: float = 0.22
    """Seconds of coming; going takes as long."""

    def at(self, seconds: float) -> float:
        """Strength in 0..1."""
        inside = min((seconds - self.start) / self.rise, (self.end - seconds) / self.rise)
        s = min(max(inside, 0.0), 1.0)
        return s * s * (3 - 2 * s)


def _blink(at: float) -> Gesture:
    return Gesture(at, at + 0.26, weights_of(eyeBlink=1.0), 0.10)


def _speech(start: float, sounds: str, each: float = 0.15) -> list[Gesture]:
    words = sounds.split()
    return [
        Gesture(start + i * each - 0.04, start + (i + 1) * each + 0.07, weights_of(**VISEMES[word]), 0.11)
        for i, word in enumerate(words)
    ]


SCRIPT: tuple[Gesture, ...] = (
    *map(_blink, (0.85, 2.55, 4.75, 6.55, 8.95, 10.45)),
    *_speech(1.15, "kk E nn oh sil TH E RR sil nn aa ih SS sil DD ou SS E sil ou aa"),
    Gesture(1.2, 3.6, weights_of(mouthSmile=0.12, browOuterUp=0.15), 0.5),
    Gesture(3.55, 5.15, weights_of(**EMOTIONS["grin"]), 0.40),
    Gesture(5.30, 6.30, weights_of(**{**EMOTIONS["surprise"], "jawOpen": 0.40}), 0.28),
    Gesture(6.45, 7.35, weights_of(browDown=1.0, mouthFrown=0.6, mouthPress=0.3, eyeSquint=0.25), 0.28),
    Gesture(7.35, 7.95, gaze(0.9, 0.0), 0.14),
    Gesture(7.90, 8.50, gaze(-0.9, 0.0), 0.14),
    Gesture(8.45, 8.95, gaze(0.0, 0.75), 0.14),
    Gesture(8.30, 9.10, weights_of(mouthPucker=0.95), 0.25),
    *_speech(9.20, "aa PP oh FF aa CH ou"),
    Gesture(9.2, 10.6, weights_of(mouthSmile=0.5, cheekSquint=0.3), 0.45),
)
TURNS: tuple[tuple[float, float, tuple[float, float, float]], ...] = (
    # start, end, degrees about x (nod), y (turn), z (tilt)
    (1.6, 3.3, (2.0, 13.0, 3.0)),
    (2.9, 4.0, (-4.0, -6.0, -2.0)),
    (3.9, 5.0, (3.0, -4.0, -6.0)),
    (5.3, 6.3, (-6.0, 0.0, 0.0)),
    (6.4, 7.4, (7.0, 3.0, 0.0)),
    (9.1, 10.0, (0.0, -18.0, 0.0)),
    (9.9, 10.7, (2.0, 16.0, 4.0)),
)


def act(seconds: float) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """ARKit weights [52] and head rotation (rotation vector [3], radians) at a time of the clip."""
    weights = np.zeros(len(NAMES), np.float32)
    for gesture in SCRIPT:
        weights += gesture.at(seconds) * gesture.weights
    turn = np.zeros(3)
    for start, end, degrees in TURNS:
        turn += Gesture(start, end, weights, 0.5 * (end - start)).at(seconds) * np.radians(degrees)
    sway = np.radians([0.6 * np.sin(1.9 * seconds), 0.8 * np.sin(1.3 * seconds + 1), 0.5 * np.sin(1.1 * seconds)])
    settle = min(1.0, seconds / 1.0)
    return plausible(weights[None])[0], turn + settle * sway


def backdrop(size: int) -> NDArray[np.float32]:
    """A softly lit wall [size, size, 3], sRGB in [0, 1]."""
    y, x = np.mgrid[:size, :size] / size
    glow = np.exp(-((x - 0.62) ** 2 + (y - 0.38) ** 2) / 0.32)
    wall = np.array([0.40, 0.45, 0.48]) + glow[..., None] * np.array([0.24, 0.22, 0.19])
    return wall.astype(np.float32)


def portrait_camera(subject: Subject, size: int) -> Camera:
    """Straight on, the head HEAD_SHARE of the height."""
    viewing = viewing_of(subject.head)
    distance = 1.1
    fov = 2 * np.degrees(np.arctan(viewing.head_height / HEAD_SHARE / 2 / distance))
    x, y, z = viewing.target
    return orbit((x, y - 0.02, z), distance, 0, 0, float(fov), size, size)


def pictures(subject: Subject, size: int = SIZE) -> Iterator[NDArray[np.uint8]]:
    """The frames [size, size, 3] of the clip."""
    engine = SoftwareEngine()
    camera = portrait_camera(subject, size)
    wall = backdrop(size)
    rest = subject.frame(np.zeros(len(NAMES)))
    neck = neck_weights(rest.positions, subject.rider.part)
    for index in range(round(SECONDS * RATE)):
        weights, turn = act(index / RATE)
        raw = pose_head(subject.frame(weights), neck, PIVOT, turn, np.zeros(3))
        drawn = engine.draw(raw, camera)
        picture = drawn[..., :3] + (1 - drawn[..., 3:]) * wall
        yield np.rint(np.clip(picture, 0, 1) * 255).astype(np.uint8)
    engine.close()


def write_clip(subject: Subject, path: Path) -> None:
    """Encode the clip as H.264 at RATE frames a second."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(f"file:{path}", "w") as container:
        stream = container.add_stream("libx264", rate=RATE, options={"crf": "20", "preset": "slow", "threads": "1"})
        stream.width = stream.height = SIZE
        stream.pix_fmt = "yuv420p"
        for picture in pictures(subject):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, "rgb24")))
        container.mux(stream.encode())
