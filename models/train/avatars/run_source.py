"""A trained run as a source that can be distilled."""

from collections.abc import Iterator

import numpy as np

from ....render.gaussians import RawGaussians
from ...arkit import NAMES
from ...captures.layout import Tracked
from ...captures.weights import training_weights
from ...importers.source import Source
from .runs import Run


def run_source(run: Run) -> Source:
    """The avatar of a run over all moments it was trained on, the head held still (section 3.1: the frames of D)."""
    capture, template = run.capture, run.capture.template
    timesteps = capture.timesteps("train")

    def frames() -> Iterator[RawGaussians]:
        for timestep in timesteps:
            yield run.splats(capture.tracked(timestep))

    still = np.zeros(3, np.float32)
    performance, notes = training_weights(capture)
    if run.step != run.plan.steps:
        notes += (f"trained for {run.step} of {run.plan.steps} steps",)
    return Source(
        kind=f"{run.avatar.title} avatar",
        splats=len(run.texels),
        count=len(timesteps),
        frames=frames,
        rest=run.splats(Tracked(template.vertices, still, still, np.zeros(len(NAMES), np.float32))),
        neck_weights=np.clip(run.texels.spread(template.neck_weights), 0, 1).astype(np.float32),
        neck_pivot=np.array(template.neck_pivot, np.float32),
        viewing=capture.viewing(),
        performance=performance,
        uv_index=np.stack(np.divmod(run.texels.uv_index, run.plan.size)[::-1], 1).astype(np.uint16),
        uv_size=run.plan.size,
        moments=timesteps,
        notes=notes,
    )
