"""What happened in a run, counted frame by frame and written as JSON."""

import json
import platform
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

from ...models.wholefile import write_whole
from ..errors import cannot_write
from ..performing.performance import Pose
from ..performing.presence import Phase
from ..person.hints import DARK

_PACKAGES = ("gemheads", "numpy", "numba", "moderngl", "onnxruntime", "opencv-contrib-python-headless", "av")

WORTH_A_WORD = 0.1
"""Of the frames: what is seen in fewer is not told."""


@dataclass
class Tally:
    """Counts over the frames of one clip."""

    frames: int = 0
    without_face: int = 0
    losses: int = 0
    """How often a followed face was lost."""
    dark: int = 0
    """Of the frames without a face, those that may show none because they are dark."""
    several_faces: int = 0
    cuts: int = 0
    clamped: float = 0.0
    """Sum over followed frames of the share of clamped coefficients."""
    _followed_before: bool = field(default=False, repr=False)

    def add(self, pose: Pose, luma: float = 1.0) -> None:
        """Count one frame, and how bright it is, in [0, 1]."""
        followed = pose.phase is Phase.TRACKING
        self.frames += 1
        self.without_face += not followed
        self.dark += not followed and luma < DARK
        self.losses += self._followed_before and not followed
        self.several_faces += pose.faces > 1
        self.cuts += pose.cut
        self.clamped += pose.clamped
        self._followed_before = followed

    @property
    def remark(self) -> str:
        """What made the face hard to follow for much of the clip, and what to do; empty where nothing did."""
        if not self.frames:
            return ""
        missing, several = self.without_face / self.frames, self.several_faces / self.frames
        remarks: list[str] = []
        if missing >= WORTH_A_WORD:
            cure = "show the face all the time, from the front and nearer"
            if 2 * self.dark > self.without_face:
                cure = "put a lamp in front of it"
            elif self.dark:
                cure += ", with a lamp in front of it"
            where = f" ({self.dark / self.frames:.0%} are dark)" if self.dark else ""
            remarks.append(f"no face in {missing:.0%} of the frames{where}, where the avatar rests: {cure}")
        if several >= WORTH_A_WORD:
            remarks.append(
                f"several faces in {several:.0%} of the frames, of which one is followed: if it is the wrong one, or a"
                " picture on the wall, give --crop left, right or X,Y,WIDTH,HEIGHT in percent"
            )
        return "; ".join(remarks)

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        followed = self.frames - self.without_face
        return {
            "frames": self.frames,
            "frames_without_face": self.without_face,
            "dark_frames_without_face": self.dark,
            "losses": self.losses,
            "frames_with_several_faces": self.several_faces,
            "cuts": self.cuts,
            "clamped_share": round(self.clamped / followed, 4) if followed else 0.0,
        }


@dataclass(frozen=True)
class Outcome:
    """One driver's run."""

    driver: str
    output: str
    status: str
    """done, kept (an earlier run had finished it), interrupted, failed, or not begun when another was interrupted."""
    tally: Tally = field(default_factory=Tally)
    message: str = ""
    credentials: str = ""
    """signed, or why not; empty where the extra that signs is not installed."""
    neutral: dict[str, Any] = field(default_factory=dict)
    stages_ms: dict[str, float] = field(default_factory=dict)
    seconds: float = 0.0
    first_frame_seconds: float = 0.0

    @property
    def rate(self) -> float:
        """Frames per second, from the first to the last; 0 where nothing was drawn."""
        drawing = self.seconds - self.first_frame_seconds
        return self.tally.frames / drawing if self.tally.frames and drawing > 0 else 0.0


def write_report(path: Path, settings: dict[str, Any], outcomes: list[Outcome]) -> None:
    """All outcomes with settings and versions as JSON. Raises OutputError."""
    runs = []
    for outcome in outcomes:
        run = asdict(outcome)
        run.pop("tally")
        runs.append({**run, **outcome.tally.as_json(), "frames_per_second": round(outcome.rate, 2)})
    report = {"settings": settings, "runs": runs, "versions": versions()}
    write_json(path, report)


def write_json(path: Path, tree: object) -> None:
    """What a program reads, in lines that a person can. Raises OutputError."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, [(json.dumps(tree, indent=2) + "\n").encode()])
    except OSError as error:
        raise cannot_write(path, error) from error


def versions(*more: str) -> dict[str, str]:
    """Python, system and the packages that matter, and ``more`` of them."""
    found = {"python": platform.python_version(), "system": platform.platform()}
    for package in (*_PACKAGES, *more):
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "not installed"
    return found
