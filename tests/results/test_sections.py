"""docs/results.md is printed of what evaluate really writes; drivers are in tests/app/evaluation/test_strangers.py."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("torch", reason="evaluating needs the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from refusals import refusal

from .sections import UnknownReport, section, table

BENCH = Path(__file__).resolve().parents[1] / "bench" / "results.py"


@pytest.fixture(scope="module")
def folder(toy_capture: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report with the tables of pictures and of components."""
    out = tmp_path_factory.mktemp("results")
    words = ("--maps", "16", "--components", "2")
    assert main(["distill", str(toy_capture), "-o", str(out / "a_b.gem"), *words]) == ExitCode.OK
    words = ("-o", str(out / "r"), "--shots", "1", "--lpips", "none", "--components", "1", "2")
    assert main(["evaluate", str(out / "a_b.gem"), str(toy_capture), *words]) == ExitCode.OK
    return out / "r"


@pytest.fixture
def report(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "report.json").read_text())


def test_every_table_says_its_command_machine_and_the_papers_figures(report: dict[str, Any]) -> None:
    text = section(report)
    command = "    gemheads evaluate a_b.gem toy --shots 1 --lpips none --components 1 2 -o REPORT"
    assert command in text.splitlines()
    assert report["machine"]["processor"] in text
    assert "Table 1, novel view" in text
    psnr = report["tables"]["test"]["means"]["a_b"]["PSNR"]
    assert f"| PSNR | {psnr:.2f} | *32.68* | *29.25* | *28.31* |" in text
    sizes = [line for line in text.splitlines() if line.startswith(r"| a\_b | 16 | ")]
    assert [line.split(" | ")[2] for line in sizes] == ["1", "2"]
    assert "-o REPORT" in text


def test_rows_are_as_long_as_their_heads(report: dict[str, Any]) -> None:
    lines = section(report).splitlines()
    lengths = []
    for line, before in zip(lines, ["", *lines], strict=False):
        if line.startswith("| "):
            count = line.replace("\\|", "").count("|")
            assert not before.startswith("| ") or count == lengths[-1]
            lengths.append(count)
    assert len(lengths) > 15
    assert table(["a"], [["b"]]) == "| a |\n| --- |\n| b |"


def test_a_report_of_another_version_is_named(report: dict[str, Any]) -> None:
    del report["command"]
    with pytest.raises(UnknownReport, match="'command'; make it again"):
        section(report)


def test_the_bench_prints_it(folder: Path) -> None:
    words = [sys.executable, str(BENCH), str(folder), "--print"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.startswith("# Results")
    assert "## Beside other viewers" in done.stdout
    done = subprocess.run(
        [sys.executable, str(BENCH), "nowhere"], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 3
    assert refusal(done.stderr)
