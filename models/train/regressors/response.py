"""How an avatar answers: control weights and head rotation in, what the face tracker reads off its picture out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from ....render.camera import Camera, orbit
from ....render.compositing import over
from ....render.gaussians import RawGaussians
from ....render.software import SoftwareEngine
from ...crossing.mirror import FOV_DEG, HEAD_SHARE
from ...driver.axes import drawn_turn
from ...driver.face import FaceObservation, FaceTracker
from ...driver.features import DIMENSION, feature_vector, head_rotation, rotation_in_camera
from ...gem import Gem
from ...posing import pose_head
from ..threads import one_torch_thread
from .controls import Controls
from .headshape import HeadShape

PICTURE_SIZE = 384
"""Pixels, as the closed loop draws: in smaller pictures splats spread further over a face, and lips that hardly part
are read as closed (tests/bench/sizes.py)."""
POSE_SPREAD = np.radians([9.0, 13.0, 6.0])
"""Standard deviations of pitch, yaw and roll of the training pictures, radians."""
RESTING_SPREAD = 1.3
"""So much further turn heads whose face is at rest."""
TYPICAL = 0.2
"""Radians: rotations in this unit are about as large as weights, and their squares as they are."""
HIDDEN = 256
"""Width of F's three bent layers."""
HUBER = 3.0
"""Beyond so many tolerances a miss of F, or of the avatar, grows linearly only: squares would have F learn the few
pictures in which a whole face is read otherwise, and the avatar may be unable to do what a person does."""


class AvatarNotSeen(RuntimeError):
    """The face tracker does not find a face in the avatar's own neutral picture."""


@dataclass(frozen=True)
class Responses:
    """S pictures of one avatar, as the tracker reads them."""

    weights: NDArray[np.float32]
    """[S, E] control weights."""
    rotations: NDArray[np.float32]
    """[S, 3] head rotation that was drawn, in portraits asked for: pitch, yaw, roll as a rotation vector, radians."""
    seen_rotations: NDArray[np.float32]
    """[S, 3] the rotation that the tracker reads, from that of the neutral: an expression may seem to nod."""
    features: NDArray[np.float32]
    """[S, D] features relative to the avatar's own frontal neutral picture."""

    def __len__(self) -> int:
        return len(self.weights)

    def only(self, rows: NDArray[np.bool_]) -> "Responses":
        """Those of the pictures that ``rows`` [S] says."""
        return Responses(self.weights[rows], self.rotations[rows], self.seen_rotations[rows], self.features[rows])


@dataclass(frozen=True)
class Sitting:
    """Who sits before which camera."""

    fov_deg: float = FOV_DEG
    """The wider, the nearer is the head, which fills the picture always."""
    shape: HeadShape | None = None
    """Whose head it is; None: the avatar's own."""
    portrait: bool = False
    """Every picture is taken as the neutral is, and as people get to see the avatar: it fills as much of the picture,
    in the same light, and turns by what ``drawn_turn`` makes of the rotation."""


ITSELF = Sitting()
"""The avatar, by a far camera."""
PORTRAIT = Sitting(portrait=True)


def joined(parts: Sequence[Responses]) -> Responses:
    """Pictures of one avatar from several series."""
    return Responses(
        np.concatenate([part.weights for part in parts]),
        np.concatenate([part.rotations for part in parts]),
        np.concatenate([part.seen_rotations for part in parts]),
        np.concatenate([part.features for part in parts]),
    )


def at_rest(weights: NDArray[np.float32]) -> NDArray[np.bool_]:
    """[S] which of the control weights [S, E] are the neutral expression."""
    return (weights == 0).all(1)


def measure_responses(
    gem: Gem,
    controls: Controls,
    weights: NDArray[np.float32],
    rng: np.random.Generator,
    progress: Callable[[int, int], None] = lambda done, total: None,
    rotations: NDArray[np.float32] | None = None,
    sitting: Sitting = ITSELF,
) -> Responses:
    """Draws the avatar at each row of ``weights`` [S, E] under a random head pose (or ``rotations`` [S, 3]), framing
    and light, and reads it with the face tracker; pictures without a face are left out. The neutral is taken by the
    same camera. In portraits only the pose is random.

    Raises AvatarNotSeen when the neutral picture has no face.
    """
    studio = _Studio(gem, sitting)
    neutral = studio.read(gem.rest_coefficients, np.zeros(3), rng, still=True)
    if neutral is None:
        raise AvatarNotSeen(f"the face tracker finds no face in the neutral picture of avatar '{gem.name}'")
    if rotations is None:
        rotations = (rng.normal(size=(len(weights), 3)) * POSE_SPREAD).astype(np.float32)
        rotations[at_rest(weights)] *= RESTING_SPREAD
        rotations[: len(weights) // 5] = 0
    kept: list[int] = []
    features, turns = [np.empty((0, DIMENSION), np.float32)], [np.empty((0, 3), np.float32)]
    for index in range(len(weights)):
        turn = drawn_turn(rotations[index]) if sitting.portrait else rotations[index]
        seen = studio.read(controls.coefficients(weights[index]), turn, rng, still=sitting.portrait)
        if seen is not None:
            kept.append(index)
            features.append((feature_vector(seen) - feature_vector(neutral))[None])
            turns.append(rotation_in_camera(head_rotation(seen), head_rotation(neutral)).astype(np.float32)[None])
        progress(index + 1, len(weights))
    return Responses(weights[kept], rotations[kept], np.concatenate(turns), np.concatenate(features))


class _Studio:
    def __init__(self, gem: Gem, sitting: Sitting) -> None:
        self._gem, self._sitting = gem, sitting
        self._engine = SoftwareEngine()
        self._tracker = FaceTracker()
        self._composed: RawGaussians | None = None
        self._displacement = self._displaced()

    def read(
        self,
        coefficients: NDArray[np.float32],
        rotation: NDArray[np.floating],
        rng: np.random.Generator,
        still: bool = False,
    ) -> FaceObservation | None:
        """What one picture shows; None where no face is seen. ``still``: framed and lit as the neutral."""
        self._composed = self._gem.compose(coefficients, out=self._composed)
        head = replace(self._composed, positions=self._composed.positions + self._displacement)
        posed = pose_head(head, self._gem.neck_weights, self._gem.neck_pivot, rotation, np.zeros(3))
        image = self._engine.draw(posed, self._camera(rng, still))
        background = (0.7, 0.7, 0.7) if still else tuple(rng.uniform(0.15, 0.95, 3))
        picture = over(image, background)
        if not still and rng.random() < 0.5:
            picture = _photographed(picture, rng)
        self._tracker.reset()
        return self._tracker.track(picture)

    def _displaced(self) -> NDArray[np.float32] | float:
        """[N, 3] by which the head's shape moves the avatar's splats; the splats keep their sizes and turns."""
        shape = self._sitting.shape
        if shape is None:
            return 0.0
        return shape.displacement(self._gem.compose(self._gem.rest_coefficients).positions, self._gem.viewing)

    def _camera(self, rng: np.random.Generator, still: bool) -> Camera:
        viewing, fov_deg = self._gem.viewing, self._sitting.fov_deg
        share = HEAD_SHARE if still else HEAD_SHARE * rng.uniform(0.8, 1.2)
        distance = viewing.head_height / share / (2 * np.tan(np.radians(fov_deg) / 2))
        shift = np.zeros(3) if still else np.append(rng.normal(0, 0.012, 2), 0)
        return orbit(np.asarray(viewing.target) + shift, distance, 0, 0, fov_deg, PICTURE_SIZE, PICTURE_SIZE)


def _photographed(picture: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """The picture with a camera's gamma and noise."""
    light = (picture / 255.0) ** rng.uniform(0.7, 1.4) * 255 + rng.normal(0, rng.uniform(0, 5), picture.shape)
    return np.clip(light, 0, 255).astype(np.uint8)


class ResponseModel(nn.Module):
    """F: control weights [B, E] and head rotation [B, 3] to the channels that training compares [B, T]."""

    def __init__(self, controls: int, channels: int) -> None:
        super().__init__()
        self.linear = nn.Linear(controls + 3, channels)
        self.bend = nn.Sequential(
            nn.Linear(controls + 3, HIDDEN),
            nn.SiLU(),
            nn.Linear(HIDDEN, HIDDEN),
            nn.SiLU(),
            nn.Linear(HIDDEN, HIDDEN),
            nn.SiLU(),
            nn.Linear(HIDDEN, channels),
        )

    def forward(self, weights: Tensor, rotation: Tensor) -> Tensor:
        inputs = torch.cat([weights, rotation / TYPICAL], 1)
        return self.linear(inputs) + self.bend(inputs)


@one_torch_thread()
def fit_response(inputs: tuple[Tensor, Tensor], channels: Tensor, steps: int, seed: int) -> tuple[ResponseModel, float]:
    """Learns F from weights [S, E], rotations [S, 3] and channels [S, T] (in units of their tolerance); returns it with
    the share of variance (R2) it explains on a held-out tenth. Its parameters are frozen."""
    weights, rotations = inputs
    torch.manual_seed(seed)
    model = ResponseModel(weights.shape[1], channels.shape[1])
    order = torch.randperm(len(weights))
    held, used = order[: len(order) // 10], order[len(order) // 10 :]
    optimizer = torch.optim.AdamW(model.parameters(), 2e-3, weight_decay=1e-3, fused=True)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    for _ in range(steps):
        batch = used[torch.randint(len(used), (256,))]
        loss = nn.functional.huber_loss(model(weights[batch], rotations[batch]), channels[batch], delta=HUBER)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        schedule.step()
    model.requires_grad_(False)
    residual = ((model(weights[held], rotations[held]) - channels[held]) ** 2).sum()
    spread = ((channels[held] - channels[held].mean(0)) ** 2).sum()
    return model, float(1 - residual / spread)
