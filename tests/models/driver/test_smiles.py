"""A stranger's grin on the avatars that ship: wide, and without a frown for what the stranger's rest reads as."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.arkit import NAMES as SHAPES
from gemheads.models.crossing.mirror import LOOKS, Mirror
from gemheads.models.crossing.reading import Reading
from gemheads.models.driver.features import BLOCKS, score
from gemheads.models.driver.measures import MEASURES
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gemfile import load_gem
from gemheads.models.heads.expressions import weights_of

AVATARS = Path(__file__).parents[3] / "assets" / "avatars"
NAMES = ("jonah", "mara", "theo")
GRIN = {"mouthSmile": 1.0, "mouthUpperUp": 0.5, "cheekSquint": 0.5, "eyeSquint": 0.2}
FULL_LIPS, HIGH_BROWS = 0.35, 0.3
"""What rests may read as: pursed, and raised."""
WIDE = BLOCKS["measures"].start + MEASURES.index("mouth_width")


@cache
def mirror(name: str) -> Mirror:
    return Mirror(load_gem(AVATARS / f"{name}.gem"), 384)


def shown(name: str, coefficients: np.ndarray) -> Reading:
    before = mirror(name)
    before.restart()
    reading = before.read(before.draw(coefficients, np.zeros(3)), LOOKS)
    assert reading is not None
    return reading


@cache
def grin_of(name: str) -> np.ndarray:
    """Its relative features [D]."""
    grin = shown(name, mirror(name).gem.arkit_coefficients(weights_of(**GRIN)))
    return grin.features - mirror(name).neutral().features


def answered(name: str, features: np.ndarray) -> np.ndarray:
    """The coefficients of an avatar that follows a stranger's relative features [D]."""
    return np.asarray(Regressor.of(mirror(name).gem)(features, np.zeros(3)).coefficients)


def frowned(name: str, coefficients: np.ndarray) -> float:
    """The weight of lowered brows in coefficients."""
    gem = mirror(name).gem
    assert gem.arkit_weights is not None
    moves = gem.arkit_weights / gem.sigma
    weights = (coefficients - gem.rest_coefficients) / gem.sigma @ np.linalg.pinv(moves, rcond=0.05)
    return float(np.mean([weights[SHAPES.index(f"browDown{side}")] for side in ("Left", "Right")]))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("driver", NAMES)
def test_a_grin_is_as_wide_as_the_drivers(name: str, driver: str) -> None:
    wide = shown(name, answered(name, grin_of(driver))).features[WIDE] - mirror(name).neutral().features[WIDE]
    assert wide > 0.75 * grin_of(driver)[WIDE]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("driver", NAMES)
def test_what_a_rest_reads_as_is_no_reason_to_frown(name: str, driver: str) -> None:
    plain = grin_of(driver)
    pursed = plain.copy()
    score(pursed, "mouthPucker")[...] -= FULL_LIPS
    score(pursed, "browInnerUp")[...] -= HIGH_BROWS
    assert frowned(name, answered(name, pursed)) - frowned(name, answered(name, plain)) < 0.1
