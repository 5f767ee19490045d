"""A person's own frames as losses: known coefficients, and pictures (section 3.2 of the paper)."""

from collections.abc import Mapping

import numpy as np
import torch
from torch import Tensor

from ....render.diff.rasterize import rasterize
from ....render.diff.tensors import activate
from ...captures.reader import Capture
from ...driver.features import BLOCKS
from ...gem import Gem
from ..losses import photometric
from ..synthesis.fit import Start
from ..synthesis.torchgem import TorchGem
from ..synthesis.views import view_of
from .network import RegressorNetwork
from .sightings import Sightings
from .strangers import NOISE

BATCH = 128
PICTURE_SIDE = 96
"""Longer side of the pictures that are compared, about, pixels."""
WHITENED = 0.1
"""Weight of the labels' small components: as missed sigmas, beside the missed share of all motion."""


class Labelled:
    """Coefficients that are known for moments, from distilling or fitting."""

    def __init__(self, gem: Gem, sightings: Sightings, moments: Mapping[int, Start], rng: np.random.Generator) -> None:
        """Raises ValueError where no sighting has a label."""
        kept = [index for index, shot in enumerate(sightings.shots) if shot.timestep in moments]
        if not kept:
            raise ValueError("no picture in which the tracker saw the face belongs to a moment with known coefficients")
        self.features = torch.from_numpy(sightings.features[kept])
        self.rotations = torch.from_numpy(sightings.rotations[kept])
        known = np.stack([moments[sightings.shots[index].timestep].coefficients for index in kept]).astype(np.float32)
        self.coefficients = torch.from_numpy(known)
        self._noise = torch.zeros(self.features.shape[1])
        for name, spread in NOISE.items():
            self._noise[BLOCKS[name]] = spread
        self._sigma = torch.from_numpy(np.maximum(gem.sigma, 1e-12))
        self._parts = [part for part in gem.slices.values() if part.stop > part.start]
        torch.manual_seed(int(rng.integers(1 << 31)))

    def __len__(self) -> int:
        return len(self.features)

    def loss(self, network: RegressorNetwork) -> Tensor:
        """Of a random batch, with the tracker's noise: the share of each modality's motion that is missed, and a
        little of the same for each component by itself."""
        batch = torch.randint(len(self), (BATCH,))
        features = self.features[batch] + self._noise * torch.randn(BATCH, self.features.shape[1])
        missed = network(features, self.rotations[batch]) - self.coefficients[batch]
        shares = [missed[:, part].square().sum(1).mean() / self._sigma[part].square().sum() for part in self._parts]
        return torch.stack(shares).mean() + WHITENED * (missed / self._sigma).square().mean()


class Pictured:
    """Pictures of moments, small: what the regressed coefficients draw shall be what the camera saw."""

    def __init__(
        self,
        gem: Gem,
        capture: Capture,
        sightings: Sightings,
        moments: Mapping[int, Start],
        rng: np.random.Generator,
    ) -> None:
        """``moments`` say where the head is; every sighting belongs to one of them."""
        self._avatar, self._capture, self._sightings, self._rng = TorchGem.of(gem), capture, sightings, rng
        self._moments = moments

    def loss(self, network: RegressorNetwork) -> Tensor:
        """L1 and D-SSIM of one random picture."""
        index = int(self._rng.integers(len(self._sightings)))
        shot = self._sightings.shots[index]
        view = view_of(self._capture, shot).shrunk(PICTURE_SIDE)
        rows = (torch.from_numpy(array[index][None]) for array in (self._sightings.features, self._sightings.rotations))
        raw = self._avatar.compose(network(*rows)[0])
        pose = self._moments[shot.timestep].pose
        turn, move = (torch.tensor(x, dtype=torch.float32) for x in (pose.turn, pose.move))
        posed = self._avatar.posed(raw, turn, move)
        return photometric(rasterize(activate(posed), view.camera, view.background), view.picture)
