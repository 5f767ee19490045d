"""The mark on exported pictures: there, in its corner, readable, and the rest of the picture as it was."""

import time

import numpy as np
import pytest
from gemheads.app.credentials.badge import SMALLEST_LETTER, badged, letter_height


def plain(height: int, width: int, *colour: int) -> np.ndarray:
    return np.full((height, width, len(colour)), colour, np.uint8)


def changed(before: np.ndarray, after: np.ndarray) -> tuple[int, int, int, int]:
    """Top, bottom, left, right of what differs."""
    rows, columns = np.nonzero((before != after).any(-1))
    return rows.min(), rows.max(), columns.min(), columns.max()


@pytest.mark.parametrize("side", [256, 512, 1024])
@pytest.mark.parametrize("ground", [(0, 0, 0), (255, 255, 255), (190, 190, 190)])
def test_it_lies_in_the_lower_right_corner_and_leaves_the_rest_alone(side: int, ground: tuple[int, int, int]) -> None:
    before = plain(side, side, *ground)
    after = badged(before)
    top, bottom, left, right = changed(before, after)
    assert side * 0.9 < top < bottom < side
    assert side * 0.6 < left < right < side
    assert (before == ground).all()  # the picture that was given is still what it was


@pytest.mark.parametrize("side", [256, 512, 1024, 2160])
def test_its_letters_can_be_read_on_any_ground(side: int) -> None:
    assert letter_height(side, side) >= max(SMALLEST_LETTER, 0.02 * side)
    for ground in (0, 255):
        before = plain(side, side, ground, ground, ground)
        top, bottom, left, right = changed(before, badged(before))
        edge = (bottom - top) // 3  # its corners are round
        inside = badged(before)[top + 2 : bottom - 1, left + edge : right - edge, 0].astype(int)
        assert inside.max() > 230
        assert inside.min() < 120
        letters = (inside.max(0) > 150).astype(int)
        assert (np.diff(letters, prepend=0) == 1).sum() == 9  # each of nine letters, apart from its neighbours


def test_a_transparent_picture_keeps_its_alpha_but_for_the_badge() -> None:
    before = plain(256, 256, 10, 200, 30, 0)
    after = badged(before)
    top, bottom, left, right = changed(before, after)
    badge = after[top : bottom + 1, left : right + 1]
    assert badge[..., 3].max() == 255
    assert 0.5 < np.median(badge[..., 3]) / 255 < 0.7
    assert badge[badge[..., 3] > 0][:, 1].min() < 30  # none of the green that nobody saw comes back
    assert (after[:top] == before[:top]).all()


def test_alpha_and_ground_agree() -> None:
    rgb = plain(256, 256, 120, 60, 200)
    assert np.abs(badged(np.dstack([rgb, plain(256, 256, 255)]))[..., :3].astype(int) - badged(rgb)).max() <= 1


@pytest.mark.parametrize(("height", "width"), [(16, 16), (2, 2), (64, 64), (48, 400), (400, 48), (1, 1)])
def test_any_picture_is_large_enough(height: int, width: int) -> None:
    before = plain(height, width, 128, 128, 128)
    after = badged(before)
    assert after.shape == before.shape
    assert (after != before).any()


def test_it_costs_next_to_nothing() -> None:
    picture = plain(512, 512, 99, 99, 99)
    badged(picture)
    spent = []
    for _ in range(40):
        started = time.perf_counter()
        badged(picture)
        spent.append(time.perf_counter() - started)
    assert min(spent) < 0.5e-3
