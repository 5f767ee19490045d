"""How much askew a face that moves is read where it was a frame ago.

    python tests/bench/lag.py CLIP ... [--seconds 15]

Each clip is followed twice: with one look a frame, and as the tracker does, with a second one where the face has moved
(``MOVED`` in models/driver/face.py). In each cell is how far a score is off what a tracker reads that has looked at the
same frame three times (RMS, hundredths of a whole expression; of left and right the left one): with one look / as the
tracker does. In the last column milliseconds a frame, likewise.
"""

import argparse
import time
from itertools import takewhile
from pathlib import Path

import numpy as np
from gemheads.app.files.sources import open_source
from gemheads.models.driver.face import FaceObservation, FaceTracker, looked
from gemheads.models.driver.points import SCORES
from numpy.typing import NDArray

SHOWN = ("jawOpen", "mouthPucker", "mouthSmileLeft", "eyeBlinkLeft", "browInnerUp", "browDownLeft")
SETTLED = 3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clips", nargs="+", type=Path, help="videos of faces")
    parser.add_argument("--seconds", type=float, default=15.0, help="of each")
    asked = parser.parse_args()
    print(f"| clip | {' | '.join(SHOWN)} | ms |\n|---|{'---|' * (len(SHOWN) + 1)}")
    for path in asked.clips:
        once, twice = of_clip(path, asked.seconds)
        print(f"| {path.stem} | {' | '.join(f'{a:.1f} / {b:.1f}' for a, b in zip(once, twice, strict=True))} |")


def of_clip(path: Path, seconds: float) -> tuple[list[float], list[float]]:
    """How far off each score that is shown is, and milliseconds a frame: with one look, and as the tracker does."""
    trackers, judge = (FaceTracker(moved=np.inf), FaceTracker()), FaceTracker()
    off: tuple[list[NDArray[np.float64]], ...] = ([], [])
    spent, frames = np.zeros(2), 0
    for frame in takewhile(lambda frame: frame.seconds < seconds, open_source(str(path)).frames()):
        frames += 1
        settled = looked(judge, frame.rgb, SETTLED)
        for which, tracker in enumerate(trackers):
            begun = time.perf_counter()
            face = tracker.track(frame.rgb)
            spent[which] += time.perf_counter() - begun
            if face is not None and settled is not None:
                off[which].append(_shown(face) - _shown(settled))
    if not all(off):
        raise SystemExit(f"{path}: no face in it")
    errors = [100 * np.sqrt(np.square(one).mean(0)) for one in off]
    once, twice = ([*error.tolist(), 1e3 * float(each) / frames] for error, each in zip(errors, spent, strict=True))
    return once, twice


def _shown(face: FaceObservation) -> NDArray[np.float64]:
    return np.array([face.scores[SCORES.index(name)] for name in SHOWN], float)


if __name__ == "__main__":
    main()
