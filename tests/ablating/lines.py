"""The lines of the table: a model, how well it draws expressions it never saw, and what it costs."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from gemheads.models.captures.heldout import judged_shots, viewers
from gemheads.models.captures.layout import Shot
from gemheads.models.captures.reader import Capture
from gemheads.models.captures.standin import StandIn
from gemheads.models.gem import MODALITIES, Gem
from gemheads.models.gemfile import load_gem, save_gem
from gemheads.models.importers.adopt import adopt
from gemheads.models.metrics.pixels import psnr
from gemheads.models.train.avatars.run_source import run_source
from gemheads.models.train.avatars.runs import Run
from gemheads.models.train.synthesis.fit import HeadPose, Start
from gemheads.models.train.synthesis.refine import RefineEffort, refine
from gemheads.render.gaussians import RawGaussians
from numpy.typing import NDArray

from .bases import Linear, joint, led_by_positions, off_orthonormal, one_each
from .fitting import Searched, fitted
from .spaces import Row, Space

Image = NDArray[np.float32]
AS_IT_IS = "as it is"
DRAWS = 20
"""Sets of coefficients by lot."""
MOVES = 2 / 255
"""A pixel moves where the run's own picture differs by more than this from the run at rest in the same pose."""


@dataclass(frozen=True)
class Effort:
    """How much is done."""

    components: int = 30
    shots: int = 8
    """Held-out pictures."""
    iterations: int = 600
    """Steps of refinement; 0 leaves it out."""
    evaluations: int = 30
    """Of each fit; 0 leaves fits out."""


@dataclass(frozen=True)
class Quality:
    """How near pictures come to others, means of decibels."""

    everywhere: float
    moving: float
    """Over the pixels that the expression moves: most of a picture is ground, hair and shoulders."""


@dataclass(frozen=True)
class Line:
    """One variant."""

    name: str
    to_run: Quality | None
    """What it draws of projected splats, against what the run's own splats look like (None for the run) ..."""
    to_taken: Quality
    """... and against the pictures that were taken."""
    fitted: Quality | None
    """Against the taken pictures, coefficients found in the same moment's pictures from other cameras."""
    coefficients: int
    numbers: int
    """In the components of all modalities."""
    impossible: float | None
    """Share of splats that coefficients drawn from +-3 sigma make impossible, so that they are cut; None: not asked."""
    megabytes: float | None
    """Of the file; None for what no file can hold."""
    off_orthonormal: float | None
    """Largest entry of |B B^T - 1|; None where projection does not need it."""
    images: tuple[Image, ...]
    """What it draws of each held-out picture, projected."""


class Ablation:
    """Held-out moments of a capture, and the run whose splats are reduced in one way or another."""

    def __init__(self, capture: Capture, run: Run, effort: Effort) -> None:
        self.capture, self.effort = capture, effort
        self.shots = judged_shots(capture, "test", effort.shots)
        self._source = run_source(run)
        self._frames = list(self._source.frames())
        self.gem = adopt(self._source, "ablated", effort.components)[0]
        self.held_out = [run.splats(capture.tracked(shot.timestep)) for shot in self.shots]
        self._standin = StandIn(capture)
        self.taken = [self._standin.truth(shot) for shot in self.shots]
        self.drawn = [self._draw(raw, shot) for raw, shot in zip(self.held_out, self.shots, strict=True)]
        still = [self._draw(self._source.rest, shot) for shot in self.shots]
        self._moving = [
            (np.abs(a - b).max(-1) > MOVES).astype(np.float32) for a, b in zip(self.drawn, still, strict=True)
        ]

    def lines(self, folder: Path) -> Iterator[Line]:
        """All of them, one after the other; ``folder`` holds avatars meanwhile."""
        rest, gem = self._source.rest, self.gem
        raw = Space(rest)
        taken = self._near(self.drawn, self.taken)
        yield Line("the run, not reduced", None, taken, None, 0, 0, None, None, None, tuple(self.drawn))
        yield self._reduced(AS_IT_IS, raw, one_each, searched=True)
        yield self._reduced(
            "metres and opacities, not their logarithms and logits", Space(rest, activated=True), one_each
        )
        yield self._reduced("tangent vectors, not quaternions", Space(rest, tangent=True), one_each)
        yield self._reduced("one joint PCA, so shared coefficients", raw, joint, searched=True)
        yield self._reduced("coefficients shared: those of the positions", raw, led_by_positions, searched=True)
        if self.effort.iterations:
            yield self._refined(f"refined, {self.effort.iterations} steps")
        floats = sum(basis.rows.nbytes + basis.sigma.nbytes for basis in gem.bases.values()) + gem.colors.nbytes
        yield self._stored("fp32 basis", gem, floats / 1e6)
        for kind in ("fp16", "int8"):
            path = folder / f"{kind}.gem"
            save_gem(gem, path, kind)
            yield self._stored(f"{kind} basis", load_gem(path), path.stat().st_size / 1e6)

    def _reduced(
        self, name: str, space: Space, model_of: Callable[[list[Row], int], Linear], searched: bool = False
    ) -> Line:
        model = model_of([space.row(frame) for frame in self._frames], self.effort.components)
        answers = [space.splats(model.answer(space.row(raw))) for raw in self.held_out]
        off = None if model.shared else off_orthonormal(model.components)
        rng = np.random.default_rng(0)
        cut = float(np.mean([space.impossible(model.drawn(rng)) for _ in range(DRAWS)]))
        return self._line(name, answers, model if searched else None, model.count, model.numbers, cut, None, off)

    def _stored(self, name: str, gem: Gem, megabytes: float | None, model: Linear | None = None) -> Line:
        answers = [gem.compose(gem.project(raw)) for raw in self.held_out]
        bases = [gem.bases[modality].components for modality in MODALITIES]
        numbers = sum(basis.size for basis in bases)
        off = off_orthonormal(bases)
        return self._line(name, answers, model, gem.coefficient_count, numbers, None, megabytes, off)

    def _refined(self, name: str) -> Line:
        moments = {}
        for timestep, frame in zip(self._source.moments, self._frames, strict=True):
            tracked = self.capture.tracked(timestep)
            moments[timestep] = Start(self.gem.project(frame), HeadPose(tracked.rotation, tracked.translation))
        gem = refine(self.gem, self.capture, moments, RefineEffort(self.effort.iterations)).gem
        parts = [gem.bases[modality] for modality in MODALITIES]
        model = Linear(
            tuple(basis.mean for basis in parts),
            tuple(basis.components for basis in parts),
            tuple(basis.components.T for basis in parts),
            tuple(basis.sigma for basis in parts),
            shared=False,
        )
        return self._stored(name, gem, None, model)

    def _line(
        self,
        name: str,
        answers: list[RawGaussians],
        model: Linear | None,
        coefficients: int,
        numbers: int,
        impossible: float | None,
        megabytes: float | None,
        off: float | None,
    ) -> Line:
        images = [self._draw(raw, shot) for raw, shot in zip(answers, self.shots, strict=True)]
        found = None
        if model is not None and self.effort.evaluations:
            found = self._searched(Searched.of(model, self.gem))
        return Line(
            name,
            self._near(images, self.drawn),
            self._near(images, self.taken),
            found,
            coefficients,
            numbers,
            impossible,
            megabytes,
            off,
            tuple(images),
        )

    def _searched(self, model: Searched) -> Quality:
        images = []
        for shot in self.shots:
            others = viewers(self.capture, "test", shot)
            images.append(self._draw(fitted(model, self.capture, others, self.effort.evaluations), shot))
        return self._near(images, self.taken)

    def _draw(self, raw: RawGaussians, shot: Shot) -> Image:
        return self._standin.draw(raw, self.gem.neck_weights, self.gem.neck_pivot, shot)

    def _near(self, images: Sequence[Image], truths: Sequence[Image]) -> Quality:
        pairs = list(zip(images, truths, strict=True))
        moving = [psnr(a, b, mask) for (a, b), mask in zip(pairs, self._moving, strict=True) if mask.any()]
        return Quality(float(np.mean([psnr(*pair) for pair in pairs])), float(np.mean(moving)))
