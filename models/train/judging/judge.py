"""How far a drawn picture is from the one that was taken, by every metric of the tables."""

import numpy as np
import torch

from ....render.arrays import Floats32
from ...metrics.flip import flip_map
from ...metrics.pixels import l1, psnr
from ...metrics.structure import ssim
from .. import perceptual
from ..avatars.runs import default_device
from ..perceptual import Perceptual


class Judge:
    """Measures pictures [H, W, 3] in [0, 1]. What cannot be measured on this machine is None."""

    def __init__(self, network: Perceptual | None, device: torch.device | None = None) -> None:
        """``network`` judges LPIPS; None leaves it out. ``device`` is where the network is."""
        self._network = network
        self._device = device or torch.device("cpu")

    @classmethod
    def by(cls, network: str | None) -> "Judge":
        """LPIPS by "vgg" or "alex", where pictures are drawn; None leaves it out. Raises WeightsMissing."""
        if network is None:
            return cls(None)
        device = default_device()
        return cls(perceptual.Perceptual(network, device), device)

    @property
    def lpips_by(self) -> str | None:
        """The network of LPIPS."""
        return None if self._network is None else self._network.network

    def measured(self, image: Floats32, truth: Floats32) -> dict[str, float | None]:
        """METRICS -> value. Raises ValueError for pictures of two sizes."""
        flip = flip_map(image, truth)
        return {
            "PSNR": psnr(image, truth),
            "SSIM": ssim(image, truth),
            "LPIPS": self._lpips(image, truth),
            "L1": l1(image, truth),
            "FLIP": None if flip is None else float(flip.mean()),
        }

    def _lpips(self, image: Floats32, truth: Floats32) -> float | None:
        if self._network is None or min(image.shape[:2]) < self._network.least_side:
            return None
        pair = (
            torch.from_numpy(np.ascontiguousarray(picture)).to(self._device).permute(2, 0, 1)[None]
            for picture in (image, truth)
        )
        with torch.no_grad():
            return float(self._network.lpips(*pair))
