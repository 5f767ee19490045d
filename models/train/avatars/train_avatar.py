"""Training an avatar on a capture: the loop, what it survives, and what it leaves in the run's folder.

Every choice of chance depends on the seed and the number of the step alone, so a run that was killed goes on from its
last checkpoint to the same avatar, bit for bit on a CPU.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ....render.diff.tensors import activate
from ...captures.reader import Capture
from ...captures.texels import texels_of
from ...captures.texture import texel_colors
from ...wholefile import write_whole
from ..ahead import Ahead
from ..deck import Deck, frontal, spaced
from ..perceptual import Perceptual
from ..synthesis.views import View
from .astray import astray
from .focus import focus_map, regions_of
from .kinds import KINDS, untrained
from .objective import TERMS, Objective
from .plan import Plan
from .previews import comparison, loss_curve, loss_table, write_png
from .runs import (
    CHECKPOINT,
    PREVIEWS,
    Config,
    RunError,
    begin_run,
    broken,
    default_device,
    load,
    read_checkpoint,
    write_checkpoint,
    write_config,
)
from .scene import Scene

Progress = Callable[[str, int, int], None]

FINAL_RATE = 0.02
"""Share of the learning rates that is left at the end."""
COLOR_BOOST = 2.0
"""Of the colours' rate while they are learned alone."""
LARGEST_GRADIENT = 1.0
"""Longer ones are cut to this length."""
PATIENCE = 5
"""So many non-finite steps in a row take the run back to its last checkpoint ..."""
RETURNS = 3
"""... and so many returns without a sound step between them end it."""
SLOWER = 0.5
"""Factor on all rates once training has left what it had learned."""
BETAS = (0.9, 0.99)
"""Of Adam. With the usual .999 it sees too late that gradients have grown: a run of the preset `tiny`
was thrown off in its 570th step, and did not come back."""
JUDGED = 12
"""Pictures of a split that the quality is measured on while training."""


@dataclass(frozen=True)
class Outcome:
    """What a training came to."""

    steps: int
    seconds: float
    """Of this call alone."""
    loss: float
    """Mean over the last tenth of the steps."""
    val_psnr: float
    """Decibels on JUDGED pictures of the held-out camera; NaN where the capture has none ..."""
    test_psnr: float
    """... and of held-out expressions."""
    skipped: int
    """Steps that were not finite."""
    restored: int
    """Returns to a checkpoint on their account."""


@dataclass(frozen=True)
class Lesson:
    """What one step learns from."""

    timestep: int
    views: list[View]
    focus: list[Tensor]
    """[H, W] of each view: where people look."""


def train_avatar(
    capture: Capture,
    folder: Path,
    plan: Plan,
    perceptual: Perceptual | None = None,
    device: str | torch.device | None = None,
    progress: Progress = lambda stage, done, total: None,
) -> Outcome:
    """Train an avatar, or go on with the training in ``folder``.

    Args:
        capture: opened.
        folder: the run's; made where it is missing.
        plan: must be that of the run where there is one already.
        perceptual: network of the VGG term; None leaves it out.
        device: None takes CUDA where gsplat draws, else the CPU.
        progress: is told after each step.

    Raises:
        RunError: where the folder holds another run, or training does not stay finite.
        CaptureError: where the capture lacks what drives the plan's model, or changed meanwhile.
        OSError: where the folder cannot be written.
    """
    KINDS[plan.model].require(capture)
    config = begin_run(folder, capture, plan)
    trainer = Trainer(capture, folder, config, perceptual, device or default_device())
    trainer.resume()
    return trainer.run(progress)


class Trainer:
    """A training between two steps."""

    def __init__(
        self, capture: Capture, folder: Path, config: Config, perceptual: Perceptual | None, device: str | torch.device
    ) -> None:
        plan = config.plan
        self.folder, self.config, self.plan = folder, config, plan
        texels = texels_of(capture.template, plan.size)
        with torch.random.fork_rng():
            torch.manual_seed(plan.seed)
            self.avatar = untrained(texels, plan).to(device)
        self.scene = Scene(capture, texels, self.avatar, torch.device(device))
        self.objective = Objective(plan, perceptual)
        self.deck = Deck(capture.train, plan.views, plan.seed)
        self._ahead = Ahead(self._dealt, plan.steps)
        self.step, self.skipped, self.restored = 0, 0, 0
        self._stumbles, self._returns, self._pace = 0, 0, 1.0
        self._rows: list[list[float]] = []
        self._regions = regions_of(texels, capture.template.part_names)
        groups = self.avatar.groups()
        self._rates = [plan.rates[name] for name in groups]
        self._optimizer = torch.optim.Adam(
            [{"params": parameters} for parameters in groups.values()], betas=BETAS, fused=True
        )
        self._ticked = time.monotonic()

    def resume(self) -> None:
        """Go back to the folder's checkpoint, or make the first one. Raises RunError, OSError."""
        for half_written in self.folder.glob(f".{CHECKPOINT}.*.partial"):
            half_written.unlink()
        state = read_checkpoint(self.folder)
        if state is None:
            colors, _ = texel_colors(self.scene.capture, self.scene.texels)
            with torch.no_grad():
                self.avatar.colors.copy_(torch.from_numpy(colors))
            self._keep()
            return
        self._load(state)
        try:
            self.step = int(state["step"])
            self._rows = state["rows"].double().reshape(self.step, len(TERMS) + 2).tolist()
            faults = self.skipped, self.restored, self._stumbles, self._returns = [int(x) for x in state["faults"]]
            self._pace = float(state.get("pace", 1.0))
            if min(faults) < 0 or not 0 < self._pace <= 1:
                raise ValueError(f"faults {faults}, pace {self._pace}")
        except (KeyError, TypeError, AttributeError, ValueError, RuntimeError, OverflowError) as error:
            raise broken(self.folder, error) from error

    def run(self, progress: Progress) -> Outcome:
        """All steps that are left; then the folder holds everything."""
        started = self._ticked = time.monotonic()
        try:
            while self.step < self.plan.steps:
                self._learn()
                if self.step % self.plan.checkpoint_every == 0 or self.step == self.plan.steps:
                    self._keep_to_what_is_good()
                if self.step % self.plan.preview_every == 0 and self.step < self.plan.steps:
                    self._show()
                progress("train", self.step, self.plan.steps)
        finally:
            self._ahead.close()
        self._show()
        capture, late = self.scene.capture, [row[-1] for row in self._rows[-max(1, len(self._rows) // 10) :]]
        return Outcome(
            steps=self.step,
            seconds=time.monotonic() - started,
            loss=float(np.nanmean(late)) if np.isfinite(late).any() else float("nan"),
            val_psnr=self.scene.quality(spaced(capture.val, JUDGED), self._bare),
            test_psnr=self.scene.quality(spaced(capture.test, JUDGED), self._bare),
            skipped=self.skipped,
            restored=self.restored,
        )

    @property
    def _bare(self) -> bool:
        return self.step <= self.plan.colors_first

    def _learn(self) -> None:
        """One step, from its pictures to its new weights; one that is not finite changes nothing."""
        for group, rate in zip(self._optimizer.param_groups, self._rates, strict=True):
            group["lr"] = rate * self._rate_share() * self._pace
        self._optimizer.zero_grad(set_to_none=True)
        terms = self._terms()
        loss = self.objective.total(terms)
        sound = bool(torch.isfinite(loss))
        if sound:
            loss.backward()
            parameters = [x for x in self.avatar.parameters() if x.grad is not None]
            sound = bool(torch.isfinite(torch.nn.utils.clip_grad_norm_(parameters, LARGEST_GRADIENT)))
        self._rows.append([self.step, *terms.detach().tolist(), float(loss.detach())])
        self.step += 1
        if sound:
            self._optimizer.step()
            with torch.no_grad():
                self.avatar.colors.clamp_(0, 1)
            self._stumbles = self._returns = 0
        else:
            self._stumble()

    def _dealt(self, step: int) -> Callable[[], Lesson]:
        """What a step learns from: pictures of one moment, each over a background of its own."""
        shots, lot = self.deck.dealt(step), self.deck.lot(step, "ground")
        grounds = [lot.uniform(0, 1, 3).tolist() for _ in shots]
        mesh = self.scene.capture.tracked(shots[0].timestep)  # here: what a capture keeps in memory is one thread's

        def read() -> Lesson:
            surface = self.scene.surface(mesh)
            seen = [torch.from_numpy(focus_map(self._regions, surface, shot.camera)) for shot in shots]
            views = [self.scene.view(*taken) for taken in zip(shots, grounds, strict=True)]
            return Lesson(shots[0].timestep, views, [focus.to(self.scene.device) for focus in seen])

        return read

    def _terms(self) -> Tensor:
        """[5] the terms of this step's loss; NaN where splats are not finite, which engines leave out silently."""
        lesson = self._ahead.step(self.step)
        lot = self.deck.lot(self.step, "crop")
        raw, residuals = self.scene.splats(lesson.timestep, self.step < self.plan.colors_first)
        if not all(bool(torch.isfinite(tensor).all()) for tensor in raw):
            return torch.full((len(TERMS),), float("nan"), requires_grad=True)
        splats, totals = activate(raw), []
        for view, focus in zip(lesson.views, lesson.focus, strict=True):
            image = self.scene.draw(splats, view)
            totals.append(self.objective.of_picture(image, view.picture, focus, self.step, lot))
        return torch.cat([torch.stack(totals).mean(0), self.objective.of_residuals(residuals)])

    def _rate_share(self) -> float:
        if self.step < self.plan.colors_first:
            return COLOR_BOOST
        done = (self.step - self.plan.colors_first) / max(1, self.plan.steps - self.plan.colors_first)
        return FINAL_RATE + (1 - FINAL_RATE) * 0.5 * (1 + math.cos(math.pi * done))

    def _stumble(self) -> None:
        self.skipped += 1
        self._stumbles += 1
        if self._stumbles < PATIENCE:
            return
        state = read_checkpoint(self.folder)
        if state is None or self._returns == RETURNS:
            what = f"is not finite {PATIENCE * (RETURNS + 1)} steps in a row, at step {self.step}"
            raise RunError(self.folder, what, "look at its loss.csv; the capture holds moments that cannot be drawn")
        self._load(state)
        self._stumbles = 0
        self._returns += 1
        self.restored += 1

    def _load(self, state: dict[str, Any]) -> None:
        load(self.avatar, state["avatar"], self.folder)
        try:
            groups = self._optimizer.state_dict()["param_groups"]
            self._optimizer.load_state_dict({"state": state["optimizer"]["state"], "param_groups": groups})
            for parameter, kept in self._optimizer.state.items():
                for moment in (kept["exp_avg"], kept["exp_avg_sq"]):
                    if moment.shape != parameter.shape or moment.dtype != parameter.dtype:
                        raise ValueError("a moment is of another tensor")
                if kept["step"].shape or not float(kept["step"]) >= 1:
                    raise ValueError("a moment is of no step")
        except (KeyError, TypeError, AttributeError, ValueError, RuntimeError) as error:
            raise broken(self.folder, error) from error

    def _keep_to_what_is_good(self) -> None:
        """Writes the checkpoint; where training has gone astray, the weights of the last one are gone on with."""
        if astray([row[-1] for row in self._rows], self.plan.checkpoint_every):
            state = read_checkpoint(self.folder)
            assert state is not None  # resume() wrote the first
            self._load(state)
            self._pace *= SLOWER
            self.restored += 1
        self._keep()

    def _keep(self) -> None:
        """Writes the checkpoint, unless the weights are what it shall save from."""
        if not all(bool(torch.isfinite(parameter).all()) for parameter in self.avatar.parameters()):
            return
        state = {
            "step": self.step,
            "avatar": self.avatar.state_dict(),
            "optimizer": self._optimizer.state_dict(),
            "rows": torch.tensor(self._rows, dtype=torch.float64),
            "pace": self._pace,
            "faults": [self.skipped, self.restored, self._stumbles, self._returns],
        }
        write_checkpoint(self.folder, state)
        self._tick()

    def _tick(self) -> None:
        """Adds the time since the last checkpoint to what the run has cost."""
        now = time.monotonic()
        if self.config.seconds is not None:
            self.config = replace(self.config, seconds=self.config.seconds + now - self._ticked)
            write_config(self.folder, self.config)
        self._ticked = now

    def _show(self) -> None:
        """Previews, the curve, and the numbers behind it."""
        capture = self.scene.capture
        shots = [*spaced(capture.val, 2), *spaced(frontal(capture.test), 2)] or spaced(capture.train, 2)
        picture = comparison([self.scene.seen(shot, self._bare) for shot in shots])
        write_png(self.folder / PREVIEWS / f"{self.step:06d}.png", picture)
        rows = np.array(self._rows)
        write_png(self.folder / "loss.png", loss_curve(rows[:, 0], rows[:, -1]))
        write_whole(self.folder / "loss.csv", [loss_table(self._rows, TERMS).encode()])
