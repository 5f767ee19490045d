"""An avatar whose bases can be changed: what refinement works on, and the way back to an avatar."""

from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from ....render.arrays import Floats
from ....render.diff.tensors import RawTensors
from ...gem import CHANNELS, MODALITIES, Basis, Gem

State = list[Tensor]
"""Everything of a FreeGem: what is free, and its maps."""

SIGMA_FLOOR = 1e-4
"""A coefficient's spread is at least this share of its modality's largest: none may be 0."""
NEAR_REST = 0.5
"""Moments within about so many sigmas of the rest (root mean square) tell where it went."""


class FreeGem:
    """Means, components, colours of an avatar and the coefficients of F moments, as tensors with gradients.

    ``means`` modality -> [N * C]; ``components`` modality -> [K, N * C]; ``colors`` [N, 3];
    ``whitened`` [F, coefficients] the moments' coefficients in sigmas of the beginning.
    """

    def __init__(self, gem: Gem, coefficients: Floats, device: torch.device | str = "cpu") -> None:
        """``coefficients`` [F, coefficients] of the moments, in the avatar's units."""
        self.gem = gem

        def free(values: Floats) -> Tensor:
            return torch.tensor(np.asarray(values, np.float32), device=device).requires_grad_()

        self.means = {name: free(gem.bases[name].mean) for name in MODALITIES}
        self.components = {name: free(gem.bases[name].components) for name in MODALITIES}
        self.colors = free(gem.colors)
        self.sigma = torch.tensor(gem.sigma, device=device)
        self.whitened = free(coefficients / gem.sigma)
        self.maps: dict[str, Floats] = {name: np.eye(len(gem.bases[name])) for name in MODALITIES}
        """Modality -> [K, K] what orthogonalising made of the coefficients so far: old @ map = new."""
        self.began = np.asarray(coefficients, np.float64)
        """[F, coefficients] as they were given."""

    def tensors(self) -> list[Tensor]:
        """All that is free."""
        return [*self.means.values(), *self.components.values(), self.colors, self.whitened]

    def compose(self, index: int) -> RawTensors:
        """Equation 1 for a moment."""
        coefficients = self.whitened[index] * self.sigma
        values = []
        for name in MODALITIES:
            part, components = coefficients[self.gem.slices[name]], self.components[name]
            values.append(torch.addmv(self.means[name], components.T, part).view(-1, CHANNELS[name]))
        return RawTensors(values[0], values[1], values[2], values[3][:, 0], self.colors)

    @torch.no_grad()
    def orthonormalise(self) -> None:
        """Make every basis orthonormal by a QR decomposition, and re-project the coefficients, so that no picture
        changes: B^T = Q R, hence k B = (k R^T) Q^T. R has a positive diagonal: no component turns round."""
        for name in MODALITIES:
            components = self.components[name]
            if not len(components):
                continue
            q, r = torch.linalg.qr(components.double().T)
            signs = torch.sign(torch.diagonal(r))
            components.copy_((q * signs).T)
            change = (r * signs[:, None]).T
            here = self.gem.slices[name]
            part, sigma = self.whitened[:, here], self.sigma[here]
            part.copy_((part * sigma).double() @ change / sigma)
            self.maps[name] = self.maps[name] @ change.cpu().numpy()

    def finished(self) -> tuple[Gem, Floats]:
        """The avatar, and the coefficients [F, coefficients] of its moments.

        Bases are orthonormal; coefficients have the mean 0 over the moments, are uncorrelated within a modality, most
        spread first, and sigma says how much: what distillation gives. Rest and ARKit map go along; a regressor
        speaks of the old coefficients and is left out.
        """
        self.orthonormalise()
        old, gem = self.gem, self.gem
        bases, parts, rest, arkit = {}, [], [], []
        before = self._carried(self.began)
        drift = _drift(before, self._moments(), self._carried(old.rest_coefficients), old.sigma)
        for name in MODALITIES:
            here = old.slices[name]
            basis, moments, turn, middle = self._principal(name)
            bases[name] = basis
            parts.append(moments)
            rest.append((self._carried(old.rest_coefficients)[here] + drift[here] - middle) @ turn)
            if old.arkit_weights is not None:
                arkit.append(old.arkit_weights[:, here] @ self.maps[name] @ turn)
        gem = replace(
            old,
            bases=bases,
            colors=np.clip(self._numpy(self.colors), 0, 1).astype(np.float32),
            rest=np.concatenate(rest).astype(np.float32),
            arkit_weights=np.concatenate(arkit, 1).astype(np.float32) if arkit else None,
            regressor=None,
        )
        return gem, np.concatenate(parts, 1).astype(np.float32)

    def state(self) -> State:
        """A copy of everything, to be taken back by ``restore``."""
        maps = (torch.tensor(self.maps[name]) for name in MODALITIES)
        return [*(tensor.detach().clone() for tensor in self.tensors()), *maps]

    @torch.no_grad()
    def restore(self, state: State) -> None:
        """As it was when ``state`` was taken."""
        free = self.tensors()
        for tensor, value in zip(free, state[: len(free)], strict=True):
            tensor.copy_(value)
        self.maps = {name: value.numpy() for name, value in zip(MODALITIES, state[len(free) :], strict=True)}

    def _carried(self, coefficients: Floats) -> Floats:
        """Coefficients [..., coefficients] of the beginning in the units of now."""
        slices = self.gem.slices
        return np.concatenate([coefficients[..., slices[name]] @ self.maps[name] for name in MODALITIES], -1)

    def _moments(self) -> Floats:
        """[F, coefficients] in the units of now."""
        return self._numpy(self.whitened).astype(np.float64) * self.gem.sigma

    def _principal(self, name: str) -> tuple[Basis, Floats, Floats, Floats]:
        """A basis along the main axes of the moments; their coefficients, the turn [K, K], and the mean [K]."""
        moments = self._moments()[:, self.gem.slices[name]]
        components = self._numpy(self.components[name]).astype(np.float64)
        middle = moments.mean(0)
        centred = moments - middle
        values, vectors = np.linalg.eigh(centred.T @ centred / max(1, len(moments) - 1))
        turn = vectors[:, ::-1]
        turned = turn.T @ components
        for column, row in enumerate(turned):
            # as in distillation: the largest entry is positive
            if len(row) and row[np.abs(row).argmax()] < 0:
                turn[:, column] *= -1
                row *= -1
        rows = np.concatenate([(self._numpy(self.means[name]) + middle @ components)[None], turned])
        sigma = np.sqrt(np.maximum(values[::-1], 0))
        sigma = np.maximum(sigma, SIGMA_FLOOR * sigma.max(initial=1e-6))
        return Basis(np.ascontiguousarray(rows, np.float32), sigma.astype(np.float32)), centred @ turn, turn, middle

    @staticmethod
    def _numpy(tensor: Tensor) -> Floats:
        return tensor.detach().cpu().numpy()


def _drift(before: Floats, after: Floats, rest: Floats, sigma: Floats) -> Floats:
    """[coefficients] how far moments [F, coefficients] that were near the rest went when they were free to."""
    distance = np.square((before - rest) / sigma).sum(1) / max(1, before.shape[1])  # one moment has no coefficients
    weights = np.exp(-(distance - distance.min()) / (2 * NEAR_REST**2))
    return weights @ (after - before) / weights.sum()
