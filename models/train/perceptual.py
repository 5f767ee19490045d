"""Pictures compared by what a network sees in them: the VGG term of equation 2, and LPIPS (Zhang et al. 2018)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from .perceptualweights import WeightsMissing, read_weights, weights

__all__ = ["NETWORKS", "TINY", "Perceptual", "WeightsMissing"]

SHIFT, SCALE = (-0.030, -0.088, -0.188), (0.458, 0.448, 0.450)
"""LPIPS 0.1 brings pictures in [-1, 1] to the networks' range with these."""
TINY_SEED = 0


@dataclass(frozen=True)
class Layer:
    """One convolution with its ReLU."""

    channels: int
    size: int = 3
    stride: int = 1
    padding: int = 1
    pooled: tuple[int, int] | None = None
    """Window and stride of the maximum that is taken before it."""
    seen: bool = False
    """Its output is compared."""


def _blocks(widths: Sequence[tuple[int, int]]) -> tuple[Layer, ...]:
    """VGG: so many 3x3 convolutions of one width, then a 2x2 maximum."""
    return tuple(
        Layer(channels, pooled=(2, 2) if block and not i else None, seen=i == count - 1)
        for block, (channels, count) in enumerate(widths)
        for i in range(count)
    )


TINY = "tiny"
"""A network of two small layers with random weights, for trials and tests: it needs no file."""
LEVELS = 3
"""Compared layers of the loss: half of VGG16's cost, and they hold what pixels of a face differ by."""
NETWORKS: Mapping[str, tuple[Layer, ...]] = {
    "vgg": _blocks([(64, 2), (128, 2), (256, 3), (512, 3), (512, 3)]),
    "alex": (
        Layer(64, 11, 4, 2, seen=True),
        Layer(192, 5, 1, 2, (3, 2), seen=True),
        Layer(384, pooled=(3, 2), seen=True),
        Layer(256, seen=True),
        Layer(256, seen=True),
    ),
    TINY: _blocks([(8, 1), (12, 1)]),
}
"""VGG16 is compared after its last ReLU of each block, AlexNet after each ReLU."""


class Perceptual:
    """A frozen network that compares pictures [B, 3, H, W], sRGB in [0, 1]; gradients reach the pictures."""

    def __init__(self, network: str = "vgg", device: str | torch.device = "cpu", cache: Path | None = None) -> None:
        """``network`` is "vgg", "alex" (20 times faster) or "tiny". The first two fetch their weights once.

        Raises WeightsMissing where they cannot be had, KeyError for another network.
        """
        self.network = network
        self._layers = NETWORKS[network]
        arrays = _random(self._layers) if network == TINY else read_weights(weights(network, cache))
        values = {name: torch.from_numpy(array).to(device) for name, array in arrays.items()}
        self._convolutions = [
            (values[f"conv.{i}.weight"].contiguous(memory_format=torch.channels_last), values[f"conv.{i}.bias"])
            for i in range(len(self._layers))
        ]
        seen = sum(layer.seen for layer in self._layers)
        self._heads = [values[f"head.{i}"] for i in range(seen)]
        self._shift, self._scale = (torch.tensor(v, device=device).view(1, 3, 1, 1) for v in (SHIFT, SCALE))

    @property
    def least_side(self) -> int:
        """Pixels that a picture's side needs to reach the last layer."""
        side = 1
        for layer in reversed(self._layers):
            side = max(1, (side - 1) * layer.stride + layer.size - 2 * layer.padding)
            if layer.pooled is not None:
                window, stride = layer.pooled
                side = (side - 1) * stride + window
        return side

    def features(self, images: Tensor, levels: int | None = None) -> list[Tensor]:
        """What the network sees at its compared layers, the first ``levels`` of them: each [B, C, h, w]."""
        if images.ndim != 4 or images.shape[1] != 3:
            raise ValueError(f"pictures must be [B, 3, H, W], got {tuple(images.shape)}")
        found: list[Tensor] = []
        x = ((2 * images - 1 - self._shift) / self._scale).contiguous(memory_format=torch.channels_last)
        for layer, (weight, bias) in zip(self._layers, self._convolutions, strict=True):
            if layer.pooled is not None:
                x = functional.max_pool2d(x, *layer.pooled)
            x = functional.relu(functional.conv2d(x, weight, bias, layer.stride, layer.padding))
            if layer.seen:
                found.append(x)
                if len(found) == levels:
                    break
        return found

    def feature_loss(self, image: Tensor, target: Tensor) -> Tensor:
        """Equation 2's VGG term: the mean difference of features over their mean size in ``target``, averaged over the
        first LEVELS compared layers; 0 for the same picture, about 1 for unrelated ones.

        Over their size, because features grow by layers of magnitude from block to block. ``target`` gets no gradient.

        Args:
            image, target: [B, 3, H, W] in [0, 1]; a part of a picture does, and is cheaper.
        """
        with torch.no_grad():
            wanted = self.features(target, LEVELS)
        terms = [
            (got - want).abs().mean() / want.mean().clamp_min(1e-6)
            for got, want in zip(self.features(image, LEVELS), wanted, strict=True)
        ]
        return torch.stack(terms).mean()

    def lpips(self, image: Tensor, other: Tensor) -> Tensor:
        """[B] LPIPS 0.1 of pictures [B, 3, H, W] in [0, 1]: 0 for equal ones, smaller is better, no unit."""
        total = image.new_zeros(len(image))
        for one, two, head in zip(self.features(image), self.features(other), self._heads, strict=True):
            difference = (_unit(one) - _unit(two)).square()
            total = total + torch.einsum("bchw,c->b", difference, head) / (one.shape[2] * one.shape[3])
        return total


def _unit(features: Tensor) -> Tensor:
    # where nothing was seen, the root's slope would be infinite
    return features / ((features.square().sum(1, keepdim=True) + 1e-20).sqrt() + 1e-10)


def _random(layers: Sequence[Layer]) -> dict[str, NDArray[np.float32]]:
    rng = np.random.default_rng(TINY_SEED)
    arrays: dict[str, NDArray[np.float32]] = {}
    channels, seen = 3, 0
    for index, layer in enumerate(layers):
        shape = layer.channels, channels, layer.size, layer.size
        spread = np.sqrt(2 / (channels * layer.size**2))
        arrays[f"conv.{index}.weight"] = rng.normal(0, spread, shape).astype(np.float32)
        arrays[f"conv.{index}.bias"] = np.zeros(layer.channels, np.float32)
        if layer.seen:
            arrays[f"head.{seen}"] = np.full(layer.channels, 1 / layer.channels, np.float32)
            seen += 1
        channels = layer.channels
    return arrays
