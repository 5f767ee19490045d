"""What is kept of a face, in case it goes."""

import numpy as np
import pytest
from gemheads.app.person.holding import AT_ONCE_SECS, BEFORE_SECS, EASE_SECS, Moment, held, kept


def moment(seconds: float, sigma: float = 0.0) -> Moment:
    return Moment(seconds, np.array([sigma]), np.array([sigma, 0, 0]), np.array([2 * sigma, 0, 0]))


@pytest.mark.parametrize("rate", [5, 15, 30, 60])
def test_no_more_is_kept_than_may_be_held(rate: int) -> None:
    past: tuple[Moment, ...] = ()
    for frame in range(3 * rate):
        past = kept(past, moment(frame / rate))
    assert past[-1].seconds - past[0].seconds >= BEFORE_SECS - 1e-9
    assert past[-1].seconds - past[1].seconds < BEFORE_SECS + 1e-9


def test_after_a_seek_backwards_nothing_of_later_is_held() -> None:
    past = kept(kept((), moment(8.0, 1.0)), moment(3.0, 2.0))
    assert [one.seconds for one in past] == [3.0]


def test_what_was_last_goes_over_into_what_was_before() -> None:
    past = tuple(moment(frame / 25, frame) for frame in range(6))
    times = np.linspace(0, 0.3, 31)
    sigmas = np.array([held(past, secs).expression[0] for secs in times])
    assert (sigmas[times <= AT_ONCE_SECS] == 5).all()
    assert (sigmas[times >= AT_ONCE_SECS + EASE_SECS] == 0).all()
    assert (np.diff(sigmas) <= 0).all()
    assert held(past, 0.3).shown_turn.tolist() == [0, 0, 0]
    assert held(past, 0.0).turn.tolist() == [5, 0, 0]
