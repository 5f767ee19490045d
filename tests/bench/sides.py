"""What a head that turns aside only seems to do on one side of its face.

    python tests/bench/sides.py [CLIP ...] --heads HEAD.gem ... [--turned 14]

The first table: each head rests, smiles, frowns, or raises both brows, alike on both sides, and turns to either side.
In each cell is half of what that changes in the difference of a score's two sides, left less right: 0 where the turn
adds nothing, at rest / with the face that moves it most. The second: people who were filmed; the difference that goes
with 20 degrees of turn to their left, by least squares, and the correlation with it. Faces are read as the tracker
gives them, before models/driver/sides.py says what of that is believed.
"""

import argparse
from pathlib import Path

import numpy as np
from gemheads.app.files.sources import open_source
from gemheads.models.arkit import NAMES
from gemheads.models.crossing.mirror import FOV_DEG, Mirror
from gemheads.models.driver.face import FaceObservation, FaceTracker
from gemheads.models.driver.features import head_rotation
from gemheads.models.driver.points import SCORES
from gemheads.models.gemfile import load_gem
from gemheads.models.train.regressors.controls import controls_of
from gemheads.render.arrays import Image
from numpy.typing import NDArray

SHIPPED = Path(__file__).parents[2] / "assets" / "avatars"
PAIRED = [name.removesuffix("Left") for name in SCORES if name.endswith("Left") and f"{name[:-4]}Right" in SCORES]
HALVES = np.array([[SCORES.index(name + side) for side in ("Left", "Right")] for name in PAIRED])
ACTED = (
    {},
    {"mouthSmile": 0.6},
    {"browDown": 0.6, "mouthPress": 0.5, "eyeSquint": 0.5},
    {"browOuterUp": 0.6},
)
LOOKS = 2
EVERY, SECONDS = 4, 24.0
LEAST = 0.03
"""Scores that are read off by less on every head are left out of the first table."""
FEWEST = 30
"""Readings of a clip in which somebody turns."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("clips", nargs="*", type=Path, help="videos of faces")
    parser.add_argument("--heads", nargs="+", type=Path, default=sorted(SHIPPED.glob("*.gem")), help=".gem files")
    parser.add_argument("--turned", type=float, default=14.0, help="degrees to either side")
    asked = parser.parse_args()
    heads = {path.stem: of_head(Mirror(load_gem(path), 384, FOV_DEG), asked.turned) for path in asked.heads}
    most = np.stack([np.abs(one).max(0) for one in heads.values()]).max(0)
    shown = [int(place) for place in np.flatnonzero(most >= LEAST)]
    table("score", list(heads), shown, {name: [_both(pair) for pair in one.T] for name, one in heads.items()})
    people = {path.stem: of_person(path) for path in asked.clips}
    people = {name: cells for name, cells in people.items() if cells}
    if people:
        table("score", list(people), shown, people)


def table(first: str, columns: list[str], shown: list[int], cells: dict[str, list[str]]) -> None:
    """One row for each score of ``shown``."""
    print(f"| {first} | {' | '.join(columns)} |\n|---|{'---|' * len(columns)}")
    for place in shown:
        print(f"| {PAIRED[place]} | {' | '.join(cells[column][place] for column in columns)} |")
    print()


def _both(differences: NDArray[np.float64]) -> str:
    most = differences[np.abs(differences).argmax()]
    return f"{differences[0]:+.2f} / {most:+.2f}"


def of_head(mirror: Mirror, turned: float) -> NDArray[np.float64]:
    """[faces, pairs] half of what turning from the right to the left adds to left less right."""
    controls = controls_of(mirror.gem)
    found = []
    for face in ACTED:
        weights = np.zeros((1, len(NAMES)), np.float32)
        for name, weight in face.items():
            weights[0, [NAMES.index(name + side) for side in ("Left", "Right")]] = weight
        coefficients = controls.coefficients(weights)[0]
        sides = [_apart(_read(mirror.draw(coefficients, np.radians([0.0, yaw, 0.0])))) for yaw in (-turned, turned)]
        found.append((sides[1] - sides[0]) / 2)
    return np.stack(found)


def of_person(path: Path) -> list[str]:
    """For each pair the slope and the correlation; none where too little is seen."""
    tracker, apart, yaw = FaceTracker(), [], []
    for index, frame in enumerate(open_source(str(path)).frames()):
        if frame.seconds > SECONDS:
            break
        if index % EVERY:
            continue
        face = [tracker.track(frame.rgb) for _ in range(LOOKS)][-1]
        if face is not None:
            apart.append(_apart(face))
            yaw.append(np.degrees(head_rotation(face)[1]))
    if len(yaw) < FEWEST:
        return []
    turn, differences = np.array(yaw) - np.mean(yaw), np.stack(apart) - np.mean(apart, 0)
    slope = 20 * turn @ differences / (turn @ turn)
    alike = turn @ differences / np.sqrt((turn @ turn) * (differences**2).sum(0) + 1e-12)
    return [f"{a:+.2f}, {b:+.2f}" for a, b in zip(slope, alike, strict=True)]


def _read(picture: Image) -> FaceObservation:
    tracker = FaceTracker()
    face = [tracker.track(picture) for _ in range(LOOKS)][-1]
    if face is None:
        raise SystemExit("the tracker does not see a head that is turned so far: give less of --turned")
    return face


def _apart(face: FaceObservation) -> NDArray[np.float64]:
    return (face.scores[HALVES[:, 0]] - face.scores[HALVES[:, 1]]).astype(float)


if __name__ == "__main__":
    main()
