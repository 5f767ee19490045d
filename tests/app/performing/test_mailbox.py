import threading

from gemheads.app.performing.mailbox import Mailbox


def test_the_newest_wins_and_the_others_are_counted() -> None:
    box: Mailbox[int] = Mailbox()
    for number in range(5):
        box.put(number)
    assert box.take() == 4
    assert box.take() is None
    assert box.dropped == 4


def test_waiting_ends_when_something_comes() -> None:
    box: Mailbox[str] = Mailbox()
    threading.Timer(0.02, box.put, ["there"]).start()
    assert box.take(timeout=10) == "there"


def test_nobody_waits_longer_than_asked() -> None:
    box: Mailbox[str] = Mailbox()
    assert box.take(timeout=0.01) is None


def test_whoever_does_something_else_meanwhile_is_woken_by_every_item() -> None:
    box: Mailbox[int] = Mailbox()
    found: list[int | None] = []
    box.rouse = lambda: found.append(box.take())
    box.put(1)
    box.put(2)
    assert found == [1, 2]
