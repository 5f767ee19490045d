"""Work shared out among the threads of a kernel."""

import numba
import numpy as np
from gemheads.render.sharing import fetch_add


@numba.njit(parallel=True)
def shared_out(counts, threads, step):  # type: ignore[no-untyped-def]
    counter, taken = np.zeros(1, np.int64), np.zeros(threads, np.int64)
    for thread in numba.prange(threads):
        first = fetch_add(counter, step)
        while first < len(counts):
            for i in range(first, min(first + step, len(counts))):
                counts[i] += 1
                taken[thread] += 1
            first = fetch_add(counter, step)
    return taken


def test_every_piece_is_done_once_by_whichever_thread_is_free() -> None:
    threads = numba.get_num_threads()
    for step in (1, 7, 100_000):
        counts = np.zeros(54_321, np.int64)
        taken = shared_out(counts, threads, step)
        assert (counts == 1).all()
        assert taken.sum() == len(counts)
