"""How far the tracker reads a head's turn off: by expressions, which seem to nod, and by axes that lean.

    python tests/bench/nodding.py [AVATAR.gem ...]

The first table is where models/driver/nodding.py has its figures from: random faces of each avatar, its head still,
ridge regression of the pitch that is read on their ARKit weights. The second is where models/driver/axes.py has its
figures from: faces at rest, random turns, least squares of what is read on what was drawn and its products; and the
error (RMS) when the turn is drawn as it shall be read, and when drawn_turn says how. In the third the same heads are
people before cameras that nobody has levelled: how far the turn that is drawn of what is read of them errs, about the
camera's axes and about the head's own. In the fourth each avatar plays the driver of the others, with random faces
and turns that are known.
"""

import argparse
from itertools import permutations
from pathlib import Path

import cv2
import numpy as np
from gemheads.models.arkit import NAMES
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.crossing.reading import Reading
from gemheads.models.driver.axes import drawn_turn
from gemheads.models.driver.features import relative_rotation, rotation_in_camera
from gemheads.models.driver.nodding import READ_AS_PITCH_DEG
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gemfile import load_gem
from gemheads.models.train.regressors.controls import controls_of
from gemheads.models.train.regressors.expressions import random_weights

SHIPPED = Path(__file__).parents[2] / "assets" / "avatars"
SIZE, LOOKS = 384, 2
TURNS = np.radians([7.0, 10.0, 4.0])
"""Standard deviations of pitch, yaw and roll of those who play drivers."""
FARTHEST = np.radians([15.0, 25.0, 12.0])
"""To which faces at rest turn."""
STANDS = {
    "level": (0, 0, 0),
    "20 below": (-20, 0, 0),
    "20 above": (20, 0, 0),
    "20 aside": (0, 20, 0),
    "on its side": (0, 0, 90),
}
"""Cameras, and pitch, yaw and roll of a head that faces ahead as they see it, degrees."""
BEYOND = 0.3
"""Radians; a reading so far off is a face that was lost."""
RIDGE = 0.5
LEAST_DEG = 0.5
"""Shapes that are read off by less are left out of the table."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("avatars", nargs="*", type=Path, default=sorted(SHIPPED.glob("*.gem")))
    parser.add_argument(
        "--heads", nargs="*", type=Path, default=[], help="more .gem files, for the second and third table"
    )
    parser.add_argument("--faces", type=int, default=500)
    asked = parser.parse_args()
    mirrors = {path.stem: Mirror(load_gem(path), SIZE) for path in asked.avatars}
    read_off(mirrors, asked.faces)
    heads = mirrors | {path.stem: Mirror(load_gem(path), SIZE) for path in asked.heads}
    about_axes(heads, asked.faces // 2)
    unlevel(heads, asked.faces // 4)
    driven(mirrors, asked.faces // 2)


def read_off(mirrors: dict[str, Mirror], faces: int) -> None:
    """Degrees of pitch that each shape adds at weight 1, in a column for each avatar."""
    columns = []
    for mirror in mirrors.values():
        acted = shown(mirror, faces, 5, np.zeros(3))
        weights, pitch = np.stack([face for face, *_ in acted]), np.array([turn[0] for _, _, turn, _ in acted])
        columns.append(np.degrees(np.linalg.solve(weights.T @ weights + RIDGE * np.eye(52), weights.T @ pitch)))
    table = np.stack(columns, 1)
    print(f"| shape | {' | '.join(mirrors)} | taken as |\n|---|{'---|' * len(mirrors)}---|")
    for place in np.argsort(-np.abs(table.mean(1))):
        if abs(table[place].mean()) >= LEAST_DEG or NAMES[place] in READ_AS_PITCH_DEG:
            cells = " | ".join(f"{degrees:+.1f}" for degrees in table[place])
            print(f"| {NAMES[place]} | {cells} | {READ_AS_PITCH_DEG.get(NAMES[place], 0):+.1f} |")


def about_axes(mirrors: dict[str, Mirror], turns: int) -> None:
    """What is read of turns of a face at rest: how much of a unit of roll as yaw, of yaw as roll, of pitch times yaw as
    yaw; and errors of pitch, yaw and roll (RMS, degrees)."""
    print("\n| head | yaw of roll | roll of yaw | yaw of both | drawn as it shall be read | by drawn_turn |")
    print(f"|{'---|' * 6}")
    for name, mirror in mirrors.items():
        shall = np.random.default_rng(3).uniform(-1, 1, (turns, 3)) * FARTHEST
        plain, seen = at_rest(mirror, shall)
        products = [shall[:, i] * shall[:, j] for i in range(3) for j in range(i, 3)]
        terms = np.stack([*shall.T, *products], 1)
        found = np.linalg.lstsq(terms[seen], plain[seen], rcond=None)[0]
        better, also = at_rest(mirror, np.stack([drawn_turn(turn) for turn in shall]))
        errors = [np.degrees(rms((one - shall)[seen & also])) for one in (plain, better)]
        leans = " | ".join(f"{one:+.3f}" for one in (found[2, 1], found[1, 2], found[4, 1]))
        print(f"| {name} | {leans} | {' | '.join(three(error) for error in errors)} |")


def at_rest(mirror: Mirror, turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of a face at rest what is read [F, 3] of these turns [F, 3], and whether a face was found [F]."""
    rest, read = mirror.neutral(), np.full(turns.shape, np.nan)
    for place, turn in enumerate(turns):
        mirror.restart()
        reading = mirror.read(mirror.draw(mirror.gem.rest_coefficients, turn), LOOKS)
        if reading is not None:
            read[place] = rotation_in_camera(reading.rotation, rest.rotation)
    return read, np.abs(read - turns).max(1) < BEYOND


def unlevel(mirrors: dict[str, Mirror], turns: int) -> None:
    """Errors of pitch, yaw and roll (RMS, degrees) of an avatar that such cameras drive."""
    print(f"\n| camera | about whose axes | {' | '.join(mirrors)} |\n|---|---|{'---|' * len(mirrors)}")
    shall = np.random.default_rng(3).uniform(-1, 1, (turns, 3)) * FARTHEST
    for camera, stand in STANDS.items():
        seen = [before(mirror, shall, np.radians(stand)) for mirror in mirrors.values()]
        for whose, turn_of in (("the camera's", rotation_in_camera), ("the head's", relative_rotation)):
            cells = []
            for rest, rotations, found in seen:
                drawn = np.stack([drawn_turn(turn_of(rotation, rest)) for rotation in rotations])
                cells.append(three(np.degrees(rms(drawn - shall[found]))))
            print(f"| {camera} | {whose} | {' | '.join(cells)} |")


def before(mirror: Mirror, turns: np.ndarray, stand: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a face at rest that a camera sees turned by ``stand`` [3]: its rotation [3], those of further ``turns`` [F, 3]
    about its own axes in which a face was found [S, 3], and which those are [F]."""
    ahead = cv2.Rodrigues(stand)[0]
    rotations = []
    for turn in (np.zeros(3), *turns):
        mirror.restart()
        turned = cv2.Rodrigues(ahead @ cv2.Rodrigues(turn)[0])[0].ravel()
        reading = mirror.read(mirror.draw(mirror.gem.rest_coefficients, turned), LOOKS)
        rotations.append(np.full(3, np.nan) if reading is None else reading.rotation)
    read = np.stack([relative_rotation(rotation, rotations[0]) for rotation in rotations[1:]])
    seen = np.abs(read - turns).max(1) < BEYOND
    return rotations[0], np.stack(rotations[1:])[seen], seen


def driven(mirrors: dict[str, Mirror], faces: int) -> None:
    """By how much pitch, yaw and roll of driver and avatar differ (RMS about the mean, degrees)."""
    print("\n| driver | avatar | as it is read | as the avatar turns |\n|---|---|---|---|")
    for driver, avatar in permutations(mirrors, 2):
        express, acted = Regressor.of(mirrors[avatar].gem), shown(mirrors[driver], faces, 9, TURNS)
        errors = [(turn - turned, express(read, turn).turn - turned) for _, turned, turn, read in acted]
        print(f"| {driver} | {avatar} | {' | '.join(three(one) for one in np.degrees(np.std(errors, axis=0)))} |")


def rms(errors: np.ndarray) -> np.ndarray:
    """[3] of [F, 3]."""
    return np.asarray(np.sqrt(np.mean(np.square(errors), 0)))


def three(degrees: np.ndarray) -> str:
    return " ".join(f"{one:.2f}" for one in degrees)


def shown(mirror: Mirror, faces: int, seed: int, spread: np.ndarray) -> list[tuple[np.ndarray, ...]]:
    """Of random faces: weights [52], the turn that was drawn and the one that is read [3], relative features [D]."""
    controls, rng, rest = controls_of(mirror.gem), np.random.default_rng(seed), mirror.neutral()
    kept = []
    for face, turned in zip(random_weights(faces, rng), rng.normal(size=(faces, 3)) * spread, strict=True):
        mirror.restart()
        reading = mirror.read(mirror.draw(controls.coefficients(face), turned), LOOKS)
        if isinstance(reading, Reading):
            turn = relative_rotation(reading.rotation, rest.rotation)
            if np.abs(turn - turned).max() < BEYOND:
                kept.append((face, turned, turn, reading.features - rest.features))
    return kept


if __name__ == "__main__":
    main()
