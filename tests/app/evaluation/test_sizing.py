"""`evaluate --components` and `--jobs`: what fewer components cost and save, by however many processes."""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("torch", reason="evaluating needs the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.evaluation import judging
from gemheads.app.evaluation.report.curves import color_of
from gemheads.app.evaluation.report.pictures import Gallery, choose
from gemheads.app.evaluation.report.sizes import Pace, Variant, sizes_json
from gemheads.app.evaluation.report.sizessection import sizes_section
from gemheads.models.captures.reader import open_capture
from gemheads.models.captures.standin import StandIn
from gemheads.models.gemfile import load_gem, save_gem
from gemheads.models.metrics.pixels import psnr
from gemheads.models.metrics.tables import METRICS, SIZES
from gemheads.models.train.judging.contestants import Act, GemContestant
from gemheads.models.train.judging.crew import Crew
from gemheads.models.train.judging.evaluate import Alone
from gemheads.models.train.judging.ledger import Record
from gemheads.models.train.workers import WorkerLost
from gems import statue
from refusals import refused


def evaluate(*words: object) -> int:
    return main(["evaluate", *map(str, words), "--lpips", "none"])


@pytest.fixture(scope="module")
def avatar(toy_capture: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("avatars") / "toy.gem"
    words = ("--maps", "24", "--components", "4")
    assert main(["distill", str(toy_capture), "-o", str(path), *words]) == ExitCode.OK
    return path


def test_fewer_components_have_rows_of_their_own(
    toy_capture: Path, avatar: Path, run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "report"
    words = (avatar, toy_capture, "--against", run, "-o", out, "--shots", 1, "--components", 1, 4, "--jobs", 1)
    assert evaluate(*words) == ExitCode.OK
    assert "toy, 1 components, 24 maps: PSNR" in capsys.readouterr().out
    report = json.loads((out / "report.json").read_text())
    one, four, cnn = report["sizes"]["rows"]
    assert [one["components"], four["components"], cnn["components"]] == [1, 4, None]
    assert four["means"] == report["tables"]["test"]["means"]["toy"]
    assert cnn["means"] == report["tables"]["test"]["means"]["cnn"]
    gem, capture = load_gem(avatar), open_capture(toy_capture)
    save_gem(gem.truncated(1), tmp_path / "one.gem", "fp16")
    assert one["megabytes"]["fp16"] == (tmp_path / "one.gem").stat().st_size / 1e6
    assert one["megabytes"]["int8"] < one["megabytes"]["fp16"] < four["megabytes"]["fp16"]
    (picture,) = report["sizes"]["pictures"]
    (shot,) = (s for s in capture.test if (s.timestep, s.camera_index) == (picture["timestep"], picture["camera"]))
    contestant, standin = GemContestant(gem.truncated(1), capture), StandIn(capture)
    image = contestant.draw(standin, shot, contestant.act(shot, "test"))
    assert one["means"]["PSNR"] == pytest.approx(psnr(image, standin.truth(shot)), abs=0.1)  # threads add otherwise
    for row in (one, four, cnn):
        assert row["fps"] == pytest.approx(1000 / row["frame_ms"], rel=0.1)
    assert report["sizes"]["size"] == "64x64"
    assert report["sizes"]["engine"] in ("software", "quads", "quads/software", "software/quads")
    assert "Components and map size" in (out / "report.html").read_text()


def test_so_many_processes_judge_as_were_asked_for(
    toy_capture: Path, avatar: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That they find the same is in tests/models/train/judging/test_crew.py."""
    asked: list[int] = []

    def alone(crew: Crew, identity: str, opens: Any) -> Alone:
        asked.append(crew._jobs)
        return Alone(opens(crew._capture), crew._capture, crew._judge())

    monkeypatch.setattr(Crew, "judging", alone)
    words = (avatar, toy_capture, "-o", tmp_path / "r", "--shots", 1, "--jobs")
    assert evaluate(*words, 1) == ExitCode.OK
    assert asked == []
    assert evaluate(*words, 3) == ExitCode.OK
    assert asked == [3]


def test_a_process_that_died_is_one_line(
    toy_capture: Path,
    avatar: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def gone(*_: object) -> None:
        raise WorkerLost("a process that judged pictures is gone")

    monkeypatch.setattr(Crew, "records", gone)
    words = (avatar, toy_capture, "-o", tmp_path / "r", "--shots", 1, "--jobs", 2)
    assert refused(capsys, "evaluate", *words) == (ExitCode.INPUT, "error: a process that judged pictures is gone\n")


def test_as_many_processes_as_are_worth_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.cpu_count", lambda: 6)
    assert judging.worth(judging.FEW - 1) == 1
    monkeypatch.setattr(judging, "MEMORY", 1)
    assert judging.worth(judging.FEW) == 6
    monkeypatch.setattr(judging, "MEMORY", 1 << 60)
    assert judging.worth(judging.FEW) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--components", "5"), "--components 5: choose from 1 to 4"),
        (("--components", "0"), "--components 0: choose from 1 to 4"),
        (("--jobs", "0"), "--jobs 0: choose from 1 to"),
    ],
)
def test_what_cannot_be_is_one_line(
    toy_capture: Path,
    avatar: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    said: str,
) -> None:
    code, error = refused(capsys, "evaluate", avatar, toy_capture, "-o", tmp_path / "r", *words)
    assert code == ExitCode.USAGE
    assert said in error
    assert not (tmp_path / "r").exists()


def test_components_of_what_does_not_move_are_refused(
    toy_capture: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_gem(statue(), tmp_path / "statue.gem")
    words = (tmp_path / "statue.gem", toy_capture, "-o", tmp_path / "r", "--components", "1")
    code, error = refused(capsys, "evaluate", *words)
    assert code == ExitCode.USAGE
    assert error == "error: --components 1: no .gem among the avatars moves, so it has none; leave it out\n"


def figures(psnrs: dict[str, Sequence[float]], components: Sequence[int | None], capture: Path) -> dict[str, Any]:
    shots = open_capture(capture).test[:2]
    variants = [
        Variant(label, label.split(",")[0], "GEM", 24, 100, count, {"int8": 1.0})
        for label, count in zip(psnrs, components, strict=True)
    ]
    act = Act(None, None, None, (), 0.0)
    records = {
        label: [Record(act, {**dict.fromkeys(METRICS), "PSNR": value}) for value in values]
        for label, values in psnrs.items()
    }
    pace = Pace("software", "2 threads", 64, 64, 3, dict.fromkeys(psnrs, 5.0))
    return sizes_json("test", shots, variants, records, pace, ["<note>"])


def test_the_section_says_what_was_found_and_what_the_paper_has(toy_capture: Path) -> None:
    psnrs = {"a<b, 1 components": [20.0, 22.0], "a<b, 4 components": [30.0, 32.0], "cnn": [25.0, 27.0]}
    told = figures(psnrs, [1, 4, None], toy_capture)
    assert [row["means"]["PSNR"] for row in told["rows"]] == [21, 31, 26]
    assert told["rows"][0]["fps"] == 200
    gallery = Gallery(choose([1.0, 2.0]))
    image = np.zeros((8, 8, 3), np.uint8)
    for row in ("", *psnrs):
        for place in (0, 1):
            gallery.add(row, place, image, image)
        gallery.end_row(row)
    html = sizes_section(told, gallery, ["none", "a<b", "cnn"])
    assert "a<b" not in html
    assert "&lt;note&gt;" in html
    assert "26.00" in html
    assert all(f"{row.psnr:.2f}" in html for row in SIZES)
    assert html.count("a&lt;b, 24 maps, 1 components: 21.00") == 1
    assert color_of(2) in html
    curve = html.split("PSNR by components")[2].split("</svg>")[0]
    assert re.findall('stroke="(#.*?)"', curve) == [color_of(1)]  # of its column, though the first has no row
    assert html.count("data:image/jpeg") == 4 + 2 * (1 + 2 * 3)
