from gemheads.app.person.hints import Hints, update_hints


def test_a_sign_has_to_last_and_its_sentence_stays_long_enough_to_be_read() -> None:
    hints, times = Hints(), []
    for step in range(60):
        hints = update_hints(hints, {"dark"} if 10 <= step < 25 else set(), 0.1)
        times += [step] if hints.shown else []
    assert times[0] == 16
    assert times[-1] == 35


def test_what_flickers_is_not_shown() -> None:
    hints = Hints()
    for step in range(100):
        hints = update_hints(hints, {"far"} if step % 2 else set(), 0.1)
        assert hints.shown == ()


def test_nothing_is_remembered_of_what_is_long_gone() -> None:
    hints = update_hints(Hints(), {"far", "dark"}, 1.0)
    for _ in range(30):
        hints = update_hints(hints, set(), 0.1)
    assert hints == Hints()
