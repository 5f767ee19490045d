"""What a process that judges is given in tests: it finds them here by name, wherever the tests are run from."""

import os
from dataclasses import dataclass
from pathlib import Path

from gemheads.models.captures.layout import CaptureError, Shot
from gemheads.models.captures.reader import Capture
from gemheads.models.captures.standin import StandIn
from gemheads.models.gemfile import load_gem
from gemheads.models.train.judging.contestants import Act, GemContestant
from gemheads.models.train.judging.judge import Judge
from gemheads.render.arrays import Floats32


@dataclass(frozen=True)
class Opens:
    """An avatar's file, opened by whoever judges it."""

    path: Path

    def __call__(self, capture: Capture) -> GemContestant:
        return GemContestant(load_gem(self.path), capture)


@dataclass(frozen=True)
class Trouble:
    """Something that goes wrong as soon as it acts."""

    how: str
    driven_by: str = "nothing"

    def __call__(self, capture: Capture) -> "Trouble":
        return self

    def act(self, shot: Shot, split: str) -> Act:
        if self.how == "dies":
            os._exit(1)
        if self.how == "is changed":
            raise CaptureError(shot.picture, "is gone", "copy it there")
        raise ValueError(f"{split} is more than it can bear")

    def draw(self, standin: StandIn, shot: Shot, act: Act) -> Floats32:
        raise NotImplementedError


def without_lpips() -> Judge:
    return Judge(None)
