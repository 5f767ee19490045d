import threading
import time

import numpy as np
import pytest
from gemheads.app.errors import OutputError
from gemheads.app.senders.fan import Fan
from gemheads.app.senders.outlet import Shown
from gemheads.render.arrays import Image
from keepers import Keeper
from waiting import SOON, eventually


def picture(value: int = 0) -> Image:
    return np.full((4, 6, 3), value, np.uint8)


def values(keeper: Keeper) -> list[int]:
    return [int(shown.picture[0, 0, 0]) for shown in keeper.kept]


def test_every_output_gets_a_picture_of_its_own_that_nobody_may_change() -> None:
    one, other, fan = Keeper(), Keeper(), Fan()
    fan.start("one", lambda: one)
    fan.start("other", lambda: other)
    window = picture(7)
    fan.offer(window, 1.5)
    window[:] = 9  # the window draws its next picture into the same memory
    assert fan.close(SOON)
    assert values(one) == values(other) == [7]
    assert one.kept[0].shown_at == 1.5
    assert one.closed
    with pytest.raises(ValueError, match="read-only"):
        one.kept[0].picture[:] = 1


def test_a_slow_output_never_holds_up_the_window_and_gets_the_newest() -> None:
    gate = threading.Event()
    slow, quick, fan = Keeper(gate), Keeper(), Fan()
    fan.start("slow", lambda: slow)
    fan.start("quick", lambda: quick)
    for value in range(20):
        fan.offer(picture(value), float(value))
        eventually(lambda value=value: values(quick)[-1:] == [value])
    (report, _) = fan.reports()
    assert report.drops >= 18
    gate.set()
    assert fan.close(SOON)
    assert values(slow)[-1] == 19
    assert len(slow.kept) == 20 - report.drops <= 2
    assert values(quick) == list(range(20))


def test_a_deeper_queue_keeps_what_one_slot_would_drop() -> None:
    gate = threading.Event()
    keeper, fan = Keeper(gate), Fan()
    fan.start("recording", lambda: keeper, depth=8)
    for value in range(8):
        fan.offer(picture(value), float(value))
    gate.set()
    assert fan.close(SOON)
    assert values(keeper) == list(range(8))


def test_one_that_fails_is_closed_and_named_and_the_others_go_on() -> None:
    bad, good, fan = Keeper(failing=True), Keeper(), Fan()
    fan.start("recording", lambda: bad)
    fan.start("camera", lambda: good)
    fan.offer(picture(1), 0.0)
    eventually(lambda: not fan.running("recording"))
    eventually(lambda: fan.reports()[0].phase == "failed")
    fan.offer(picture(2), 1.0)
    eventually(lambda: values(good)[-1:] == [2])
    failed, running = fan.reports()
    assert (failed.name, failed.text) == ("recording", "out.mp4: no space left; free some space")
    assert bad.closed
    assert running.phase == "running"
    fan.start("recording", lambda: good)  # it can be turned on again
    assert fan.running("recording")
    assert fan.close(SOON)


def test_one_that_cannot_be_opened_says_why() -> None:
    def refuse() -> Keeper:
        raise OutputError("no virtual camera: make one")

    fan = Fan()
    fan.start("virtual camera", refuse)
    eventually(lambda: fan.reports()[0].phase == "failed")
    assert fan.reports()[0].text == "no virtual camera: make one"
    assert not fan.listening


def test_opening_takes_its_time_without_anybody_waiting() -> None:
    gate, keeper, fan = threading.Event(), Keeper(), Fan()

    def open_late() -> Keeper:
        assert gate.wait(SOON)
        return keeper

    fan.start("camera", open_late)
    fan.start("camera", open_late)  # pressed twice: there is one
    fan.offer(picture(3), 0.0)
    assert fan.reports()[0].phase == "opening"
    assert not fan.close(0.05)
    gate.set()
    assert fan.close(SOON)
    assert values(keeper) == [3]
    assert len(fan.reports()) == 1


def test_a_picture_is_the_one_of_its_moment_and_ends_the_output() -> None:
    gate, keeper, fan = threading.Event(), Keeper(), Fan()

    def open_late() -> Keeper:
        assert gate.wait(SOON)
        return keeper

    fan.start("picture", open_late, once=True)
    fan.offer(picture(1), 0.0)
    fan.offer(picture(2), 0.1)
    gate.set()
    eventually(lambda: fan.reports()[0].phase == "done")
    assert values(keeper) == [1]
    assert fan.reports()[0].text == "kept 1"


def test_only_one_picture_is_saved_however_long_that_takes() -> None:
    gate, fan = threading.Event(), Fan()
    keeper = Keeper(gate)
    fan.start("picture", lambda: keeper, once=True)
    for value in range(5):
        fan.offer(picture(value), 0.0)
        time.sleep(0.02)
    assert not fan.running("picture")
    gate.set()
    assert fan.close(SOON)
    assert values(keeper) == [0]


def test_stopping_finishes_in_the_background() -> None:
    gate = threading.Event()
    keeper, fan = Keeper(gate), Fan()
    fan.start("recording", lambda: keeper, depth=8)
    fan.offer(picture(1), 0.0)
    fan.offer(picture(2), 0.1)
    fan.stop("recording")
    assert not fan.running("recording")
    fan.offer(picture(3), 0.2)
    gate.set()
    eventually(lambda: fan.reports()[0].phase == "done")
    assert values(keeper) == [1, 2]
    fan.stop("recording")
    fan.stop("never started")


def test_a_file_gets_the_last_picture_once_more_at_the_end_for_it_was_shown_until_then() -> None:
    file, stream, fan = Keeper(), Keeper(), Fan()
    fan.start("recording", lambda: file, depth=8, filing=True)
    fan.start("camera", lambda: stream)
    for value in (1, 2):
        fan.offer(picture(value), 0.0)
    before = time.perf_counter()
    fan.stop("recording")
    after = time.perf_counter()
    fan.stop("recording")
    assert fan.close(SOON)
    assert values(file) == [1, 2, 2]
    assert before <= file.kept[-1].shown_at <= after
    assert values(stream)[-1] == 2
    assert stream.kept[-1].shown_at == 0.0


def test_a_file_that_takes_its_time_to_be_finished_is_known_of_after_closing() -> None:
    class Signing(Keeper):
        def close(self) -> None:
            assert go_on.wait(SOON)

    class Hanging(Keeper):
        def close(self) -> None:
            assert never.wait(SOON)

    go_on, never, fan = threading.Event(), threading.Event(), Fan()
    fan.start("recording", Signing, filing=True)
    fan.start("camera", Hanging)
    assert not fan.close(0.05)
    assert not fan.filed()
    go_on.set()
    assert fan.filed(SOON), "a camera that hangs is nothing to wait for"
    never.set()


def test_a_fault_in_an_output_is_told_with_its_kind() -> None:
    class Broken(Keeper):
        def send(self, shown: Shown) -> None:
            raise ZeroDivisionError("by zero")

    fan = Fan()
    fan.start("recording", Broken)
    fan.offer(picture(), 0.0)
    eventually(lambda: fan.reports()[0].phase == "failed")
    assert fan.reports()[0].text == "the recording stopped: ZeroDivisionError: by zero; start it again"
