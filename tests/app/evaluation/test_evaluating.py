"""`evaluate`: what it measures, that it goes on where it was stopped, and that its page needs nothing else."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("torch", reason="evaluating needs the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.models.captures.reader import open_capture
from gemheads.models.captures.standin import StandIn
from gemheads.models.gemfile import load_gem
from gemheads.models.metrics.pixels import l1, psnr
from gemheads.models.train.judging.contestants import GemContestant
from gemheads.models.train.perceptual import TINY, Perceptual, WeightsMissing
from links import Links
from refusals import refused

QUICK = ("--lpips", "none", "--shots", "2")


def evaluate(*words: object) -> int:
    return main(["evaluate", *map(str, words)])


def report_of(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "report.json").read_text())


@pytest.fixture(scope="module")
def avatars(toy_capture: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The capture's bare mesh with many components, and with one."""
    folder = tmp_path_factory.mktemp("avatars")
    for name, components in (("toy", "4"), ("poor", "1")):
        words = ("--maps", "24", "--components", components)
        assert main(["distill", str(toy_capture), "-o", str(folder / f"{name}.gem"), *words]) == ExitCode.OK
    return folder / "toy.gem", folder / "poor.gem"


def test_avatars_and_a_run_stand_side_by_side(
    toy_capture: Path, avatars: tuple[Path, Path], run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "report"
    assert evaluate(avatars[0], toy_capture, "--against", avatars[1], run, "-o", out, *QUICK) == ExitCode.OK
    assert "Novel expression, toy: PSNR" in capsys.readouterr().out
    report = report_of(out)
    assert [column["name"] for column in report["avatars"]] == ["toy", "poor", "cnn"]
    assert [column["kind"] for column in report["avatars"]] == ["GEM", "GEM", "CNN"]
    for split, cameras in (("val", {4}), ("test", {0, 1, 2, 3, 4})):
        table = report["tables"][split]
        assert len(table["pictures"]) == 2
        for picture in table["pictures"]:
            assert picture["camera"] in cameras
            assert set(picture["values"]) == {"toy", "poor", "cnn"}
            assert picture["camera"] not in picture["fitted_in_cameras"]["toy"]
            assert picture["fitted_in_cameras"]["cnn"] == []
        values = [picture["values"]["toy"]["PSNR"] for picture in table["pictures"]]
        assert table["means"]["toy"]["PSNR"] == pytest.approx(np.mean(values))
        assert table["means"]["toy"]["LPIPS"] is None
        assert table["published"]["GEM"]["PSNR"] > 30
    assert any("LPIPS is left out" in note for note in report["notes"])
    assert str(tmp_path) not in (out / "report.json").read_text()


def test_figures_are_those_of_the_pictures(toy_capture: Path, avatars: tuple[Path, Path], tmp_path: Path) -> None:
    assert evaluate(avatars[0], toy_capture, "-o", tmp_path / "r", *QUICK) == ExitCode.OK
    table = report_of(tmp_path / "r")["tables"]["test"]
    capture = open_capture(toy_capture)
    contestant, standin = GemContestant(load_gem(avatars[0]), capture), StandIn(capture)
    for told in table["pictures"]:
        (shot,) = (s for s in capture.test if (s.timestep, s.camera_index) == (told["timestep"], told["camera"]))
        assert told["picture"] == shot.picture.relative_to(capture.folder).as_posix()
        image, truth = contestant.draw(standin, shot, contestant.act(shot, "test")), standin.truth(shot)
        assert told["values"]["toy"]["PSNR"] == pytest.approx(psnr(image, truth), abs=1e-6)
        assert told["values"]["toy"]["L1"] == pytest.approx(l1(image, truth), abs=1e-9)


def test_stopped_it_goes_on_to_the_same_report(
    toy_capture: Path,
    avatars: tuple[Path, Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    acted: list[int] = []
    act = GemContestant.act

    def watched(self: GemContestant, *words: Any) -> Any:
        acted.append(words[0].timestep)
        if len(acted) == 3 and stop:
            raise KeyboardInterrupt
        return act(self, *words)

    stop = False
    monkeypatch.setattr(GemContestant, "act", watched)
    assert evaluate(avatars[0], toy_capture, "-o", whole, *QUICK) == ExitCode.OK
    assert len(acted) == 4
    acted, stop = [], True
    assert evaluate(avatars[0], toy_capture, "-o", parts, *QUICK) == ExitCode.INTERRUPTED
    assert "the same command continues" in capsys.readouterr().out
    assert not (parts / "report.json").exists()
    acted, stop = [], False
    assert evaluate(avatars[0], toy_capture, "-o", parts, *QUICK) == ExitCode.OK
    assert len(acted) == 2
    first, second = report_of(whole), report_of(parts)
    for report in (first, second):
        for table in report["tables"].values():
            del table["seconds_to_find"]
    assert first["tables"] == second["tables"]
    pictures = [re.findall(r"data:image/jpeg;base64,[^']+", (f / "report.html").read_text()) for f in (whole, parts)]
    assert pictures[0] == pictures[1]
    assert len(pictures[0]) > 8


def test_the_page_asks_for_nothing_and_runs_nothing(
    toy_capture: Path, tmp_path: Path, avatars: tuple[Path, Path]
) -> None:
    hostile = tmp_path / "<script>alert(1)<!-- & 'x'.gem"
    hostile.write_bytes(avatars[0].read_bytes())
    assert evaluate(hostile, toy_capture, "-o", tmp_path / "r", *QUICK) == ExitCode.OK
    page = Links()
    page.feed((tmp_path / "r" / "report.html").read_text())
    assert "script" not in page.tags
    assert page.asked
    assert all(link.startswith("data:image/jpeg;base64,") for link in page.asked)


def test_what_is_kept_is_believed_unless_it_is_broken(
    toy_capture: Path, avatars: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "r"
    assert evaluate(avatars[0], toy_capture, "-o", out, "--lpips", "none", "--shots", 1) == ExitCode.OK
    (kept,) = (out / "judged").iterdir()
    told = json.loads(kept.read_text())
    for record in told["judged"].values():
        record["values"]["PSNR"] = 77.0
    kept.write_text(json.dumps(told))
    assert evaluate(avatars[0], toy_capture, "-o", out, "--lpips", "none", "--shots", 1) == ExitCode.OK
    assert report_of(out)["tables"]["val"]["means"]["toy"]["PSNR"] == 77.0
    kept.write_text("{")
    assert evaluate(avatars[0], toy_capture, "-o", out, "--lpips", "none", "--shots", 1) == ExitCode.OK
    assert report_of(out)["tables"]["val"]["means"]["toy"]["PSNR"] != 77.0


def test_lpips_is_measured_or_a_line_says_why_not(
    toy_capture: Path, avatars: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = "gemheads.models.train.perceptual.Perceptual"
    monkeypatch.setattr(name, lambda network, device: Perceptual(TINY))
    words = (avatars[0], toy_capture, "-o", tmp_path / "r", "--shots", 1)
    assert evaluate(*words) == ExitCode.OK
    assert report_of(tmp_path / "r")["tables"]["val"]["means"]["toy"]["LPIPS"] > 0

    def missing(*_: object) -> None:
        raise WeightsMissing("vgg: its weights cannot be fetched")

    monkeypatch.setattr(name, missing)
    assert evaluate(*words) == ExitCode.OK
    report = report_of(tmp_path / "r")
    assert report["tables"]["val"]["means"]["toy"]["LPIPS"] is None
    assert "LPIPS is left out: vgg: its weights cannot be fetched" in report["notes"]


def emptied(capture: Path, folder: Path, *splits: str) -> Path:
    """The capture without some of its splits."""
    folder.mkdir()
    for path in capture.iterdir():
        if path.name not in {f"transforms_{split}.json" for split in splits}:
            (folder / path.name).symlink_to(path)
    return folder


def test_a_capture_without_one_split_has_one_table(
    toy_capture: Path, avatars: tuple[Path, Path], tmp_path: Path
) -> None:
    capture = emptied(toy_capture, tmp_path / "seen", "val")
    assert evaluate(avatars[0], capture, "-o", tmp_path / "r", *QUICK) == ExitCode.OK
    report = report_of(tmp_path / "r")
    assert set(report["tables"]) == {"test"}
    assert any("no novel view (val) pictures" in note for note in report["notes"])


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("{toy}", "{capture}", "--shots", "0"), ExitCode.USAGE, "--shots 0: choose from 1"),
        (("{toy}", "{capture}", "-o", "{capture}"), ExitCode.USAGE, "is a capture or a training run; name another"),
        (("{toy}", "{capture}", "-o", "r.html"), ExitCode.USAGE, "the report is a folder, such as -o r"),
        (("{toy}", "{capture}", "--against", "{toy}"), ExitCode.USAGE, "is given twice"),
        (("nobody", "{capture}"), ExitCode.INPUT, "nobody: neither an avatar's name"),
        (("{toy}", "{capture}", "--against", "{capture}"), ExitCode.INPUT, "it is no ordinary file"),
        (("{toy}", "nowhere"), ExitCode.INPUT, "nowhere: is no folder"),
        (("{toy}", "{unjudged}"), ExitCode.INPUT, "neither a held-out camera (transforms_val.json) nor"),
        (("{toy}", "{capture}", "-o", "{toy}"), ExitCode.USAGE, "is a file; name a folder"),
        (("{toy}", "{capture}", "--every", "5"), ExitCode.USAGE, "--every: does nothing for a capture alone"),
        (("{toy}", "{capture}", "--all", "--shots", "5"), ExitCode.USAGE, "--shots: does nothing for --all"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    toy_capture: Path,
    avatars: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    code: ExitCode,
    said: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    unjudged = emptied(toy_capture, tmp_path / "unjudged", "val", "test")
    places = {"toy": avatars[0], "capture": toy_capture, "unjudged": unjudged}
    out = () if "-o" in words else ("-o", "r")
    found, error = refused(capsys, "evaluate", *(word.format(**places) for word in words), *out, "--lpips", "none")
    assert found == code
    assert said in error
    assert not (tmp_path / "r").exists()
