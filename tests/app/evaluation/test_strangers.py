"""`evaluate --drivers`: what it measures of avatars driven by strangers, that it goes on, and what it refuses."""

import json
import re
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from gemheads.app import library
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.evaluation import trials
from gemheads.models.crossing import clip, kept, mirror, neutrals, pace, poseleak, still
from gemheads.models.crossing.channels import CHANNELS
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.regressor import FEATURES_INPUT, OUTPUT, ROTATION_INPUT
from gemheads.models.gem import Gem
from gemheads.models.gemfile import save_gem
from gems import ball
from links import Links
from pixelface import PixelTracker, painted
from refusals import refused

from ..conftest import Clip

onnx = pytest.importorskip("onnx", reason="the regressor of these tests is built with onnx")


def evaluate(*words: object) -> int:
    return main(["evaluate", *map(str, words)])


def report_of(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "report.json").read_text())["crossing"]


@pytest.fixture(autouse=True)
def painted_faces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Everybody's tracker reads paint; what takes long is short; no avatar ships."""
    for module in (clip, still, mirror):
        monkeypatch.setattr(module, "FaceTracker", PixelTracker)
    monkeypatch.setattr(trials, "SIZE", 64)
    monkeypatch.setattr("gemheads.app.evaluation.robustness.SIZE", 64)
    monkeypatch.setattr(neutrals, "FRAMES", 4)
    monkeypatch.setattr(still, "FRAMES", 18)
    monkeypatch.setattr(pace, "STEPS", 3)
    monkeypatch.setattr(poseleak, "SIDE_STEPS", 1)
    monkeypatch.setattr(poseleak, "ROUND_STEPS", 2)
    monkeypatch.setattr(library, "SHIPPED", Path("nowhere"))


def film(path: Path, seed: int = 0, frames: int = 16) -> Path:
    """A person who talks and smiles, at rest in the beginning."""
    rng = np.random.default_rng(seed)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=25, options={"qscale": "2"})
        stream.width = stream.height = 96
        stream.pix_fmt = "yuv420p"
        for frame in range(frames):
            t = max(0, frame - 3) / frames
            picture = painted(t * rng.uniform(), t, 0.2 * np.sin(8 * t))
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())
    return path


@pytest.fixture
def drivers(tmp_path: Path) -> tuple[Path, Path]:
    return film(tmp_path / "ann.mp4"), film(tmp_path / "bob.mp4", seed=1)


def graph(count: int) -> bytes:
    """k = tanh(r W + rotation V)."""
    helper, floats = onnx.helper, onnx.TensorProto.FLOAT
    rng = np.random.default_rng(0)
    weights = [
        onnx.numpy_helper.from_array(rng.normal(0, 0.02, (width, count)).astype(np.float32), name)
        for name, width in (("W", DIMENSION), ("V", 3))
    ]
    body = [
        helper.make_node("MatMul", [FEATURES_INPUT, "W"], ["a"]),
        helper.make_node("MatMul", [ROTATION_INPUT, "V"], ["b"]),
        helper.make_node("Add", ["a", "b"], ["c"]),
        helper.make_node("Tanh", ["c"], [OUTPUT]),
    ]
    inputs = [helper.make_tensor_value_info(FEATURES_INPUT, floats, [1, DIMENSION])]
    inputs.append(helper.make_tensor_value_info(ROTATION_INPUT, floats, [1, 3]))
    outputs = [helper.make_tensor_value_info(OUTPUT, floats, [1, count])]
    content = helper.make_graph(body, "regressor", inputs, outputs, weights)
    return helper.make_model(content, opset_imports=[helper.make_opsetid("", 17)], ir_version=8).SerializeToString()


@pytest.fixture
def learned(tmp_path: Path) -> Path:
    """An avatar with a regressor."""
    gem: Gem = ball(1)
    save_gem(replace(gem, regressor=graph(gem.coefficient_count)), tmp_path / "learned.gem")
    return tmp_path / "learned.gem"


def test_all_drivers_drive_all_avatars_by_all_ways(
    learned: Path, tiny: Path, drivers: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "r"
    assert evaluate(learned, "--against", tiny, "--drivers", *drivers, "-o", out, "--every", 1) == ExitCode.OK
    said = capsys.readouterr().out
    assert "Driven by strangers, learned, regressor: " in said
    assert "sigma, " in said
    assert "pose leak " in said
    assert "tiny has no regressor: only the baseline drives it." in said
    report = report_of(out)
    assert [driver["name"] for driver in report["drivers"]] == ["ann", "bob"]
    assert [driver["frames"] for driver in report["drivers"]] == [16, 16]
    rows = {(row["avatar"], row["driving"]): row for row in report["rows"]}
    assert list(rows) == [("learned", "regressor"), ("learned", "baseline"), ("tiny", "baseline")]
    for row in rows.values():
        for driver in ("ann", "bob"):
            assert set(row["drivers"][driver]["correlation"]) == {channel.name for channel in CHANNELS}
            assert row["drivers"][driver]["correlation"]["mouthPucker"] is None
            assert row["drivers"][driver]["worst"]
            # painted smiles keep their lips together
            assert row["drivers"][driver]["lips"] == {"off_mm": 0.0, "shut": None}
        known = [row["drivers"][driver]["correlation"]["mouthSmile"] for driver in ("ann", "bob")]
        assert row["median"]["mouthSmile"] == pytest.approx(np.median(known), abs=1e-4)
        assert row["median"]["mouthPucker"] is None
        assert row["met"]["mouthSmile"] == (row["median"]["mouthSmile"] >= 0.97)
        assert set(row["embedding"]) == {"cosine", "chance", "l1", "frechet"}
        assert row["fps"] > row["fps_with_tracking"] > 0
        steady = row["robustness"]
        assert set(steady["jitter"]["drivers"]) == {"ann", "bob"}
        leak = steady["pose_leak"][row["avatar"]]
        for unit in ("sigma", "mm"):
            ratio = leak["yaw"][unit] / steady["expression"][unit]
            assert leak["yaw_ratio"][unit] == pytest.approx(ratio, rel=0.02, abs=1e-3)
        assert leak["met"] == (leak["yaw_ratio"]["sigma"] <= 0.25)
        assert steady["neutrals"]["mean"]["sigma"] > 0
    every_channel = (out / "report.html").read_text().split("Every channel: learned, regressor")[1]
    cells = re.findall("<td>(.*?)</td>", every_channel.split("<td>mouthSmile</td>")[1].split("</tr>")[0])
    for cell, kind in zip(cells[-2:], ("amplitude", "unrest"), strict=True):
        both = [rows["learned", "regressor"]["drivers"][driver][kind]["mouthSmile"] for driver in ("ann", "bob")]
        assert cell == f"{np.median(both):.2f}"
    cells = re.findall("<td>(.*?)</td>", every_channel.split("lips off, mm")[1].split("</tr>")[0])
    assert cells[:2] == ["0.00", "0.00"]
    jitter = rows["learned", "regressor"]["robustness"]["jitter"]
    assert jitter["raw"]["sigma"] > jitter["smoothed"]["sigma"] > 0
    assert report["published"]["GEM"]["cosine"] == 0.9381
    whole = json.loads((out / "report.json").read_text())
    assert whole["version"] == 2
    assert whole["capture"] is None
    assert str(tmp_path) not in (out / "report.json").read_text()


def test_the_page_shows_everybody_and_asks_for_nothing(
    learned: Path, drivers: tuple[Path, Path], tmp_path: Path
) -> None:
    hostile = tmp_path / "<script>alert(1)<!-- & 'x'.mp4"
    drivers[0].rename(hostile)
    assert evaluate(learned, "--drivers", hostile, "-o", tmp_path / "r", "--every", 1) == ExitCode.OK
    text = (tmp_path / "r" / "report.html").read_text()
    page = Links()
    page.feed(text)
    assert "script" not in page.tags
    assert all(link.startswith("data:image/jpeg;base64,") for link in page.asked)
    assert len(page.asked) > 4
    assert text.count("<svg") == 8
    assert "paper: GEM" in text
    assert "driver above avatar" in text


def test_stopped_it_goes_on_to_the_same_report(
    learned: Path, drivers: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = (learned, "--drivers", *drivers, "--every", 1, "-o")
    assert evaluate(*words, tmp_path / "whole") == ExitCode.OK
    drawn = 0
    draw = mirror.Mirror.draw

    def watched(*told: Any) -> Any:
        nonlocal drawn
        drawn += 1
        if drawn == stop:
            raise KeyboardInterrupt
        return draw(*told)

    monkeypatch.setattr(mirror.Mirror, "draw", watched)
    stop, parts = 60, 0
    while evaluate(*words, tmp_path / "parts") == ExitCode.INTERRUPTED:
        assert not (tmp_path / "parts" / "report.json").exists()
        drawn, parts = 0, parts + 1
        assert parts < 20
    assert parts >= 2
    first, second = report_of(tmp_path / "whole"), report_of(tmp_path / "parts")
    for report in (first, second):
        for row in report["rows"]:
            del row["step_ms"], row["tracking_ms"], row["fps"], row["fps_with_tracking"]
    assert first == second
    strips = [re.findall("base64,[^']+", (tmp_path / f / "report.html").read_text()) for f in ("whole", "parts")]
    assert strips[0] == strips[1]
    drawn, stop = 0, -1
    assert evaluate(*words, tmp_path / "parts") == ExitCode.OK
    assert drawn == 2 * (pace.WARMING + pace.STEPS)  # nothing is left to be drawn but what is timed


def test_another_clip_under_the_same_name_and_other_settings_are_judged_anew(
    tiny: Path, drivers: tuple[Path, Path], tmp_path: Path
) -> None:
    out = tmp_path / "r"
    assert evaluate(tiny, "--drivers", drivers[0], "-o", out, "--every", 1) == ExitCode.OK
    before = report_of(out)["drivers"]
    drivers[0].write_bytes(drivers[1].read_bytes())
    assert evaluate(tiny, "--drivers", drivers[0], "-o", out, "--every", 1) == ExitCode.OK
    assert report_of(out)["drivers"][0]["sha256"] != before[0]["sha256"]
    assert evaluate(tiny, "--drivers", drivers[0], "-o", out, "--every", 2) == ExitCode.OK
    assert report_of(out)["drivers"][0]["frames"] == 8


def test_a_clip_of_which_not_all_is_kept_says_how_much(
    tiny: Path,
    drivers: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(clip, "MOST_FRAMES", 11)
    out = tmp_path / "r"
    assert evaluate(tiny, "--drivers", drivers[0], "-o", out, "--every", 1) == ExitCode.OK
    said = (
        "Of ann the first 11 frames with a face are taken, 0.4 s: no more are kept; a larger --every reaches farther."
    )
    assert said in capsys.readouterr().out
    assert said in report_of(out)["notes"]
    assert report_of(out)["drivers"][0]["seconds"] == 0.4
    assert "11 frames in 0.4 s. Neutral: " in (out / "report.html").read_text()


def test_the_command_that_is_printed_can_be_given(tiny: Path, drivers: tuple[Path, Path], tmp_path: Path) -> None:
    talk = drivers[0].rename(tmp_path / "Ann's talk.mp4")
    assert evaluate(tiny, "--drivers", talk, "-o", tmp_path / "r", "--every", 1) == ExitCode.OK
    command = json.loads((tmp_path / "r" / "report.json").read_text())["command"]
    words = ["tiny.gem", "--drivers", "Ann's talk.mp4", "--every", "1", "--seconds", "30", "-o", "REPORT"]
    assert shlex.split(command) == ["gemheads", "evaluate", *words]


def test_pictures_in_a_folder_drive_too(tiny: Path, tmp_path: Path) -> None:
    import cv2

    folder = tmp_path / "cara"
    folder.mkdir()
    for frame in range(10):
        cv2.imwrite(str(folder / f"{frame}.png"), painted(0.1 * frame, 0.5))
    assert evaluate(tiny, "--drivers", folder, "-o", tmp_path / "r", "--every", 1) == ExitCode.OK
    (driver,) = report_of(tmp_path / "r")["drivers"]
    assert (driver["name"], driver["frames"]) == ("cara", 10)


def test_an_avatar_whose_face_is_not_seen_is_left_out(
    learned: Path,
    tiny: Path,
    drivers: tuple[Path, Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    read = mirror.Mirror.read
    monkeypatch.setattr(mirror.Mirror, "read", lambda self, *shown: None if self.gem.regressor else read(self, *shown))
    words = ("--drivers", drivers[0], "--every", 1, "-o")
    assert evaluate(learned, "--against", tiny, *words, tmp_path / "r") == ExitCode.OK
    assert "learned is left out: the tracker sees no face in the neutral picture" in capsys.readouterr().out
    assert {row["avatar"] for row in report_of(tmp_path / "r")["rows"]} == {"tiny"}
    assert evaluate(learned, *words, tmp_path / "q") == ExitCode.INPUT


@pytest.fixture
def places(tiny: Path, drivers: tuple[Path, Path], make_clip: Clip, tmp_path: Path) -> dict[str, Path]:
    """What commands may be given, by name."""
    bare = tmp_path / "bare.gem"
    save_gem(replace(ball(), arkit_weights=None), bare)
    text = tmp_path / "text.mp4"
    text.write_text("this is no video")
    empty = tmp_path / "empty.mp4"
    empty.write_bytes(b"")
    zero = make_clip("zero.mp4", pts=())
    nobody = make_clip("nobody.mp4", pts=tuple(range(0, 30030, 1001)))
    run = tmp_path / "run"
    run.mkdir()
    (run / "config.json").write_text("{}")
    found = {"bare": bare, "text": text, "empty": empty, "zero": zero, "nobody": nobody, "run": run}
    return {"tiny": tiny, "ann": drivers[0], "bob": drivers[1], "out": tmp_path / "r", **found}


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("{tiny}",), ExitCode.USAGE, "give a CAPTURE, or --drivers VIDEO..., or both"),
        (("{tiny}", "--drivers", "{ann}", "{ann}"), ExitCode.USAGE, "is given twice"),
        (("{tiny}", "--drivers", "{ann}", "--every", "0"), ExitCode.USAGE, "--every 0: choose from 1"),
        (("{tiny}", "--drivers", "{ann}", "--seconds", "nan"), ExitCode.USAGE, "--seconds nan: choose from 1"),
        (("{tiny}", "--drivers", "{ann}", "nowhere.mp4"), ExitCode.INPUT, "no such file or folder"),
        (("{tiny}", "--drivers", "{text}"), ExitCode.INPUT, "not a readable video"),
        (("{tiny}", "--drivers", "{empty}"), ExitCode.INPUT, "the file is empty"),
        (("{tiny}", "--drivers", "{zero}"), ExitCode.INPUT, "zero.mp4"),
        (("{tiny}", "--drivers", "{nobody}"), ExitCode.NO_FACE, "a face in 0 of 30 frames, 8 are needed"),
        (
            ("{tiny}", "--drivers", "{ann}", "--every", "9"),
            ExitCode.INPUT,
            "2 frames are taken, 8 are needed (--every 9",
        ),
        (("{tiny}", "--drivers", "{ann}", "--shots", "5"), ExitCode.USAGE, "--shots: does nothing for drivers alone"),
        (("{tiny}", "--drivers", "{ann}", "--all"), ExitCode.USAGE, "--all: does nothing for drivers alone"),
        (("{tiny}", "--drivers", "{ann}", "--lpips", "none"), ExitCode.USAGE, "--lpips: does nothing for drivers"),
        (("{tiny}", "--drivers", "{ann}", "--jobs", "1"), ExitCode.USAGE, "--jobs: does nothing for drivers alone"),
        (("{bare}", "--drivers", "{ann}"), ExitCode.INPUT, "neither a regressor nor ARKit shapes"),
        (("{run}", "--drivers", "{ann}"), ExitCode.INPUT, "a run is judged on a capture"),
        (("{tiny}", "--drivers", "{ann}", "-o", "{tiny}"), ExitCode.USAGE, "is a file; name a folder"),
    ],
)
def test_what_cannot_be_done_is_one_line(
    places: dict[str, Path],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    code: ExitCode,
    said: str,
) -> None:
    if "{nobody}" in words:
        monkeypatch.setattr(PixelTracker, "track", lambda *_: None)
    out = () if "-o" in words else ("-o", places["out"])
    more = () if "--every" in words else ("--every", 1)
    found, error = refused(capsys, "evaluate", *(word.format(**places) for word in words), *out, *more)
    assert found == code
    assert said in error
    assert not (places["out"] / "report.json").exists()


@pytest.mark.parametrize("name", ["report.json", "report.html"])
def test_a_report_of_something_else_is_not_written_over(
    tiny: Path, drivers: tuple[Path, Path], tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "r"
    out.mkdir()
    (out / name).write_text('{"coverage": 90}')
    words = (tiny, "--drivers", drivers[0], "-o", out, "--every", 1)
    code, error = refused(capsys, "evaluate", *words)
    assert code == ExitCode.USAGE
    assert f"{name}: was not written by evaluate, and would be written over; name another folder" in error
    assert (out / name).read_text() == '{"coverage": 90}'
    assert [file.name for file in out.iterdir()] == [name]
    (out / name).unlink()
    for _ in range(2):  # its own is
        assert evaluate(*words) == ExitCode.OK


def test_what_is_kept_depends_on_the_version(
    tiny: Path, drivers: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = (tiny, "--drivers", drivers[0], "-o", tmp_path / "r", "--every", 1)
    assert evaluate(*words) == ExitCode.OK
    files = set((tmp_path / "r" / "judged" / "crossing").iterdir())
    monkeypatch.setattr(kept, "VERSION", 99)
    assert evaluate(*words) == ExitCode.OK
    assert len(set((tmp_path / "r" / "judged" / "crossing").iterdir())) == 2 * len(files)


def test_results_are_printed_of_it(learned: Path, drivers: tuple[Path, Path], tmp_path: Path) -> None:
    out = tmp_path / "r"
    assert evaluate(learned, "--drivers", drivers[0], "-o", out, "--every", 1) == ExitCode.OK
    bench = Path(__file__).resolve().parents[2] / "bench" / "results.py"
    words = [sys.executable, str(bench), str(out), "--print"]
    text = subprocess.run(words, capture_output=True, text=True, timeout=60, check=True).stdout
    assert "    gemheads evaluate learned.gem --drivers ann.mp4 --every 1 --seconds 30 -o REPORT" in text
    row, other = report_of(out)["rows"]
    assert f"| cosine ↑ | {row['embedding']['cosine']:.4f} | " in text
    smile = next(line for line in text.splitlines() if line.startswith("| mouthSmile | 0.97 | "))
    assert smile == f"| mouthSmile | 0.97 | {row['median']['mouthSmile']:.3f} | {other['median']['mouthSmile']:.3f} |"
    assert f"| RMS of expression |  | {row['robustness']['expression']['sigma']:.2f} / " in text
