"""Learns what faces' shapes make their heads seem to turn: ``python -m gemheads.models.train.seeming [AVATAR...]``.

Avatars act random faces with heads turned by known angles, in the light and framing of chance; ridge regression says
what their meshes tell of the error of their head poses. Each picture counts as its mirror image, too.
"""

import argparse
import hashlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from ..driver.face import FaceObservation
from ..driver.geometry import VERTICES, read_geometry
from ..driver.networks import FOLDER, GEOMETRY_FILE, SEEMING_FILE, SHA256, read_checked
from ..driver.seeming import Seeming
from ..gem import Gem
from ..gemfile import load_gem
from ..wholefile import write_whole
from .controls import controls_of
from .expressions import random_weights
from .response import POSE_SPREAD, Studio

Floats = NDArray[np.float64]

AVATARS = FOLDER.parent / "avatars"
PICTURES = 3000
RESTING, FRONTAL = 0.12, 0.2
"""Shares of the pictures in which the face is at rest, and in which the head does not turn."""
LOST = np.radians(15.0)
"""A pose that is further off is one of a face that was lost."""
RIDGE = 10.0
"""cm2; on avatars that were left out anything from 3 to 30 does as well."""


@dataclass(frozen=True)
class Sitting:
    """P pictures of one avatar whose head turned by known angles."""

    rest: Floats
    """[468, 3] cm, its mesh at rest."""
    moved: Floats
    """[P, 468, 3] cm, its mesh away from that."""
    errors: Floats
    """[P, 3] rotation vectors in the canonical frame, radians, that mend the head poses, relative to that at rest."""


def sit(gem: Gem, pictures: int, seed: int, progress: Callable[[int, int], None] = lambda done, total: None) -> Sitting:
    """Draws an avatar ``pictures`` times and looks at it; pictures in which its face is not seen are left out.

    Raises AvatarNotSeen when the tracker does not see it at rest.
    """
    rng, studio, controls = np.random.default_rng(seed), Studio(gem), controls_of(gem)
    weights = random_weights(pictures, rng)
    weights[rng.random(pictures) < RESTING] = 0
    turns = rng.normal(size=(pictures, 3)) * POSE_SPREAD
    turns[rng.random(pictures) < FRONTAL] = 0
    rest = studio.rest(rng)
    moved, errors = [], []
    for done, (face, turn) in enumerate(zip(weights, turns, strict=True)):
        progress(done + 1, pictures)
        seen = studio.look(controls.coefficients(face), turn, rng)
        if seen is not None:
            moved.append(seen.metric_mesh - rest.metric_mesh)
            errors.append(_rotvec(_turned(seen).T @ _matrix(turn) @ _turned(rest)))
    found = np.array(errors)
    near = (np.abs(found) < LOST).all(1)
    return Sitting(rest.metric_mesh, np.array(moved)[near], found[near])


def learned(sittings: Sequence[Sitting]) -> Seeming:
    """Ridge regression of the errors on the meshes of all sittings; it judges the two sides of a face alike."""
    canonical = read_geometry(read_checked(FOLDER, GEOMETRY_FILE)).vertices
    partners = np.array([((canonical * [-1, 1, 1] - one) ** 2).sum(1).argmin() for one in canonical])
    seen = np.concatenate([one.moved for one in sittings])
    meshes = np.concatenate([seen, seen[:, partners] * [-1, 1, 1]]).reshape(-1, 3 * VERTICES)
    errors = np.concatenate([one.errors for one in sittings])
    errors = np.concatenate([errors, errors * [1, -1, -1]])
    normal = meshes.T @ meshes + RIDGE * np.eye(3 * VERTICES)
    slopes = np.linalg.solve(normal, meshes.T @ errors).T.reshape(3, VERTICES, 3)
    rest = np.mean([one.rest for one in sittings], axis=0)
    return Seeming((rest + rest[partners] * [-1, 1, 1]) / 2, slopes)


def _turned(face: FaceObservation) -> Floats:
    """[3, 3] the head pose as Procrustes has it, without its scale."""
    return _matrix(_rotvec(face.head_pose[:3, :3]))


def _matrix(rotvec: Floats) -> Floats:
    return np.asarray(cv2.Rodrigues(rotvec)[0], np.float64)


def _rotvec(matrix: Floats) -> Floats:
    return np.asarray(cv2.Rodrigues(matrix)[0], np.float64).reshape(3)


def main(arguments: list[str] | None = None) -> int:
    """The command. Exit code 1 when the file came out other than the tracker expects it."""
    parser = argparse.ArgumentParser(prog="python -m gemheads.models.train.seeming", description=__doc__)
    parser.add_argument("avatar", nargs="*", type=Path, default=sorted(AVATARS.glob("*.gem")))
    parser.add_argument("--pictures", type=int, default=PICTURES, help="of each avatar (%(default)s)")
    parser.add_argument("--out", type=Path, default=FOLDER / SEEMING_FILE, help="file to write (%(default)s)")
    asked = parser.parse_args(arguments)
    content = learned([sit(load_gem(path), asked.pictures, 0) for path in asked.avatar]).packed()
    write_whole(asked.out, [content])
    digest = hashlib.sha256(content).hexdigest()
    print(f"{asked.out}: {len(content) / 1e3:.0f} kB, sha256 {digest}")
    if digest != SHA256[SEEMING_FILE]:
        print("the tracker takes it once that is what models/driver/networks.py names", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
