"""The bench measures what it says."""

import json
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.bench import drawing as bench
from gemheads.app.bench.synthetic import synthetic_gem
from gemheads.app.performing.portrait import portrait
from gemheads.render.software import SoftwareEngine


def test_quick_bench_prints_and_writes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "FRAMES", 3)
    monkeypatch.setattr(bench, "SPLATS", (2_000,))
    report = bench.run_bench(json=tmp_path / "bench.json", quick=True)

    assert report.cpu
    row = report.measurements[0]
    assert (row.splats, row.components, row.width, row.height, row.engine) == (2_000, 10, 512, 512, "software")
    assert set(row.stages) == {"compose", "sort", "project", "draw"}
    assert row.frame >= max(row.stages.values()) > 0
    assert row.memory_read > 0
    for other in report.measurements[1:]:
        assert other.engine == "quads"
        assert set(other.stages) == set(bench.STAGES)
    written = json.loads((tmp_path / "bench.json").read_text())
    assert written["measurements"][0]["frame"] == row.frame
    assert f"{row.stages['draw']:.2f}" in capsys.readouterr().out


def test_synthetic_head_has_no_holes() -> None:
    gem = synthetic_gem(15_000, 2, np.random.default_rng(0))
    image = SoftwareEngine().draw(gem.compose(gem.rest_coefficients), portrait(gem.viewing, 128, 128))
    alpha = image[..., 3]
    assert alpha[44:84, 50:78].min() > 0.9
    assert alpha[0].max() == 0


def test_memory_is_read_as_compose_reads_it_right_after_a_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else one of the two finds in the caches what the other has just read."""
    happened: list[str] = []

    class Engine:
        name = description = "noted"
        timings: dict[str, float] = {}  # noqa: RUF012

        def draw(self, *_: object) -> None:
            happened.append("draw")

    def read(*_: object) -> float:
        happened.append("read")
        return 0.5

    gem = synthetic_gem(500, 2, np.random.default_rng(0))
    compose = type(gem).compose

    def noted(*words: object, **more: object) -> object:
        happened.append("compose")
        return compose(*words, **more)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(bench, "_read", read)
    monkeypatch.setattr(type(gem), "compose", noted)
    camera = portrait(gem.viewing, 32, 32)
    (measured,) = bench._measure(gem, 2, camera, [Engine()])  # pyright: ignore[reportArgumentType]
    assert measured.memory_read == 500
    first = happened.index("draw") + 2  # behind the frame and the read that warm up
    turns = happened[first:]
    assert turns == ["compose", "draw", "read", "draw"] * bench.FRAMES
