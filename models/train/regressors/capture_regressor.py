"""The regressor of a captured person: the paper's recipe on its own frames, and the loop closed for everybody else.

Section 3.2: features of the five most frontal training cameras, relative to the neutral, reduced by PCA; an MLP to
coefficients. The labels are distilled or fitted coefficients, and pictures are compared beside them. One person's
frames teach that person only; so strangers are followed by the closed loop (``closing``), whose answers keep to what
the person did.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch

from ....render.arrays import Floats32
from ...captures.reader import Capture
from ...gem import CLAMP_SIGMAS, Gem
from ..synthesis.fit import Start
from ..workers import ALONE, Workers
from .bystanders import heads_beside, leaks_of_bystanders
from .closing import ClosedLoop, descend
from .controls import Controls, free_controls
from .export_onnx import export_onnx
from .expressions import random_coefficients, random_weights
from .leaks import Leaks
from .network import RegressorNetwork
from .ownframes import Labelled, Pictured
from .reduction import principal_components
from .response import Responses
from .series import draw_series, in_series
from .sightings import Neutral, Sightings, frontal_cameras, neutral_of, see
from .strangers import Crowd, Person, crowd
from .train_regressor import RESTING, Progress, person_of

LABELS = 30.0
"""Price of missing all of a person's motion, in squared tolerances of the closed loop."""
PICTURES = 200.0
"""Price of a picture that is wrong by 1 everywhere."""
PICTURE_EVERY = 4
"""Steps from one compared picture to the next: each costs as much as all else of a step."""
MIXED = 3
"""An invented face is a mixture of so many moments of the person ..."""
UNREST = 0.15
"""... moved by this many sigmas, so that the response is known around them, too."""
PEOPLE = 40_000


@dataclass(frozen=True)
class RegressorEffort:
    """How long to learn."""

    pictures: int = 2000
    """Pictures of the avatar that its response is learned from; 0 leaves the closed loop out (the paper's recipe)."""
    steps: int = 4000
    photometric: bool = True
    seed: int = 0


@dataclass(frozen=True)
class CaptureRegressor:
    """What was learned, and from what."""

    gem: Gem
    """With its regressor."""
    neutral: Neutral
    sightings: Sightings
    """The training pictures that the tracker saw."""
    cameras: tuple[int, ...]
    """Whose pictures the tracker looked at, the most frontal one first."""
    response_r2: float | None
    """Share of the channels' variance that the model of the avatar's response explains; None without the loop."""
    mismatches: tuple[float, float] | None
    """Between invented people and the avatar, before and after, in tolerances."""


def capture_regressor(
    gem: Gem,
    capture: Capture,
    moments: Mapping[int, Start],
    effort: RegressorEffort = RegressorEffort(),
    companions: Sequence[Responses] = (),
    footage: Floats32 | None = None,
    progress: Progress = lambda stage, done, total: None,
    workers: Workers = ALONE,
) -> CaptureRegressor:
    """Trains a regressor on a capture's training pictures.

    Args:
        gem: the person's avatar.
        capture: its pictures.
        moments: timestep -> what the avatar does then, distilled or fitted; training moments.
        effort: how long.
        companions: pictures of other avatars, which play strangers.
        footage: [S, D + 3] of unlabelled faces, as ``read_footage`` gives it.
        progress: told the stage, steps done and steps in all.
        workers: who draw the avatar's pictures.

    Raises:
        CaptureError: where the tracker sees no neutral face, or the capture changed.
        WorkerLost: where one of the workers is gone.
        AvatarNotSeen: where the tracker sees no face in the avatar's picture.
        ValueError: where the moments belong to none of the pictures, or no two faces differ.
    """
    rng = np.random.default_rng(effort.seed)
    cameras = frontal_cameras(capture, "train")
    neutral = neutral_of(capture)
    shots = [shot for shot in capture.train if shot.camera_index in cameras and shot.timestep in moments]
    cameras = tuple(camera for camera in cameras if any(shot.camera_index == camera for shot in shots))
    sightings = see(capture, shots, neutral, lambda done, total: progress("faces", done, total))
    labelled = Labelled(gem, sightings, moments, rng)
    pictured = Pictured(gem, capture, sightings, moments, rng)
    controls, spread, others = free_controls(gem), sightings.features, None
    if effort.pictures:
        known = np.stack([moment.coefficients for moment in moments.values()])
        faces = invented(gem, controls, known, effort.pictures, rng)
        series = in_series(faces, rng)
        own = draw_series(gem, controls, series, lambda done, total: progress("pictures", done, total), workers)
        leaks = leaks_of_bystanders(
            [gem],
            effort.seed,
            heads_beside(effort.pictures),
            lambda done, total: progress("turning heads", done, total),
            workers,
        )
        others = _Others.around(own, sightings, companions, leaks, footage, effort, rng)
        spread = np.concatenate([spread, own.features, others.people.features[:8000]])
    torch.manual_seed(effort.seed)
    network = RegressorNetwork(principal_components(spread), controls)
    loop = None if others is None else ClosedLoop(network, others.avatar, others.people)
    judged = None if others is None else ClosedLoop(network, others.avatar, others.judges)
    before = None if judged is None else judged.mismatch()

    def loss(step: int) -> torch.Tensor:
        total = LABELS * labelled.loss(network)
        if loop is not None:
            total = total + loop.loss()
        if effort.photometric and step % PICTURE_EVERY == 0:
            total = total + PICTURES * pictured.loss(network)
        return total

    descend(network, loss, effort.steps, progress)
    learned = replace(gem, regressor=export_onnx([network]))
    if judged is None or others is None or before is None:
        return CaptureRegressor(learned, neutral, sightings, cameras, None, None)
    return CaptureRegressor(learned, neutral, sightings, cameras, others.r2, (before, judged.mismatch()))


@dataclass(frozen=True)
class _Others:
    """Everybody whom the avatar shall follow, and how it answers."""

    avatar: Person
    r2: float
    people: Crowd
    judges: Crowd

    @classmethod
    def around(
        cls,
        own: Responses,
        sightings: Sightings,
        companions: Sequence[Responses],
        leaks: Leaks,
        footage: Floats32 | None,
        effort: RegressorEffort,
        rng: np.random.Generator,
    ) -> "_Others":
        """The person's own frames count among the unlabelled ones."""
        avatar, r2 = person_of(own, effort.steps, effort.seed)
        others = [person_of(seen, effort.steps // 2, effort.seed)[0] for seen in companions]
        real = np.concatenate([sightings.features, sightings.rotations], 1)
        seen = real if footage is None else np.concatenate([real, footage])
        people, judges = (crowd([avatar, *others], leaks, seen, count, rng) for count in (PEOPLE, PEOPLE // 20))
        return cls(avatar, r2, people, judges)


def invented(gem: Gem, controls: Controls, known: Floats32, count: int, rng: np.random.Generator) -> Floats32:
    """[count, coefficients] weights of ``free_controls`` for faces that the person could make: mixtures of what it did
    [M, coefficients], stronger and weaker, and where the avatar has an ARKit map, faces of that in turn. The first and
    the last RESTING of them are the neutral.

    Coefficients drawn one by one are no faces: what a component moves belongs together with the others.
    """
    moved = (known - gem.rest_coefficients) / np.maximum(gem.sigma, 1e-12)
    shares = rng.dirichlet(np.ones(MIXED), count) * rng.uniform(0.5, 1.4, (count, 1))
    picked = rng.integers(len(moved), size=(count, MIXED))
    faces = np.einsum("cm,cmk->ck", shares, moved[picked])
    if gem.arkit_weights is not None:
        rigged = random_weights(count, rng) @ gem.arkit_weights / np.maximum(gem.sigma, 1e-12)
        faces[1::2] = rigged[1::2]
    faces += UNREST * random_coefficients(controls, count, rng)
    faces[0] = 0
    faces[count - int(RESTING * count) :] = 0
    return np.clip(faces, -CLAMP_SIGMAS, CLAMP_SIGMAS).astype(np.float32)
