"""How an avatar is learned: every number of it in one place, and three choices of them."""

from dataclasses import dataclass, fields, replace
from math import isfinite
from typing import Literal, get_args

from .cnn import Architecture

Model = Literal["cnn", "rigged", "blendshapes"]
"""What is learned: the paper's CNN, or one of the two baselines beside it."""
MODELS = get_args(Model)
LARGEST = {"size": 1024, "width": 512}
RATED = 16
"""Channels at full resolution that learning rates of networks are stated for."""
LARGEST_COUNT, LARGEST_WEIGHT = 10_000_000, 1000.0
"""What no sound plan exceeds: a config from elsewhere must not fill the memory."""


@dataclass(frozen=True)
class Plan:
    """Numbers that, with the capture, determine the outcome; they are kept in the run's config.json."""

    size: int
    """Texels along a side of the UV map: a power of two."""
    width: int
    """Channels of the network at full resolution."""
    levels: int
    """How often its maps are halved. This and the width are the CNN's alone."""
    steps: int
    views: int = 2
    """Pictures a step, all of one moment: the model answers once for them."""
    colors_first: int = 100
    """So many steps learn the colours of the bare mesh, before anything moves. At ``steps`` it is a bare mesh."""
    network_rate: float = 2e-3
    """Learning rates fall along half a cosine to 2 % of these: of a network RATED channels wide; a wider one takes
    less in proportion (``rates``) ..."""
    constant_rate: float = 2e-2
    """... of the part of the residuals that no expression changes ..."""
    color_rate: float = 1e-2
    """... and of the colours; twice that while they are learned alone."""
    perceptual: float = 0.02
    """Zeta, the weight of the VGG term in equation 2; 0 leaves it out."""
    perceptual_every: int = 1
    """Steps between two that look at it; it counts so many times as much then."""
    perceptual_side: int | None = None
    """Pixels of the random square that it looks at; None is the whole picture."""
    focus: float = 2.0
    """How much more a pixel of mouth and eyes counts than one elsewhere."""
    offset_weight: float = 2e-4
    """Of the mean squared offset, in units of residuals.STEP."""
    growth_weight: float = 2e-4
    """Of the mean squared change of the log scales, in the same units."""
    checkpoint_every: int = 100
    preview_every: int = 500
    seed: int = 0
    model: Model = "cnn"
    shape_rate: float = 1e-2
    """Learning rate of the blendshapes."""

    def __post_init__(self) -> None:
        for field in fields(self):
            _check(field.name, getattr(self, field.name))
        if self.model not in MODELS:
            raise ValueError(f"model {self.model!r} is none of {', '.join(MODELS)}")
        if self.size & (self.size - 1) or not 1 <= self.levels < self.size.bit_length():
            raise ValueError(f"maps of {self.size} texels cannot be halved {self.levels} times")

    @property
    def rates(self) -> dict[str, float]:
        """The learning rate of each group of parameters (``Avatar.groups``).

        Adam moves every weight by the rate, so what a convolution answers moves by the rate times the channels that go
        in; the rate has to fall as they grow (Yang et al., Tensor Programs V), or the first steps throw a wide network
        to its bounds.
        """
        return {
            "network": self.network_rate * min(1.0, RATED / self.width),
            "shapes": self.shape_rate,
            "constant": self.constant_rate,
            "colors": self.color_rate,
        }

    @property
    def architecture(self) -> Architecture:
        """The network's part of it."""
        return Architecture(self.size, self.width, self.levels)

    def changed(
        self,
        steps: int | None = None,
        perceptual: bool = True,
        seed: int = 0,
        model: Model = "cnn",
        size: int | None = None,
    ) -> "Plan":
        """Another length, seed, model or map size, or no VGG term; short runs spend a tenth at most on colours."""
        steps = self.steps if steps is None else steps
        return replace(
            self,
            size=self.size if size is None else size,
            steps=steps,
            colors_first=min(self.colors_first, -(-steps // 10)),
            perceptual=self.perceptual if perceptual else 0.0,
            seed=seed,
            model=model,
        )


_WEIGHTS = tuple(field.name for field in fields(Plan) if field.type is float)


def _check(name: str, value: object) -> None:
    """Raises ValueError for a number that no training can have."""
    if name == "model" or (name == "perceptual_side" and value is None):
        return
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{name} {value!r} is no number")
    if name in _WEIGHTS:
        if not (isfinite(value) and 0 <= value <= LARGEST_WEIGHT):
            raise ValueError(f"{name} {value} is not within 0..{LARGEST_WEIGHT:.0f}")
        return
    least, most = int(name not in ("colors_first", "seed")), LARGEST.get(name, LARGEST_COUNT)
    if not isinstance(value, int) or not least <= value <= most:
        raise ValueError(f"{name} {value} is no whole number within {least}..{most}")


PRESETS = {
    "tiny": Plan(128, 16, 4, steps=2500, perceptual_every=8, perceptual_side=96),
    "small": Plan(128, 32, 4, steps=20_000, perceptual_every=4, perceptual_side=128, preview_every=1000),
    "full": Plan(256, 64, 5, steps=100_000, views=4, colors_first=1000, checkpoint_every=500, preview_every=2500),
}
"""tiny is minutes on two cores, small an hour or two, full is for a GPU."""
