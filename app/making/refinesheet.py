"""What refinement did, to look at: pictures that judged it, the avatar before and after, and where it still differs."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...models.captures.layout import Shot
from ...models.captures.reader import Capture
from ...models.gem import Gem
from ...models.posing import pose_head
from ...render.compositing import over
from ...render.software import SoftwareEngine

if TYPE_CHECKING:
    from ...models.train.synthesis.fit import Start

ROWS = 4
Side = tuple[Gem, "Mapping[int, Start]"]


def refine_sheet(capture: Capture, judges: Sequence[Shot], before: Side, after: Side) -> NDArray[np.uint8]:
    """[H, W, 3] a row for each of ROWS of the pictures that judge: truth, before, after, and where after differs (white
    from 0.1 on)."""
    from ...models.train.deck import spaced
    from ...models.train.synthesis.fit import error_map

    rows = []
    for shot in spaced(judges, ROWS):
        truth = capture.over_background(shot)
        first, second = (_drawn(capture, side, shot) for side in (before, after))
        rows.append(np.concatenate([truth, first, second, error_map((second / 255).astype(np.float32), truth)], 1))
    width = max(row.shape[1] for row in rows)
    return np.concatenate([np.pad(row, ((0, 0), (0, width - row.shape[1]), (0, 0))) for row in rows])


def _drawn(capture: Capture, side: Side, shot: Shot) -> NDArray[np.uint8]:
    gem, moments = side
    moment = moments[shot.timestep]
    raw = gem.compose(moment.coefficients)
    raw = pose_head(raw, gem.neck_weights, gem.neck_pivot, moment.pose.turn, moment.pose.move)
    return over(SoftwareEngine().draw(raw, shot.camera), capture.ground(shot)).copy()
