import pytest
from gemheads.app.performing.presence import HOLD_SECS, TO_FACE_SECS, TO_REST_SECS, Attention, Phase, update

FRAME = 1 / 50


def run(attention: Attention, face_seen: bool, seconds: float, dt: float = FRAME) -> Attention:
    for _ in range(round(seconds / dt)):
        attention = update(attention, face_seen, dt)
    return attention


FOLLOWING = update(Attention(), True, 0.0)


def test_a_face_in_the_first_frame_is_followed_at_once() -> None:
    assert FOLLOWING.phase is Phase.TRACKING
    assert FOLLOWING.gain == 1


def test_a_face_that_comes_later_is_eased_in() -> None:
    waiting = run(update(Attention(), False, 0.0), False, 1.0)
    assert waiting.phase is Phase.SEARCHING
    assert waiting.gain == 0
    halfway = run(waiting, True, TO_FACE_SECS / 2, TO_FACE_SECS / 10)
    assert halfway.gain == pytest.approx(0.5)
    assert run(waiting, True, TO_FACE_SECS + FRAME).gain == 1


def test_a_short_loss_holds_the_expression() -> None:
    held = run(FOLLOWING, False, HOLD_SECS - 2 * FRAME)
    assert held.phase is Phase.HOLD
    assert held.gain == 1
    assert update(held, True, FRAME).gain == 1


def test_a_long_loss_eases_to_rest_and_back() -> None:
    resting = run(FOLLOWING, False, HOLD_SECS + TO_REST_SECS / 2)
    assert resting.phase is Phase.IDLE
    assert resting.gain == pytest.approx(0.5, abs=0.06)
    assert run(FOLLOWING, False, HOLD_SECS + TO_REST_SECS + FRAME).gain == 0
    back = update(resting, True, FRAME)
    assert back.phase is Phase.TRACKING
    assert resting.follow < back.follow < 1


@pytest.mark.parametrize("dt", [1 / 120, 1 / 50, 1 / 10, 0.7])
def test_easing_does_not_depend_on_the_frame_rate(dt: float) -> None:
    state, elapsed = FOLLOWING, 0.0
    while elapsed < HOLD_SECS + TO_REST_SECS / 2:
        state, elapsed = update(state, False, dt), elapsed + dt
    assert state.follow == pytest.approx(max(0.0, 1 - (elapsed - HOLD_SECS) / TO_REST_SECS), abs=1e-9)


@pytest.mark.parametrize("dt", [-0.01, float("inf"), float("nan")])
def test_time_must_run_forward(dt: float) -> None:
    with pytest.raises(ValueError, match="must not run backwards"):
        update(FOLLOWING, True, dt)
