"""Avatars that are judged on a capture: what each does at a moment, and how that looks."""

import time
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ....render.arrays import Floats32
from ...captures.heldout import viewers
from ...captures.layout import Shot
from ...captures.reader import Capture
from ...captures.standin import StandIn
from ...gem import Gem
from ..avatars.runs import Run
from ..synthesis.fitcapture import fit_moments


@dataclass(frozen=True)
class Act:
    """What an avatar does at one moment."""

    coefficients: Floats32 | None
    """[coefficients]; None for a run."""
    turn: Floats32 | None
    """[3] axis times angle of the head, radians; None: as it was tracked."""
    move: Floats32 | None
    """[3] metres."""
    cameras: tuple[int, ...]
    """In whose pictures it was found; empty for a run, which what was tracked drives."""
    seconds: float
    """That it took to find."""


class Contestant(Protocol):
    """One avatar."""

    driven_by: str
    """In words: where its expressions come from."""

    def act(self, shot: Shot, split: str) -> Act:
        """What it does in a picture, never knowing the picture itself unless no other camera was there."""
        ...

    def draw(self, standin: StandIn, shot: Shot, act: Act) -> Floats32:
        """[H, W, 3] sRGB in [0, 1]: the picture of that."""
        ...


class GemContestant:
    """A GEM by analysis by synthesis (section 4): fitted to pictures of the same moment from other cameras.

    Every moment is begun anew from rest, so that a figure does not depend on which were judged before it.
    """

    driven_by = "fitted in other cameras' pictures"

    def __init__(self, gem: Gem, capture: Capture) -> None:
        """``gem`` has its canonical space where the capture's template has its own; the person may be another."""
        self._gem, self._capture = gem, capture
        self._timestep, self._found = -1, dict[tuple[int, ...], Act]()

    def act(self, shot: Shot, split: str) -> Act:
        """Fits; cameras of one moment that look through the same others share it. Raises CaptureError."""
        views = viewers(self._capture, split, shot)
        cameras = tuple(view.camera_index for view in views)
        if shot.timestep != self._timestep:
            self._timestep, self._found = shot.timestep, {}
        if cameras not in self._found:
            started = time.perf_counter()
            (moment,) = fit_moments(self._gem, self._capture, views)
            pose = moment.fit.pose
            seconds = time.perf_counter() - started
            self._found[cameras] = Act(moment.fit.coefficients, pose.turn, pose.move, cameras, seconds)
        return self._found[cameras]

    def draw(self, standin: StandIn, shot: Shot, act: Act) -> Floats32:
        """The fitted expression. Raises ValueError for an act of something else."""
        if act.coefficients is None or act.turn is None or act.move is None:
            raise ValueError("a GEM acts by coefficients and a pose; this act has none")
        gem = self._gem
        pose = act.turn, act.move
        return standin.draw(gem.compose(act.coefficients), gem.neck_weights, gem.neck_pivot, shot, pose)


class RunContestant:
    """A run of ``train_avatar``, driven by what the capture tracked: the mesh, as in the paper, or ARKit weights."""

    def __init__(self, run: Run) -> None:
        self._run = run
        self.driven_by = run.avatar.driven_by
        self._neck = neck_of(run)

    def act(self, shot: Shot, split: str) -> Act:
        """Nothing has to be found."""
        del shot, split
        return Act(None, None, None, (), 0.0)

    def draw(self, standin: StandIn, shot: Shot, act: Act) -> Floats32:
        """The model's splats for what was tracked at the moment. Raises CaptureError."""
        del act
        tracked = self._run.capture.tracked(shot.timestep)
        return standin.draw(self._run.splats(tracked), *self._neck, shot)


def neck_of(run: Run) -> tuple[Floats32, Floats32]:
    """Neck weights [N] and pivot [3] of a run's splats."""
    template = run.capture.template
    weights = np.clip(run.texels.spread(template.neck_weights), 0, 1)
    return weights.astype(np.float32), np.asarray(template.neck_pivot, np.float32)
