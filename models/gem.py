"""The Gaussian Eigen Model: one mean and one small linear basis per modality (equation 1 of the paper)."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..render.gaussians import RawGaussians
from ..render.rotations import sign_aligned
from .arkit import NAMES
from .blend import blend, blend_columns, correlate, gather, moving_columns

MODALITIES = ("position", "rotation", "scale", "opacity")
"""Order of the bases, and of their parts in a coefficient vector."""
CHANNELS = {"position": 3, "rotation": 4, "scale": 3, "opacity": 1}
"""C, the numbers per splat of each modality."""
CLAMP_SIGMAS = 3.0
"""Coefficients stay within this many standard deviations (equation 4)."""
AT_LIMIT = 0.98
"""From this part of CLAMP_SIGMAS on a coefficient is clamped: a regressor's bend towards it, and never arrive."""
_WORTHWHILE = 0.75
"""Share of a basis that moves above which reading all of it in one go is as fast."""
MAX_SPLATS = 1_000_000
MAX_COMPONENTS = 512


@dataclass(frozen=True)
class Moving:
    """The components of a basis where they are not 0: most splats of a head never move."""

    columns: NDArray[np.int32]
    """[M] the places among the N * C, rising."""
    components: NDArray[np.float32]
    """[K, M]."""


@dataclass(frozen=True)
class Basis:
    """One modality: x = mean + k @ components, in raw space."""

    rows: NDArray[np.float32]
    """[K + 1, N * C] the mean as row 0, then the components, most variance first: m of them are one contiguous read."""
    sigma: NDArray[np.float32]
    """[K] standard deviation of each coefficient over the frames it was distilled from, > 0."""

    def __post_init__(self) -> None:
        if self.rows.ndim != 2 or self.rows.dtype != np.float32 or not self.rows.flags.c_contiguous:
            raise ValueError(f"basis rows must be a contiguous float32 matrix, got {self.rows.dtype} {self.rows.shape}")
        if self.sigma.shape != (len(self.rows) - 1,) or not (self.sigma > 0).all():
            raise ValueError(f"a basis of {len(self.rows) - 1} components needs that many sigmas > 0")

    @property
    def mean(self) -> NDArray[np.float32]:
        """[N * C] the mean."""
        return self.rows[0]

    @property
    def components(self) -> NDArray[np.float32]:
        """[K, N * C] the components."""
        return self.rows[1:]

    def __len__(self) -> int:
        return len(self.sigma)

    @cached_property
    def moving(self) -> Moving | None:
        """What composing has to read, found at the first call; None where leaving out the rest would save little.

        The components are not to be changed after that.
        """
        moves = np.empty(self.rows.shape[1], np.bool_)
        moving_columns(self.components, moves)
        columns = np.flatnonzero(moves).astype(np.int32)
        if len(columns) > _WORTHWHILE * len(moves):
            return None
        components = np.empty((len(self), len(columns)), np.float32)
        gather(self.components, columns, components)
        return Moving(columns, components)

    @property
    def nbytes(self) -> int:
        """Bytes in memory once it has been composed."""
        moving = self.moving
        return self.rows.nbytes + (0 if moving is None else moving.columns.nbytes + moving.components.nbytes)

    def compose(self, coefficients: NDArray[np.float32], out: NDArray[np.float32]) -> None:
        """mean + coefficients @ components, in place.

        Args:
            coefficients: [m] of the first m components, m <= K.
            out: [N * C], overwritten.
        """
        if self.moving is None:
            blend(coefficients, self.mean, self.components, out)
        else:
            blend_columns(coefficients, self.mean, self.moving.components, self.moving.columns, out)

    def correlate(self, values: NDArray[np.float32]) -> NDArray[np.float32]:
        """[K] components @ values [N * C]: how a gradient goes back through ``compose``."""
        answer = np.empty(len(self), np.float32)
        if self.moving is None:
            correlate(self.components, values, answer)
        else:
            correlate(self.moving.components, values[self.moving.columns], answer)
        return answer

    def truncated(self, components: int) -> "Basis":
        """The first ``components`` of this basis, without a copy."""
        return Basis(self.rows[: components + 1], self.sigma[:components])


@dataclass(frozen=True)
class Viewing:
    """Where the avatar may be seen from, and how a portrait of it is framed."""

    target: tuple[float, float, float]
    """The middle of the head (chin to crown), metres, canonical space."""
    head_height: float
    """Chin to crown, hair included, metres."""
    yaw_limit_deg: float = 45.0
    """The head was made to be seen from up to this angle to either side."""
    pitch_limit_deg: float = 25.0
    """The same, up and down."""


@dataclass(frozen=True)
class Gem:
    """An avatar. Coefficients are one flat float32 vector, the modalities one behind the other in the order of
    MODALITIES; their unit is the model's own, ``sigma`` their spread."""

    name: str
    """What people call it."""
    bases: Mapping[str, Basis]
    """One Basis per modality of MODALITIES."""
    colors: NDArray[np.float32]
    """[N, 3] sRGB-encoded RGB in [0, 1]."""
    neck_weights: NDArray[np.float32]
    """[N] in [0, 1]: 1 follows the head's pose, 0 stays with the shoulders."""
    neck_pivot: NDArray[np.float32]
    """[3] the point the head turns about, metres, canonical space."""
    uv_index: NDArray[np.uint16]
    """[N, 2] column and row of each splat's texel in the avatar's UV map."""
    uv_size: int
    """Side of that map in texels."""
    viewing: Viewing
    """How it is looked at."""
    arkit_weights: NDArray[np.float32] | None = None
    """[52, coefficients] what one unit of each ARKit weight (order of ``models.arkit.NAMES``) adds to the rest
    coefficients, where known."""
    rest: NDArray[np.float32] | None = None
    """[coefficients] the neutral expression; None means the mean."""
    regressor: bytes | None = None
    """ONNX graph: relative features and head rotation in, clamped coefficients out."""
    about: Mapping[str, str] = field(default_factory=dict)
    """author, licence, consent, source."""

    def __post_init__(self) -> None:
        if tuple(self.bases) != MODALITIES:
            raise ValueError(f"an avatar has the bases {MODALITIES}, got {tuple(self.bases)}")
        count = len(self.colors)
        wanted = {"colors": (count, 3), "neck_weights": (count,), "neck_pivot": (3,), "uv_index": (count, 2)}
        if self.arkit_weights is not None:
            wanted["arkit_weights"] = (len(NAMES), self.coefficient_count)
        if self.rest is not None:
            wanted["rest"] = (self.coefficient_count,)
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} must have the shape {shape}, got {getattr(self, name).shape}")
        for name, basis in self.bases.items():
            if basis.rows.shape[1] != count * CHANNELS[name]:
                raise ValueError(
                    f"the {name} basis is {basis.rows.shape[1]} wide, {count} splats need {count * CHANNELS[name]}"
                )

    def __len__(self) -> int:
        return len(self.colors)

    @property
    def components(self) -> int:
        """K, the components of the modality that has most."""
        return max(len(basis) for basis in self.bases.values())

    @cached_property
    def slices(self) -> dict[str, slice]:
        """Modality -> its part of the coefficient vector."""
        ends = np.cumsum([len(self.bases[name]) for name in MODALITIES]).tolist()
        return {name: slice(end - len(self.bases[name]), end) for name, end in zip(MODALITIES, ends, strict=True)}

    @property
    def coefficient_count(self) -> int:
        """Length of a coefficient vector."""
        return sum(len(basis) for basis in self.bases.values())

    @cached_property
    def sigma(self) -> NDArray[np.float32]:
        """[coefficients] standard deviation of each coefficient."""
        return np.concatenate([self.bases[name].sigma for name in MODALITIES])

    @property
    def rest_coefficients(self) -> NDArray[np.float32]:
        """[coefficients] the neutral expression."""
        return np.zeros(self.coefficient_count, np.float32) if self.rest is None else self.rest

    def clamped(self, coefficients: NDArray[np.floating]) -> NDArray[np.float32]:
        """Coefficients [..., coefficients] within +-3 sigma."""
        limit = CLAMP_SIGMAS * self.sigma
        return np.clip(coefficients, -limit, limit).astype(np.float32)

    def limit_share(self, coefficients: NDArray[np.floating]) -> float:
        """Share of coefficients [coefficients] that are clamped, within 2 % of 3 sigma, in [0, 1]; 0 without any."""
        reached = np.abs(coefficients) >= AT_LIMIT * CLAMP_SIGMAS * self.sigma
        return int(np.count_nonzero(reached)) / max(1, self.coefficient_count)

    def arkit_coefficients(self, weights: NDArray[np.floating]) -> NDArray[np.float32]:
        """Coefficients [..., coefficients] of ARKit weights [..., 52]. ValueError where the avatar has no ARKit map."""
        if self.arkit_weights is None:
            raise ValueError(f"avatar '{self.name}' has no ARKit map; drive it by its coefficients or its regressor")
        return (self.rest_coefficients + weights @ self.arkit_weights).astype(np.float32)

    def compose(
        self, coefficients: NDArray[np.floating], components: int | None = None, out: RawGaussians | None = None
    ) -> RawGaussians:
        """Equation 1: mean + k @ basis for every modality.

        Args:
            coefficients: [coefficients] one flat vector.
            components: how many components of each modality take part; None means all.
            out: the answer of an earlier call, to be overwritten: then nothing is allocated.

        Raises:
            ValueError: where the vector has another length.
        """
        if coefficients.shape != (self.coefficient_count,):
            raise ValueError(f"'{self.name}' has {self.coefficient_count} coefficients, got {coefficients.shape}")
        out = self._blank() if out is None else out
        wanted = np.asarray(coefficients, np.float32)
        targets = (out.positions, out.wxyz, out.log_scales, out.opacity_logits)
        for name, target in zip(MODALITIES, targets, strict=True):
            self.bases[name].compose(wanted[self.slices[name]][:components], target.reshape(-1))
        return out

    def project(self, raw: RawGaussians) -> NDArray[np.float32]:
        """The coefficients [coefficients] whose composition is nearest to ``raw`` (orthonormal components), whatever
        the signs of its quaternions."""
        wxyz = sign_aligned(raw.wxyz, self.bases["rotation"].mean.reshape(-1, 4))
        values = (raw.positions, wxyz, raw.log_scales, raw.opacity_logits)
        parts = [
            self.bases[name].components @ (np.asarray(value, np.float32).reshape(-1) - self.bases[name].mean)
            for name, value in zip(MODALITIES, values, strict=True)
        ]
        return np.concatenate(parts).astype(np.float32)

    def swept(self, modality: str, component: int, steps: int) -> NDArray[np.float32]:
        """Coefficients [steps, coefficients] along one component, from clamp to clamp, all else at rest."""
        index = self.slices[modality].start + component
        if not 0 <= component < len(self.bases[modality]):
            raise ValueError(
                f"'{self.name}' has {len(self.bases[modality])} {modality} components, not {component + 1}"
            )
        rows = np.tile(self.rest_coefficients, (steps, 1))
        rows[:, index] = np.linspace(-CLAMP_SIGMAS, CLAMP_SIGMAS, steps) * self.sigma[index]
        return rows

    def truncated(self, components: int) -> "Gem":
        """The same avatar with at most ``components`` per modality; its regressor no longer fits and is left out."""
        kept = np.concatenate(
            [np.arange(part.start, min(part.stop, part.start + components)) for part in self.slices.values()]
        )
        return replace(
            self,
            bases={name: basis.truncated(min(components, len(basis))) for name, basis in self.bases.items()},
            arkit_weights=None if self.arkit_weights is None else self.arkit_weights[:, kept],
            rest=None if self.rest is None else self.rest[kept],
            regressor=None,
        )

    def _blank(self) -> RawGaussians:
        count = len(self)
        empty = [np.empty((count, CHANNELS[name]), np.float32) for name in MODALITIES]
        return RawGaussians(empty[0], empty[1], empty[2], empty[3][:, 0], self.colors)
