import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import numba
import pytest
from gemheads.app.performing.threads import Behind, ahead, at_most
from waiting import eventually


def test_ahead_keeps_items_and_order() -> None:
    assert list(ahead(range(50), depth=3)) == list(range(50))


def test_ahead_works_while_the_consumer_waits() -> None:
    made: list[int] = []

    def items() -> Iterator[int]:
        for i in range(10):
            made.append(i)
            yield i

    stream = ahead(items(), depth=4)
    next(stream)
    eventually(lambda: len(made) >= 5)
    assert 5 <= len(made) <= 6  # one taken, four in the box, one waiting
    stream.close()


def test_ahead_raises_where_the_producer_did() -> None:
    def items() -> Iterator[int]:
        yield 1
        raise OSError("torn")

    stream = ahead(items())
    assert next(stream) == 1
    with pytest.raises(OSError, match="torn"):
        next(stream)


def test_a_consumer_that_stops_stops_the_producer() -> None:
    before = threading.active_count()
    for item in ahead(iter(int, 1), depth=2):  # endless zeros
        assert item == 0
        break
    assert threading.active_count() == before


def test_behind_consumes_in_order_and_waits_at_the_end() -> None:
    seen: list[int] = []

    def consume(item: int) -> None:
        time.sleep(0.002)
        seen.append(item)

    writer = Behind(consume, depth=2)
    for i in range(10):
        writer.put(i)
    writer.finish()
    assert seen == list(range(10))


def put_many(writer: Behind[int], count: int) -> None:
    for i in range(count):
        writer.put(i)


def test_behind_raises_what_its_consumer_raised_and_never_blocks() -> None:
    def consume(item: int) -> None:
        raise OSError(f"full at {item}")

    writer = Behind(consume, depth=1)
    with pytest.raises(OSError, match="full at 0"):
        put_many(writer, 100)
    with pytest.raises(OSError, match="full at 0"):
        writer.finish()


def test_behind_abandoned_says_nothing() -> None:
    def consume(item: int) -> None:
        raise OSError

    writer = Behind(consume)
    writer.put(1)
    writer.abandon()


def test_kernels_get_so_many_threads_at_most_and_one_at_least() -> None:
    before = numba.get_num_threads()
    for wish in (-1, 0, 1, before, before + 7):
        with at_most(wish):
            assert numba.get_num_threads() == max(1, min(wish, before))
            with at_most(before):
                assert numba.get_num_threads() <= before
        assert numba.get_num_threads() == before
    with pytest.raises(KeyError), at_most(1):
        raise KeyError
    assert numba.get_num_threads() == before


STOPPED_ANYWHERE = """
import itertools, random, signal, sys
from contextlib import closing
from gemheads.app.performing.threads import Behind, ahead

def stop(*_):
    raise KeyboardInterrupt

random.seed(0)
signal.signal(signal.SIGALRM, stop)
for _ in range(150):
    writer = Behind(lambda item: None)
    try:
        signal.setitimer(signal.ITIMER_REAL, random.uniform(2e-4, 4e-3))
        with closing(ahead(itertools.count())) as numbers:
            for number in numbers:
                writer.put(number)
    except KeyboardInterrupt:
        pass
    writer.abandon()
"""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="Windows has no such timers")
def test_ctrl_c_at_any_moment_leaves_nobody_waiting() -> None:
    """Between a lock and what it was taken for, one in some dozens did."""
    subprocess.run([sys.executable, "-c", STOPPED_ANYWHERE], timeout=100, check=True)
