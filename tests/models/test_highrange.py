"""Pictures of high dynamic range, at values that the standards give."""

import numpy as np
import pytest
from gemheads.models.highrange import BT2020, HLG, PQ, as_srgb, is_no_srgb

BT709 = 1


def shown(signal: tuple[float, float, float], transfer: int, primaries: int) -> list[int]:
    return as_srgb((np.array([[signal]]) * 65535).round().astype(np.uint16), transfer, primaries)[0, 0].tolist()


@pytest.mark.parametrize(
    ("transfer", "signal", "byte"),
    [
        (PQ, 0.0, 0),
        (PQ, 0.5081, 186),  # 100 of 203 nits
        (PQ, 0.5807, 255),
        (PQ, 1.0, 255),
        (HLG, 0.5, 137),  # a twelfth of the scene's light, to the power of 1.2: 50.7 nits
        (HLG, 0.75, 255),
        (BT709, 0.5, 128),
    ],
)
def test_grey_is_as_bright_as_it_is_meant(transfer: int, signal: float, byte: int) -> None:
    assert shown((signal,) * 3, transfer, BT2020) == pytest.approx([byte] * 3, abs=1)


def test_red_of_a_screen_comes_back_from_wider_colours() -> None:
    light = np.array([0.6274, 0.0691, 0.0164])  # of BT.709's red in BT.2020, ITU-R BT.2087
    red, green, blue = (1.055 * light ** (1 / 2.4) - 0.055).tolist()
    assert shown((red, green, blue), BT709, BT2020) == pytest.approx([255, 0, 0], abs=4)


def test_what_most_videos_are_is_no_such() -> None:
    assert not any(is_no_srgb(transfer, primaries) for transfer in (1, 2, 6, 13, 14) for primaries in (1, 2, 5, 6, 12))
