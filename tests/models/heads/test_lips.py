"""An open mouth is an arch, pursed lips are narrow and forward, bared teeth lie under a level lip and in a round one;
little light reaches teeth far behind the lips."""

import numpy as np
import pytest
from gemheads.models.heads.lips import (
    CORNER,
    LOWER,
    MIDDLE,
    PURSES,
    arching,
    bowl,
    level,
    lip_alone,
    mouth_light,
    pursed,
)

BODY = np.zeros((CORNER + 1, 3))
BODY[CORNER] = (0.25, -0.66, 0.19)
BODY[MIDDLE] = (0.0, -0.65, 0.31)
BODY[LOWER] = (0.0, -0.68, 0.30)
CHEEK = 0
BODY[CHEEK] = (0.7, -0.4, 0.1)
JAW_OPEN = np.zeros_like(BODY)
JAW_OPEN[LOWER, 1] = -0.34
STILL = np.zeros_like(BODY)


def test_an_open_mouth_is_no_triangle_on_its_point() -> None:
    """MakeHuman's lower lip runs almost straight from the corners to the middle."""
    out = np.linspace(0, 1, 9)
    half, corner_drop, middle_drop = BODY[CORNER, 0], 0.12, 0.34
    lower, upper = np.arange(10, 19), np.arange(30, 39)
    body, jaw_open = BODY.copy(), np.zeros_like(BODY)
    for places, height in ((lower, -0.68), (upper, -0.64)):
        body[places] = np.stack([half * out, np.full(9, height), np.full(9, 0.28)], 1)
    jaw_open[CORNER, 1], jaw_open[LOWER, 1] = -corner_drop, -middle_drop
    jaw_open[lower, 1] = -(middle_drop + (corner_drop - middle_drop) * out**1.4)
    jaw_open[upper, 1] = -0.03
    added = arching(body, jaw_open)
    sunk = (-(jaw_open + added)[lower, 1] - corner_drop) / (middle_drop - corner_drop)
    np.testing.assert_allclose(sunk, 1 - out**3.5, atol=0.1)
    np.testing.assert_allclose(added[[CORNER, MIDDLE, LOWER, CHEEK, *upper]], 0, atol=1e-9)
    assert (added[:, [0, 2]] == 0).all()


@pytest.mark.parametrize("name", sorted(PURSES))
def test_lips_get_narrower_and_come_forward(name: str) -> None:
    moved = pursed(PURSES[name], STILL, BODY, JAW_OPEN)
    assert moved[CORNER, 0] < -0.1 * BODY[CORNER, 0]
    assert moved[MIDDLE, 2] > 0.01
    np.testing.assert_allclose(moved[CHEEK], 0, atol=1e-3)


def test_a_funnel_opens_and_a_pucker_does_not() -> None:
    def gap(name: str) -> float:
        moved = pursed(PURSES[name], STILL, BODY, JAW_OPEN)
        return float(moved[MIDDLE, 1] - moved[LOWER, 1])

    assert gap("mouthFunnel") > 0.06
    assert abs(gap("mouthPucker")) < 0.02


def test_a_lip_goes_down_alone() -> None:
    """MakeHuman's takes the skin of the chin with it."""
    below = np.linspace(0, 3, 31)
    body = np.zeros((CORNER + 1, 3))
    body[CORNER] = BODY[CORNER]
    body[: len(below), 1] = BODY[CORNER, 1] - below * BODY[CORNER, 0]
    stays = lip_alone(body, 0.1)[: len(below)]
    assert (stays[below < 0.6] == 1).all()
    np.testing.assert_allclose(stays[below > 1.5], 0.1)
    assert (np.diff(stays) <= 0).all()
    assert -np.diff(stays).min() < 0.2, "no fold in between"
    assert (lip_alone(body, 1.0) == 1).all()


ACROSS = np.linspace(-1, 1, 21)
"""Along a lip, in half widths of the mouth."""


def lip() -> np.ndarray:
    """The body with a lip from corner to corner, its first points; its last is a cheek."""
    body = BODY.copy()
    body[: len(ACROSS)] = np.stack([BODY[CORNER, 0] * ACROSS, np.full(21, -0.66), np.full(21, 0.3)], 1)
    return np.concatenate([body, BODY[CHEEK][None]])


def test_an_upper_lip_rises_level() -> None:
    """MakeHuman's rises most between middle and corner, as the lip of one who snarls; smiles lift the corners."""
    rises = np.interp(np.abs(ACROSS), [0, 0.5, 1.0], [11.0, 13.4, 7.0])
    smiles = np.interp(np.abs(ACROSS), [0, 1], [1.7, 8.3])
    inside = np.abs(ACROSS) < 0.75

    def uneven(share: float) -> float:
        return float(np.ptp((level(lip(), share)[:21] * rises + smiles)[inside]))

    assert uneven(1.0) < 0.4 * uneven(0.0)
    assert level(lip(), 1.0)[-1] == pytest.approx(1, abs=0.02), "the cheek does as before"


def test_a_lower_lip_is_a_bowl() -> None:
    shares = bowl(lip(), 1.0)[:21]
    assert shares[10] < 0.9
    assert shares[[3, 17]].min() > 1.4 * shares[10], "beside the middle it goes further down"
    assert shares[[0, 20]].max() < shares[3], "and less so at the corners"
    np.testing.assert_allclose(shares, shares[::-1])
    assert bowl(lip(), 1.0)[-1] == pytest.approx(1, abs=0.02)


def test_without_round_grins_shapes_are_makehumans() -> None:
    assert (level(lip(), 0.0) == 1).all()
    assert (bowl(lip(), 0.0) == 1).all()


def test_light_grows_with_the_opening_and_fades_with_depth() -> None:
    def light(gap: float, depth: float) -> float:
        rim = np.array([[0.025, -0.066, 0.08], [0, -0.066 + gap / 2, 0.09], [0, -0.066 - gap / 2, 0.09]])
        return mouth_light(rim, 0.09 - depth)

    assert light(0, 0.006) == 0
    assert light(0.002, 0.006) < light(0.010, 0.006) < light(0.030, 0.006) < 1
    assert light(0.010, 0.020) < light(0.010, 0.006)
    assert light(-0.004, 0.006) == 0
