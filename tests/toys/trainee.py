"""A training of some seconds, also as a program that can be killed: ``python trainee.py CAPTURE RUN``."""

import sys
from pathlib import Path

from gemheads.models.captures.reader import open_capture
from gemheads.models.train.avatars.plan import Plan
from gemheads.models.train.avatars.train_avatar import train_avatar
from gemheads.models.train.perceptual import TINY, Perceptual

BRIEF = Plan(
    32, 4, 2, steps=30, colors_first=8, checkpoint_every=5, preview_every=15, perceptual_every=2, perceptual_side=24
)

if __name__ == "__main__":
    train_avatar(open_capture(Path(sys.argv[1])), Path(sys.argv[2]), BRIEF, Perceptual(TINY))
