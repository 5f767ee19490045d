"""What the host of a virtual machine takes is told, or that nobody knows."""

from types import SimpleNamespace

import pytest
from gemheads.app.bench import steal
from gemheads.app.bench.steal import Steal, told


def test_share_of_all_cores_since_it_was_made(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, stolen = [100.0], [7.0]
    monkeypatch.setattr(steal.time, "perf_counter", lambda: clock[0])
    monkeypatch.setattr(steal.psutil, "cpu_times", lambda: SimpleNamespace(steal=stolen[0]))
    monkeypatch.setattr(steal.os, "cpu_count", lambda: 4)
    counting = Steal()
    assert counting.percent() is None  # no time has passed
    clock[0], stolen[0] = 110.0, 9.0
    assert counting.percent() == pytest.approx(5.0)  # 2 of 4 times 10 seconds
    stolen[0] = 1e6
    assert counting.percent() == 100.0
    assert told(counting.percent()) == "the host gave 100.0 % of the cores' time to others"


def test_a_system_that_does_not_say(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steal.psutil, "cpu_times", lambda: SimpleNamespace(user=1.0))
    assert Steal().percent() is None
    assert "does not say" in told(None)
