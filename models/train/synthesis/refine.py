"""Refinement: an avatar's bases are changed until its pictures are those that were taken (section 3.1, equation 2).

Every step draws one moment as one camera saw it. Now and then the bases are made orthonormal again, without any picture
changing, and the avatar is looked at by cameras that nothing was learned from: the best one so far is kept.
"""

from collections import Counter
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ....render.diff.rasterize import rasterize
from ....render.diff.tensors import activate
from ...captures.layout import Shot
from ...captures.reader import Capture
from ...gem import MODALITIES, Gem
from ..ahead import Ahead
from ..deck import Deck, spaced
from ..losses import photometric, psnr
from ..perceptual import Perceptual
from .fit import Start
from .freegem import FreeGem
from .torchgem import pose_head
from .unfinished import Course, Unfinished
from .views import View, view_of

Progress = Callable[[str, int, int], None]

RATES = {"position": 0.075, "rotation": 3e-3, "scale": 1e-2, "opacity": 1e-2}
"""Adam's steps for means: typical sizes of a splat, quaternions, ln metres and logits."""
COMPONENT_SHARE = 0.05
"""Components step so that a moment one sigma out along the first moves by this share of that ..."""
ENTRY_SHARE = 0.1
"""... but by no more than this share of a typical entry: a modality that hardly moves would be torn."""
COLOUR_RATE = 1e-3
COEFFICIENT_RATE = 0.01
"""Of a coefficient's sigma."""
LAST_RATE = 0.05
"""Steps fall to this share by the end, along a cosine."""
SLOWER = 0.4
"""Where it has become worse, it goes on from the best so far with steps so much smaller: an avatar of a bare mesh can
take large ones, one that a network has learned cannot."""
JUDGED = 24
"""Pictures that tell whether it has become better."""
GROUNDS = 0.25
"""So often a picture with a mask is laid on a colour drawn by lot: splats in the background's colour give themselves
away."""


@dataclass(frozen=True)
class RefineEffort:
    """What to change, and how long."""

    iterations: int = 3000
    """The paper takes 30,000."""
    interval: int = 1000
    """Steps from one QR to the next; a tenth of a short run."""
    coefficients: bool = True
    """Whether the moments' coefficients are free, too."""
    colors: bool = True
    """Whether the colours are: one for each splat, the same in every frame."""
    perceptual_weight: float = 0.1
    """Zeta of equation 2; without a network it does not count."""
    perceptual_every: int = 4
    perceptual_side: int = 96
    """The network sees a part so many pixels wide, so seldom."""
    seed: int = 0


HELD_OUT, ASIDE, OWN = "the held-out camera", "training pictures set aside", "its own training pictures"
"""What judges, in words."""


@dataclass(frozen=True)
class Refinement:
    """What became of an avatar."""

    gem: Gem
    """The better one: the same object as before where nothing improved."""
    moments: Mapping[int, Start]
    """Timestep -> coefficients of the training moments in ``gem``'s units, and the poses that were given."""
    before: float
    """Decibels on pictures that nothing was learned from, before ..."""
    after: float
    """... and of the best that was found."""
    curve: tuple[tuple[int, float], ...]
    """Steps done and decibels there."""
    losses: tuple[float, ...]
    """Equation 2, step by step."""
    iterations: int
    """How many were done."""
    stopped: bool
    """By Ctrl-C, before all were done."""
    judges: tuple[Shot, ...]
    """The pictures that ``before`` and ``after`` are about."""
    judged_by: str
    """What they are, in words."""

    @property
    def improved(self) -> bool:
        """Whether the avatar changed."""
        return self.after > self.before


def refine(
    gem: Gem,
    capture: Capture,
    moments: Mapping[int, Start],
    effort: RefineEffort = RefineEffort(),
    perceptual: Perceptual | None = None,
    progress: Progress = lambda stage, done, total: None,
    device: torch.device | str = "cpu",
    unfinished: Unfinished | None = None,
) -> Refinement:
    """Equation 2 on a capture's training pictures, for bases, means, and if wanted coefficients and colours.

    Args:
        gem: distilled from this person.
        capture: its ``val`` pictures judge; without any, every tenth training picture is set aside for that; where no
            moment has two pictures, those that are learned from.
        moments: timestep -> expression and pose with which each training moment begins; others are left out.
        effort: what, and how long.
        perceptual: equation 2's network; None leaves that term out.
        progress: told the stage, steps done and steps in all.
        device: where it is computed.
        unfinished: where it is kept how far it is, each time it is judged; what is there is gone on with.

    Raises:
        ValueError: where no training picture has its moment, or coefficients do not belong to the avatar.
        FloatingPointError: where a loss is not finite.
        CaptureError: where the capture changed since it was opened.
    """
    run = _Run(gem, capture, moments, effort, perceptual, torch.device(device))
    return run.refined(progress, unfinished)


class _Run:
    def __init__(
        self,
        gem: Gem,
        capture: Capture,
        moments: Mapping[int, Start],
        effort: RefineEffort,
        perceptual: Perceptual | None,
        device: torch.device,
    ) -> None:
        self._gem, self._capture, self._effort, self._perceptual = gem, capture, effort, perceptual
        self._device = device
        self._moments = moments
        learned, self._judges, self._judged_by = _split(capture, moments)
        for timestep, moment in moments.items():
            if moment.coefficients.shape != (gem.coefficient_count,):
                found = moment.coefficients.shape
                raise ValueError(f"'{gem.name}' has {gem.coefficient_count} coefficients, moment {timestep} {found}")
        self._deck = Deck(learned, 1, effort.seed)
        self._place = {timestep: index for index, timestep in enumerate(sorted({s.timestep for s in learned}))}
        begin = np.stack([moments[timestep].coefficients for timestep in self._place])
        self.free = FreeGem(gem, begin, device)
        self._neck_weights = torch.tensor(gem.neck_weights, device=device)
        self._pivot = torch.tensor(gem.neck_pivot, dtype=torch.float32, device=device)
        self._ahead = Ahead(self._dealt, effort.iterations)
        self._pace = 1.0
        self._optimizer = self._adam()

    def refined(self, progress: Progress, unfinished: Unfinished | None) -> Refinement:
        effort, interval = self._effort, min(self._effort.interval, max(1, self._effort.iterations // 10))
        course, stopped = self._begun(unfinished), False
        try:
            for step in range(course.done, effort.iterations):
                course.losses.append(self._step(step))
                course.done = step + 1
                progress("refine", course.done, effort.iterations)
                if course.done % interval == 0 or course.done == effort.iterations:
                    self._judge(course)
                    if unfinished is not None:
                        unfinished.write(self._kept(course))
        except KeyboardInterrupt:
            stopped = True
            if course.curve[-1][0] < course.done:
                self._judge(course)
        finally:
            self._ahead.close()
        answer, found = self._gem, self.free.began
        if course.best > course.before:
            self.free.restore(course.kept)
            answer, found = self.free.finished()
        moments = {
            timestep: Start(found[index].astype(np.float32), self._moments[timestep].pose)
            for timestep, index in self._place.items()
        }
        curve, losses = tuple(course.curve), tuple(course.losses)
        return Refinement(
            answer,
            moments,
            course.before,
            course.best,
            curve,
            losses,
            course.done,
            stopped,
            tuple(self._judges),
            self._judged_by,
        )

    def _judge(self, course: Course) -> None:
        self.free.orthonormalise()
        course.curve.append((course.done, self.quality()))
        if course.curve[-1][1] > course.best:
            course.best, course.kept = course.curve[-1][1], self.free.state()
            return
        self.free.restore(course.kept)
        self._pace *= SLOWER
        self._optimizer = self._adam()

    def _kept(self, course: Course) -> dict[str, Any]:
        """All that the next step depends on."""
        adam = self._optimizer.state_dict()["state"]
        return {"course": vars(course), "pace": self._pace, "free": self.free.state(), "adam": adam}

    def _begun(self, unfinished: Unfinished | None) -> Course:
        """Where it was stopped, or the beginning."""
        kept = None if unfinished is None else unfinished.read()
        if kept is None:
            before = self.quality()
            return Course(before, before, self.free.state(), curve=[(0, before)])
        self._pace = kept["pace"]
        self.free.restore(kept["free"])
        groups = self._optimizer.state_dict()["param_groups"]
        self._optimizer.load_state_dict({"state": kept["adam"], "param_groups": groups})
        return Course(**kept["course"])

    @torch.no_grad()
    def quality(self) -> float:
        """Mean PSNR of the pictures that judge."""
        values = []
        for shot in self._judges:
            view = view_of(self._capture, shot, device=self._device)
            values.append(psnr(self._drawn(shot, view).clamp(0, 1), view.picture))
        return float(np.mean(values))

    def _dealt(self, step: int) -> Callable[[], tuple[Shot, View]]:
        """The picture of a step, over a random background now and then."""
        (shot,), lot = self._deck.dealt(step), self._deck.lot(step, "ground")
        ground = lot.uniform(size=3).tolist() if lot.uniform() < GROUNDS else None
        return lambda: (shot, view_of(self._capture, shot, ground, self._device))

    def _step(self, step: int) -> float:
        effort = self._effort
        share = step / effort.iterations
        for group in self._optimizer.param_groups:
            group["lr"] = self._pace * group["rate"] * (LAST_RATE + (1 - LAST_RATE) * 0.5 * (1 + np.cos(np.pi * share)))
        shot, view = self._ahead.step(step)
        image = self._drawn(shot, view)
        loss = photometric(image, view.picture)
        if self._perceptual is not None and step % effort.perceptual_every == 0:
            seen, wanted = _parts((image, view.picture), effort.perceptual_side, self._deck.lot(step, "crop"))
            weight = effort.perceptual_weight * effort.perceptual_every
            loss = loss + weight * self._perceptual.feature_loss(seen, wanted)
        value = float(loss.detach())
        if not np.isfinite(value):
            raise FloatingPointError(f"the loss of step {step} is {value}: picture {shot.picture}")
        self._optimizer.zero_grad()
        loss.backward()
        self._optimizer.step()
        with torch.no_grad():
            self.free.colors.clamp_(0, 1)
        return value

    def _drawn(self, shot: Shot, view: View) -> Tensor:
        pose = self._moments[shot.timestep].pose
        raw = self.free.compose(self._place[shot.timestep])
        turn, move = (torch.tensor(x, device=self._device) for x in (pose.turn, pose.move))
        posed = pose_head(raw, self._neck_weights, self._pivot, turn, move)
        return rasterize(activate(posed), view.camera, view.background)

    def _adam(self) -> torch.optim.Optimizer:
        free, effort = self.free, self._effort
        size = float(np.exp(np.median(self._gem.bases["scale"].mean.reshape(-1, 3).max(1))))
        groups: list[tuple[list[Tensor], float]] = []
        for name in MODALITIES:
            basis, rate = self._gem.bases[name], RATES[name] * (size if name == "position" else 1)
            groups.append(([free.means[name]], rate))
            rate *= COMPONENT_SHARE / max(float(basis.sigma.max(initial=0)), 1e-12)
            groups.append(([free.components[name]], min(rate, ENTRY_SHARE / basis.rows.shape[1] ** 0.5)))
        if effort.colors:
            groups.append(([free.colors], COLOUR_RATE))
        if effort.coefficients:
            groups.append(([free.whitened], COEFFICIENT_RATE))
        for tensor in free.tensors():
            tensor.requires_grad_(tensor.numel() > 0 and any(tensor is one for group, _ in groups for one in group))
        options = [{"params": group, "lr": rate, "rate": rate} for group, rate in groups if group[0].numel()]
        return torch.optim.Adam(options, fused=True)


def _split(capture: Capture, known: Container[int]) -> tuple[list[Shot], list[Shot], str]:
    """What is learned from, what judges, and what that is, of the moments that are known.

    Without a held-out camera every tenth picture is set aside, of moments that keep another one. Where there is none,
    the training pictures themselves judge.
    """
    learned = [shot for shot in capture.train if shot.timestep in known]
    if not learned:
        raise ValueError(f"{capture.folder}: no training picture belongs to a moment that is known")
    views = Counter(shot.timestep for shot in learned)
    judges, what = [shot for shot in capture.val if shot.timestep in views], HELD_OUT
    if not judges:
        judges, what = [], ASIDE
        for shot in learned[9::10] or learned[-1:]:
            if views[shot.timestep] > 1:
                views[shot.timestep] -= 1
                judges.append(shot)
        aside = {shot.picture for shot in judges}
        learned = [shot for shot in learned if shot.picture not in aside]
    if not judges:
        judges, what = learned, OWN
    return learned, spaced(judges, JUDGED), what


def _parts(images: Sequence[Tensor], side: int, lot: np.random.Generator) -> list[Tensor]:
    """The same part [1, 3, side, side] of pictures [H, W, 3], somewhere."""
    height, width = images[0].shape[:2]
    top, left = (int(lot.integers(0, max(1, length - side + 1))) for length in (height, width))
    return [image[top : top + side, left : left + side].permute(2, 0, 1)[None] for image in images]
