"""A short soak, and that a leak or a dead thread would be noticed."""

import subprocess
import sys
from pathlib import Path

import pytest

from .judging import complaints
from .loop import Soaked, soak, waited
from .weather import FAIR_SECS, FOUL_SECS

SECONDS = 16.0


def test_whatever_happens_the_live_loop_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gemheads.render.engines.FastestEngine._decided", None)  # soak sets it
    monkeypatch.setattr(f"{soak.__module__.rpartition('.')[0]}.weather.FAIR_SECS", (FAIR_SECS[0] / 4, 0.6))
    monkeypatch.setattr(f"{soak.__module__.rpartition('.')[0]}.weather.FOUL_SECS", (FOUL_SECS[0], 0.6))
    soaked = soak(SECONDS, tmp_path, seed=3, warm_up=2.0)
    print(soaked.weather, soaked.pictures, soaked.engines_lost, soaked.recordings)
    # so short a run says nothing of pace: what else the machine does weighs more
    assert [told for told in complaints(soaked) if "at the end every" not in told] == []
    assert sum(count > 0 for count in soaked.weather.values()) >= 8
    assert soaked.engines_lost
    assert soaked.recordings


def test_waiting_for_a_core_is_seen() -> None:
    """Two threads that both want the one core there is for them."""
    if not waited():
        pytest.skip("this system does not say how long a thread waits for a core")
    program = (
        "import os, sys, threading, time, zlib\n"
        "sys.path.insert(0, sys.argv[1])\n"
        "from soak.loop import waited\n"
        "os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
        "end = time.perf_counter() + 1\n"
        "def work():\n"
        "    while time.perf_counter() < end: zlib.crc32(bytes(10**6))\n"
        "threads = [threading.Thread(target=work) for _ in range(2)]\n"
        "[thread.start() for thread in threads]\n"
        "time.sleep(0.9)\n"
        "print(sum(waited().values()))\n"
    )
    command = [sys.executable, "-c", program, str(Path(__file__).parents[1])]
    told = subprocess.run(command, capture_output=True, text=True, check=True, timeout=100).stdout
    assert float(told.splitlines()[-1]) > 0.3


def flat() -> Soaked:
    return Soaked(60, 600, [0.033] * 600, [0.03] * 600, [500.0] * 120, [20] * 120, [8] * 120, alive=True)


def test_a_flat_run_is_no_reason_to_complain() -> None:
    assert complaints(flat()) == []


@pytest.mark.parametrize(
    ("field", "values", "said"),
    [
        ("rss", [500 + i for i in range(120)], "memory grew"),
        ("handles", [20 + i // 10 for i in range(120)], "open handles grew"),
        ("threads", [8 + i // 10 for i in range(120)], "open threads grew"),
        ("gaps", [0.03 + i / 10_000 for i in range(600)], "at the end every"),
        ("stalls", [0.03] * 599 + [1.6], "nothing moved for 1.6 s"),
        ("failures", ["ValueError()"], "ValueError"),
        ("alive", False, "is dead"),
    ],
)
def test_what_is_not_flat_is_noticed(field: str, values: object, said: str) -> None:
    soaked = flat()
    setattr(soaked, field, values)
    (told,) = complaints(soaked)
    assert said in told
