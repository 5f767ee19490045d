"""A capture's bare mesh as splats: what tracking alone gives, without anything learned."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from ...render.gaussians import RawGaussians
from ..captures.reader import Capture
from ..captures.texels import texels_of
from ..captures.texture import texel_colors
from ..captures.weights import training_weights
from ..gem import Gem
from .source import Source

KIND = "bare mesh of the capture"
"""What an avatar's source begins with that was distilled from one, until it is refined."""


def bare_moments(capture: Capture, gem: Gem) -> dict[int, NDArray[np.float32]] | None:
    """Timestep -> coefficients of the training moments, by projection; None for a GEM of anything but the bare mesh."""
    texels = texels_of(capture.template, gem.uv_size)
    places = np.stack([texels.uv_index % gem.uv_size, texels.uv_index // gem.uv_size], 1)
    theirs = gem.about.get("source", "").startswith(KIND)
    if not theirs or places.shape != gem.uv_index.shape or (places != gem.uv_index).any():
        return None
    rest, moments = texels.splats(gem.colors), {}
    for timestep in capture.timesteps("train"):
        frame = texels.carried(rest, capture.tracked(timestep).vertices)
        moments[timestep] = gem.project(frame)
    return moments


def capture_source(
    capture: Capture, size: int, progress: Callable[[str, int, int], None] = lambda stage, done, total: None
) -> Source:
    """One splat for each covered texel of a ``size`` x ``size`` map, carried by the tracked mesh of each training
    moment, its head pose taken out.

    Raises ValueError where the template covers no texel, CaptureError where a file changed since it was opened.
    """
    texels = texels_of(capture.template, size)
    colors, seen = texel_colors(capture, texels, progress)
    rest = texels.splats(colors)
    moments = capture.timesteps("train")

    def frames() -> Iterator[RawGaussians]:
        return (texels.carried(rest, capture.tracked(moment).vertices) for moment in moments)

    performance, notes = training_weights(capture)
    if not seen.all():
        notes += (f"{(~seen).mean():.0%} of its texels are in no picture and have their neighbours' colours",)
    return Source(
        kind=KIND,
        splats=len(texels),
        count=len(moments),
        frames=frames,
        rest=rest,
        neck_weights=np.clip(texels.spread(capture.template.neck_weights), 0, 1).astype(np.float32),
        neck_pivot=np.asarray(capture.template.neck_pivot, np.float32),
        viewing=capture.viewing(),
        performance=performance,
        notes=notes,
        uv_index=np.stack([texels.uv_index % size, texels.uv_index // size], 1).astype(np.uint16),
        uv_size=size,
        moments=moments,
    )
