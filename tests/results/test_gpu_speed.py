"""The table of docs/gpu.md: every engine that is here draws the same pictures, and its times are told."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("torch", reason="gsplat beside our engines needs torch")

from .pages import MARKS

BENCH = Path(__file__).resolve().parents[1] / "bench" / "gpu_speed.py"


def test_the_engines_draw_the_same_frames_in_turns(tmp_path: Path) -> None:
    page, figures = tmp_path / "gpu.md", tmp_path / "figures.json"
    page.write_text("\n".join(("# On a GPU", *MARKS)))
    wish = ["--maps", "32", "--components", "3", "--size", "64x96", "--frames", "3", "--docs", page, "--json", figures]
    subprocess.run([sys.executable, BENCH, *wish], check=True, capture_output=True, timeout=200)
    rows = {row["way"]: row for row in json.loads(figures.read_text())["rows"]}
    assert {"software", "quads"} <= rows.keys()
    assert all(row["splats"] == 1024 and row["frame"] >= row["ms"]["draw"] > 0 for row in rows.values())
    assert rows["quads"]["psnr"] > 50
    assert "| synthetic | 1024 | 3 | 64x96 | quads |" in page.read_text()
