"""No splat of an avatar becomes a needle where shapes that each stretch it come together."""

from dataclasses import replace

import numpy as np
import pytest
from gemheads.models.arkit import NAMES
from gemheads.models.gem import Basis, Gem
from gemheads.models.heads.expressions import weights_of
from gemheads.models.heads.slivers import GRINS, MOST, restrained

GRIN = GRINS[0]
WINK = weights_of(eyeBlinkLeft=1.0)
NOTHING = np.zeros((1, len(NAMES)), np.float32)


@pytest.fixture
def stretching(tiny_gem: Gem) -> Gem:
    """Whose first splat grows twofold with either half of a smile and of a raised lip, whose second does so with a
    raised lip alone, and whose third becomes fifty times as long with a wink."""
    rows = np.zeros((4, tiny_gem.bases["scale"].rows.shape[1]), np.float32)
    rows[0] = tiny_gem.bases["scale"].mean
    rows[1, 1] = rows[2, 1] = rows[2, 3] = rows[3, 8] = 1
    bases = {**tiny_gem.bases, "scale": Basis(rows, np.full(3, 2, np.float32))}
    rest = np.zeros(sum(map(len, bases.values())), np.float32)
    gem = replace(tiny_gem, bases=bases, rest=rest, arkit_weights=None)
    shapes = np.zeros((len(NAMES), gem.coefficient_count), np.float32)
    first = gem.slices["scale"].start
    for place, (shape, factor) in enumerate((("mouthSmile", 2), ("mouthUpperUp", 2), ("eyeBlink", 50))):
        for side in ("Left", "Right"):
            shapes[NAMES.index(shape + side), first + place] = np.log(factor)
    return replace(gem, arkit_weights=shapes)


def grown(gem: Gem, weights: np.ndarray) -> np.ndarray:
    """[N] times its size at rest that each splat has along the axis that grows most."""
    change = gem.compose(gem.arkit_coefficients(weights)).log_scales - gem.compose(gem.rest_coefficients).log_scales
    return np.exp(change.max(1))


def test_what_shapes_add_up_to_is_held_and_the_rest_left(stretching: Gem) -> None:
    assert grown(stretching, GRIN)[:3] == pytest.approx([16, 4, 1], rel=1e-3)
    calm = restrained(stretching, NOTHING)
    assert grown(calm, GRIN)[:3] == pytest.approx([MOST, 4, 1], rel=1e-3)
    assert grown(calm, WINK)[2] == pytest.approx(50, rel=1e-3), "nobody winked"
    for modality in ("position", "rotation", "opacity"):
        np.testing.assert_array_equal(calm.bases[modality].rows, stretching.bases[modality].rows)


def test_a_performance_counts_as_well(stretching: Gem) -> None:
    calm = restrained(stretching, WINK[None])
    assert grown(calm, WINK)[2] == pytest.approx(MOST, rel=1e-3)
