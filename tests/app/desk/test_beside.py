"""Work beside the window's thread."""

import threading
from collections.abc import Callable

import pytest
from gemheads.app.desk.beside import Beside
from waiting import SOON, eventually


def test_a_piece_of_work_does_not_hold_up_who_asked_for_it_and_its_result_is_given_once() -> None:
    beside: Beside[int] = Beside("test")
    gate, threads = threading.Event(), []

    def work() -> int:
        threads.append(threading.get_ident())
        gate.wait(SOON)
        return 7

    beside.begin(work, here=False)
    assert not beside.free
    assert beside.result() is None
    gate.set()
    assert eventually(beside.result) == 7
    assert beside.free
    assert beside.result() is None
    assert threads[0] != threading.get_ident()
    beside.close()


def test_what_must_be_done_here_is_done_before_begin_returns() -> None:
    beside: Beside[int] = Beside("test")
    beside.begin(threading.get_ident, here=True)
    assert not beside.free
    assert beside.result() == threading.get_ident()
    beside.close()


def test_whoever_waits_is_woken_when_it_is_done() -> None:
    beside: Beside[int] = Beside("test")
    gate, woken = threading.Event(), threading.Event()
    beside.rouse = woken.set

    def work() -> int:
        gate.wait(SOON)
        return 7

    beside.begin(work, here=False)
    assert not woken.is_set()
    gate.set()
    assert woken.wait(SOON)
    assert beside.result() == 7
    beside.close()


def test_what_fails_in_the_other_thread_is_done_again_in_this_one() -> None:
    beside: Beside[int] = Beside("test")

    def at_home(home: int) -> Callable[[], int]:
        def work() -> int:
            if threading.get_ident() != home:
                raise RuntimeError("no context in this thread")
            return 1

        return work

    beside.begin(at_home(threading.get_ident()), here=False)
    assert eventually(beside.result) == 1
    beside.begin(at_home(0), here=False)
    with pytest.raises(RuntimeError, match="no context"):
        eventually(beside.result)
    assert beside.free, "the next piece can begin all the same"
    beside.close()
