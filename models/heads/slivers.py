"""Splats on slivers of triangles, which expressions pull apart: what a GEM, which adds, may make of their sizes."""

from dataclasses import replace

import numpy as np

from ...render.arrays import Floats
from ..gem import Basis, Gem
from .expressions import weights_of

MOST = 4.0
"""Times its size at rest that a splat may grow. On the mesh it is 3 (``splats.posed``); but log-scales of a smile and
of two lips that part add up, and at the corners of mouths splats became needles."""
GRINS = (
    weights_of(mouthSmile=1, mouthUpperUp=1, mouthLowerDown=1),
    weights_of(mouthSmile=1, mouthUpperUp=1, mouthLowerDown=1, jawOpen=0.2),
)
"""Of the expressions that people make, those that pull most at corners of mouths."""


def restrained(gem: Gem, performance: Floats) -> Gem:
    """The GEM, of which no splat grows beyond MOST in a performance, ARKit weights [F, 52], or in GRINS.

    The components of splats that would are made smaller, so those of the scales are orthonormal but for these.
    """
    basis, part = gem.bases["scale"], gem.slices["scale"]
    at_rest = gem.rest_coefficients[part]
    shown = [gem.arkit_coefficients(weights)[part] for weights in (*performance, *GRINS)]
    grown = ((np.array(shown) - at_rest) @ basis.components).max(0).reshape(-1, 3).max(1)
    share = np.minimum(1, np.log(MOST) / np.maximum(grown, 1e-6)).astype(np.float32)
    rows = np.concatenate([basis.mean[None], basis.components * np.repeat(share, 3)])
    return replace(gem, bases={**gem.bases, "scale": Basis(rows, basis.sigma)})
