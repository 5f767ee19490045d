"""Analysis by synthesis of linear models, with coefficients of each modality or shared ones: the same search."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from gemheads.models.captures.layout import Shot
from gemheads.models.captures.reader import Capture
from gemheads.models.gem import CHANNELS, CLAMP_SIGMAS, Gem
from gemheads.models.train.avatars.runs import arrays_of
from gemheads.models.train.synthesis.fit import NOISE
from gemheads.models.train.synthesis.lbfgs import minimise
from gemheads.models.train.synthesis.torchgem import pose_head
from gemheads.models.train.synthesis.views import views_of
from gemheads.render.diff.rasterize import rasterize
from gemheads.render.diff.tensors import RawTensors, activate
from gemheads.render.gaussians import RawGaussians
from torch import Tensor

from .bases import Linear

PRIOR = 0.02
"""Of the mean squared distance from the mean in sigmas: that of ``models.train.fit``."""


@dataclass(frozen=True)
class Searched:
    """A linear model in raw space as tensors, and where its head turns."""

    rows: tuple[Tensor, ...]
    """[K + 1, W] of each modality: the mean, and components times their sigmas."""
    shared: bool
    colors: Tensor
    neck_weights: Tensor
    pivot: Tensor

    @classmethod
    def of(cls, model: Linear, gem: Gem) -> "Searched":
        """``gem`` lends colours and neck."""
        rows = []
        for mean, basis, sigma in zip(model.means, model.components, model.sigma, strict=True):
            rows.append(torch.from_numpy(np.vstack([mean[None], basis * sigma[:, None]]).astype(np.float32)))
        others = (torch.tensor(x) for x in (gem.colors, gem.neck_weights, gem.neck_pivot))
        return cls(tuple(rows), model.shared, *others)

    @property
    def count(self) -> int:
        """Coefficients of a frame."""
        return len(self.rows[0]) - 1 if self.shared else sum(len(rows) - 1 for rows in self.rows)

    def compose(self, whitened: Tensor) -> RawTensors:
        """The splats of coefficients [count] in sigmas."""
        told = [whitened] * len(self.rows)
        if not self.shared:
            told = list(torch.split(whitened, [len(rows) - 1 for rows in self.rows]))
        flat = [torch.addmv(rows[0], rows[1:].T, k) for rows, k in zip(self.rows, told, strict=True)]
        position, rotation, scale, opacity = (
            values.view(-1, width) for values, width in zip(flat, CHANNELS.values(), strict=True)
        )
        return RawTensors(position, rotation, scale, opacity[:, 0], self.colors)


def fitted(model: Searched, capture: Capture, shots: Sequence[Shot], evaluations: int) -> RawGaussians:
    """The expression with which the model looks like pictures of one moment; the head is where it was tracked."""
    tracked = capture.tracked(shots[0].timestep)
    turn, move = (torch.tensor(x) for x in (tracked.rotation, tracked.translation))
    views = views_of([capture.read(shot) for shot in shots], [shot.camera for shot in shots], capture.background)

    def energy(whitened: Tensor) -> tuple[float, Tensor]:
        free = whitened.detach().requires_grad_()
        splats = activate(pose_head(model.compose(free), model.neck_weights, model.pivot, turn, move))
        total = PRIOR * free.square().mean()
        for view in views:
            difference = rasterize(splats, view.camera, view.background) - view.picture
            total = total + difference.square().mean() / (NOISE**2 * len(views))
        return float(total.detach()), torch.autograd.grad(total, free)[0]

    found, _, _ = minimise(energy, torch.zeros(model.count), evaluations)
    with torch.no_grad():
        return arrays_of(model.compose(found.clamp(-CLAMP_SIGMAS, CLAMP_SIGMAS)))
