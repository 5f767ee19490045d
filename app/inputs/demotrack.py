"""Makes the performance that ships: ``python -m gemheads.app.inputs.demotrack [CLIP] [FILE]``."""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.driver.baseline import baseline_weights
from ...models.driver.face import FaceTracker
from ...models.driver.features import feature_vector, head_rotation, relative_rotation
from ..errors import NoFaceError
from ..files.sources import Source, open_source
from ..library import DEMO_CLIP
from ..performing.weights import SHIPPED, WeightsTrack, save_weights
from ..person.neutrals import AUTO, find_neutral

NAME = "Demo performance"
SMOOTHING_SECS = 0.03
"""Standard deviation of the bell that takes the tracker's tremble off, without delay; a blink lasts four times that."""
JOIN_SECS = 0.6
"""The end goes over into the beginning within this time, so that it can play in a circle."""


def weights_of(source: Source, tracker: FaceTracker) -> WeightsTrack:
    """What the face of a clip does, in ARKit weights, smoothed and closed to a loop. Raises NoFaceError."""
    neutral = find_neutral(AUTO, source, tracker)
    pts, weights, turns = [], [], []
    for frame in source.frames():
        face = tracker.track(frame.rgb)
        if face is None:
            raise NoFaceError(f"{source.path}: no face at {frame.seconds:.2f} s; give a clip that always shows one")
        pts.append(frame.pts)
        weights.append(baseline_weights(feature_vector(face) - neutral.features))
        turns.append(relative_rotation(head_rotation(face), neutral.rotation))
    rate = float(source.rate)
    shapes, turn = (_closed(_smoothed(np.array(values), rate), rate) for values in (weights, turns))
    times = np.array(pts, np.int64)[: len(shapes)]
    return WeightsTrack(
        NAME, source.time_base, times, np.clip(shapes, 0, 1).astype(np.float32), turn.astype(np.float32)
    )


def _smoothed(values: NDArray[np.floating], rate: float) -> NDArray[np.float64]:
    """Values [F, n] under a bell of SMOOTHING_SECS; the ends are repeated outwards."""
    reach = int(np.ceil(3 * SMOOTHING_SECS * rate))
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / (SMOOTHING_SECS * rate)) ** 2)
    padded = np.pad(values, ((reach, reach), (0, 0)), mode="edge")
    return np.stack([np.convolve(column, bell / bell.sum(), "valid") for column in padded.T], 1)


def _closed(values: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Values [F, n] without their last JOIN_SECS, which are blended into the first ones instead."""
    join = min(round(JOIN_SECS * rate), len(values) // 2)
    share = np.linspace(0, 1, join + 2)[1:-1, None]
    share = share * share * (3 - 2 * share)
    first, last = values[:join], values[len(values) - join :]
    return np.concatenate([last + share * (first - last), values[join : len(values) - join]])


def main() -> None:
    """Make it, and say what came out."""
    given = [Path(word) for word in sys.argv[1:3]]
    clip, out = given[0] if given else DEMO_CLIP, given[1] if len(given) > 1 else SHIPPED
    track = weights_of(open_source(str(clip)), FaceTracker())
    save_weights(track, out)
    strongest = track.weights.max(0)
    print(f"{out}: {len(track.pts)} frames, {(strongest > 0.2).sum()} shapes used, {out.stat().st_size / 1024:.0f} KB")


if __name__ == "__main__":
    main()
