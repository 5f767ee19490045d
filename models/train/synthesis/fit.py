"""Analysis by synthesis: the coefficients and the head's pose with which an avatar looks like given pictures.

The unknowns are whitened: coefficients in sigmas from rest, turns and moves in steps that change a picture about as
much. L-BFGS on squared differences with a prior on them comes first, for the pose alone, then for all;
where time does not matter, then Adam on L1 and SSIM.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ....render.arrays import Floats32
from ....render.camera import Camera
from ....render.diff.rasterize import rasterize
from ....render.diff.tensors import RawTensors, activate
from ...gem import Gem
from ..losses import photometric, psnr
from .lbfgs import Memory, minimise
from .torchgem import TorchGem
from .views import View, views_of

TURN_STEP = 0.05
"""Radians that count as one sigma of the head's rotation ..."""
MOVE_STEP = 0.005
"""... and metres that do of its translation."""
NOISE = 0.02
"""Root mean square of what no coefficient explains in a picture, in [0, 1]: what the prior is weighed against."""


@dataclass(frozen=True)
class Descent:
    """One run of L-BFGS."""

    side: int | None
    """The pictures' longer side is brought down to about this, pixels; None leaves them as they are."""
    evaluations: int
    """Pictures drawn, with their gradients."""
    pose_only: bool = False
    """Leave the expression alone: composing is a third of the time."""


@dataclass(frozen=True)
class Effort:
    """How long to look."""

    descents: tuple[Descent, ...]
    adam_steps: int = 0
    """Taken last; the best of their points is kept. A few bring nothing: the time is spent better on L-BFGS."""
    adam_rate: float = 0.02
    """Sigmas a step, at first; it falls to nothing."""


FIRST = Effort((Descent(64, 4, pose_only=True), Descent(None, 33)))
"""A picture of which nothing is known: below 1 s at 15,000 splats and 256 x 256 on two cores. Only the pose is sought
on a coarse picture: splats are widened by a part of a pixel, so the expression seen there is another."""
NEXT = Effort((Descent(None, 8),))
"""A picture that follows one already fitted, with its memory: below 0.3 s."""
THOROUGH = Effort((Descent(64, 12, pose_only=True), Descent(None, 80)), adam_steps=40)
"""What a few seconds more give."""


@dataclass(frozen=True)
class HeadPose:
    """A turn about the neck's pivot, then a translation: the arguments of ``models.posing.pose_head``."""

    turn: Floats32
    """[3] axis times angle, radians."""
    move: Floats32
    """[3] metres."""

    @classmethod
    def rest(cls) -> "HeadPose":
        """Neither turned nor moved."""
        return cls(np.zeros(3, np.float32), np.zeros(3, np.float32))


@dataclass(frozen=True)
class Start:
    """Where to begin."""

    coefficients: Floats32
    """[coefficients]."""
    pose: HeadPose
    memory: Memory = ()
    """What the frame before taught of the problem's curvature."""


@dataclass(frozen=True)
class Fit:
    """What was found."""

    coefficients: Floats32
    """[coefficients] within +-3 sigma."""
    pose: HeadPose
    losses: tuple[float, ...]
    """L1 and SSIM before Adam and after each of its steps; empty where it takes none."""
    psnr: float
    """Decibels of the fitted pictures against the given ones."""
    pictures: tuple[Floats32, ...]
    """[H, W, 3] the fitted pictures, one per view."""
    seconds: float
    memory: Memory

    @property
    def start(self) -> Start:
        """The next frame's start."""
        return Start(self.coefficients, self.pose, self.memory)


def fit(
    gem: Gem,
    pictures: Sequence[NDArray[np.generic]],
    cameras: Sequence[Camera],
    background: Sequence[float] = (0.75, 0.75, 0.75),
    start: Start | None = None,
    effort: Effort = FIRST,
    prior: float = 0.02,
    around: HeadPose | None = None,
) -> Fit:
    """Find the expression and the pose of an avatar in one picture or in several of the same moment.

    Args:
        gem: the avatar; its first components alone (``gem.truncated``) make it faster.
        pictures: [H, W, 3] RGB, uint8 or floats in [0, 1], one per camera; [H, W, 4] with straight alpha.
        cameras: where each was taken, of the same size as its picture.
        background: RGB in [0, 1] of the ground behind the head.
        start: ``start`` of the frame before, or a guess; None begins at rest.
        effort: FIRST, NEXT for a frame with a start, THOROUGH, or one's own.
        prior: weight of the mean squared distance from rest in sigmas, against the squared difference in NOISEs. From
            one view many coefficients cannot be seen: without it they wander.
        around: where a tracker saw the head, from where the prior counts its way; None is its place at rest.

    Raises:
        ValueError: where pictures and cameras do not belong together or a start does not belong to the avatar.
    """
    started = time.perf_counter()
    problem = _Problem(gem, views_of(pictures, cameras, background), prior, around)
    unknown = problem.whitened(start)
    memory = () if start is None else start.memory
    for descent in effort.descents:
        learned = _descend(problem, unknown, descent, memory)
        memory = memory if descent.pose_only else learned
    losses = _adam(problem, unknown, effort)
    coefficients, pose = problem.found(unknown)
    unknown = problem.whitened(Start(coefficients, pose))
    with torch.no_grad():
        splats = problem.compose(unknown)
        drawn = [problem.draw(unknown, view, splats) for view in problem.views]
    wanted = torch.cat([view.picture.reshape(-1) for view in problem.views])
    quality = psnr(torch.cat([image.reshape(-1) for image in drawn]), wanted)
    images = tuple(image.numpy() for image in drawn)
    return Fit(coefficients, pose, losses, quality, images, time.perf_counter() - started, memory)


class _Problem:
    """The pictures, the avatar, and the whitened unknowns: coefficients, turn, move behind one another."""

    def __init__(self, gem: Gem, views: list[View], prior: float, around: HeadPose | None) -> None:
        self.gem, self.views, self.prior = gem, views, prior
        self.count = gem.coefficient_count
        self._torch = TorchGem.of(gem)
        self._rest = torch.from_numpy(gem.rest_coefficients)
        self.sigma = self._torch.sigma
        # turning about the neck also carries the head away: about its middle the two are told apart more easily
        self._arm = torch.tensor(gem.viewing.target, dtype=torch.float32) - self._torch.neck_pivot
        self._expected = self.whitened(None if around is None else Start(gem.rest_coefficients, around))

    def pose(self, unknown: Tensor) -> tuple[Tensor, Tensor]:
        """Turn and move of the whitened unknowns."""
        turn, shift = TURN_STEP * unknown[self.count : -3], MOVE_STEP * unknown[-3:]
        return turn, shift - torch.linalg.cross(turn, self._arm)

    def whitened(self, start: Start | None) -> Tensor:
        """The unknowns of an expression and a pose; None is rest."""
        if start is None:
            return torch.zeros(self.count + 6)
        coefficients, pose = start.coefficients, start.pose
        if coefficients.shape != (self.count,):
            raise ValueError(f"'{self.gem.name}' has {self.count} coefficients, the start {coefficients.shape}")
        turn, move = (torch.tensor(values, dtype=torch.float32) for values in (pose.turn, pose.move))
        shift = move + torch.linalg.cross(turn, self._arm)
        expression = (torch.from_numpy(coefficients).float() - self._rest) / self.sigma
        return torch.cat([expression, turn / TURN_STEP, shift / MOVE_STEP])

    def found(self, unknown: Tensor) -> tuple[Floats32, HeadPose]:
        """The other way, within +-3 sigma."""
        coefficients = self._rest + unknown[: self.count] * self.sigma
        turn, move = self.pose(unknown)
        return self.gem.clamped(coefficients.numpy()), HeadPose(turn.numpy().copy(), move.numpy().copy())

    def compose(self, unknown: Tensor) -> RawTensors:
        """The expression, with the head at rest."""
        return self._torch.compose(self._rest + unknown[: self.count] * self.sigma)

    def draw(self, unknown: Tensor, view: View, splats: RawTensors) -> Tensor:
        """``splats`` of ``compose`` in this pose, as the view sees them: [H, W, 3]."""
        return rasterize(activate(self._torch.posed(splats, *self.pose(unknown))), view.camera, view.background)

    def distance(self, unknown: Tensor) -> Tensor:
        """The prior: equation 4's sigmas, squared."""
        return self.prior * (unknown - self._expected).square().mean()


def _descend(problem: _Problem, unknown: Tensor, descent: Descent, memory: Memory) -> Memory:
    """L-BFGS, in place; returns what was learned."""
    views = [view.shrunk(descent.side) for view in problem.views]
    first = problem.count if descent.pose_only else 0
    with torch.no_grad():
        still = problem.compose(unknown) if descent.pose_only else None

    def energy(free: Tensor) -> tuple[float, Tensor]:
        free = free.detach().requires_grad_()
        whole = torch.cat([unknown[:first], free])
        splats = problem.compose(whole) if still is None else still
        total = problem.distance(whole)
        for view in views:
            difference = problem.draw(whole, view, splats) - view.picture
            total = total + difference.square().mean() / (NOISE**2 * len(views))
        return float(total.detach()), torch.autograd.grad(total, free)[0]

    found, _, learned = minimise(energy, unknown[first:], descent.evaluations, () if descent.pose_only else memory)
    unknown[first:] = found
    return learned


def _adam(problem: _Problem, unknown: Tensor, effort: Effort) -> tuple[float, ...]:
    """Adam, in place; returns the losses."""
    if not effort.adam_steps:
        return ()
    free = unknown.clone().requires_grad_()
    optimizer = torch.optim.Adam([free], lr=effort.adam_rate, betas=(0.9, 0.99))
    losses: list[float] = []
    for step in range(effort.adam_steps + 1):
        splats = problem.compose(free)
        terms = [photometric(problem.draw(free, view, splats), view.picture) for view in problem.views]
        loss = torch.stack(terms).mean()
        if not losses or float(loss.detach()) < min(losses):
            unknown[:] = free.detach()
        losses.append(float(loss.detach()))
        if step == effort.adam_steps:
            break
        # the prior keeps its place beside a loss that is no longer squared: both are small near the end
        (free.grad,) = torch.autograd.grad(loss + NOISE * problem.distance(free), [free])
        optimizer.param_groups[0]["lr"] = effort.adam_rate * (1 - step / effort.adam_steps)
        optimizer.step()
    return tuple(losses)


def error_map(fitted: Floats32, picture: NDArray[np.generic], full_scale: float = 0.1) -> NDArray[np.uint8]:
    """Where a fit differs: [H, W, 3] uint8, black where nothing, white from ``full_scale`` (of 1) on, heat between.

    ``fitted`` [H, W, 3] floats in [0, 1]; ``picture`` [H, W, 3] uint8 or floats.
    """
    other = np.asarray(picture, np.float64) / (255 if picture.dtype == np.uint8 else 1)
    heat = np.abs(fitted - other).mean(-1) / full_scale
    channels = np.clip(np.stack([3 * heat, 3 * heat - 1, 3 * heat - 2], -1), 0, 1)
    return np.round(255 * channels).astype(np.uint8)
