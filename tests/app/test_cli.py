import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from refusals import refused

from .conftest import Clip

COMMANDS = (
    "live",
    "reenact",
    "demo",
    "info",
    "modes",
    "export",
    "distill",
    "bench",
    "doctor",
    "track",
    "fit",
    "train-regressor",
    "evaluate",
    "capture",
    "verify",
)


def run(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "gemheads.app.cli", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def test_help_names_every_command_and_the_exit_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for command in COMMANDS:
        assert command in text
    for code in ExitCode:
        assert str(int(code)) in text


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_every_option(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, "--help"]) == 0
    lines = [line.strip("│ \n") for line in capsys.readouterr().out.splitlines()]
    bare = [line for line in lines if line.startswith("--") and len(line.split()) < 3]
    assert not bare


def test_help_is_quick() -> None:
    """Half a second on an idle machine; against a bare interpreter, so that a busy one does not fail it."""

    def fastest(*command: str) -> float:
        times = []
        for _ in range(3):
            start = time.perf_counter()
            subprocess.run(command, capture_output=True, check=True, timeout=60)
            times.append(time.perf_counter() - start)
        return min(times)

    bare = fastest(sys.executable, "-c", "import argparse")
    assert fastest(sys.executable, "-m", "gemheads.app.cli", "--help") < max(0.5, 12 * bare)


LIGHT = """
import sys
from gemheads.app.cli import main
main(["--help"])
heavy = {"numpy", "numba", "av", "cv2", "onnxruntime", "moderngl", "torch"} & set(sys.modules)
assert not heavy, heavy
"""
NO_TORCH = """
import sys
sys.modules["torch"] = None  # importing it now raises
from gemheads.app import cli, demo, doctor, export, info, live, modes, warm
from gemheads.app.bench import drawing
from gemheads.app.desk import command
from gemheads.app.making import training
from gemheads.app.reenacting import reenact, tracking
cli.main(["info"])
"""


@pytest.mark.parametrize("program", [LIGHT, NO_TORCH], ids=["help imports nothing heavy", "no torch outside training"])
def test_what_is_imported(program: str) -> None:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr


def test_wrong_usage(capsys: pytest.CaptureFixture[str], tiny: Path) -> None:
    named = ("--avatar", str(tiny))
    avatar = (*named, "--driver", "baseline")
    for words, said in (
        (("reenact", "a.mp4"), "--out requires an argument"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--nonsense"), "--nonsense"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--size", "5", *avatar), "512x512"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--components", "1.5", *avatar), "--components: '1.5' is not a whole"),
        (("evaluate", "mara", "-o", "r", "--components", "5", "1.5"), "--components"),
        (("distill", "skin.glb", "--seed", "-1", "--out", "a.gem"), "--seed: -1: choose from 0 to 4294967295. See"),
        (("capture", "mara", "c", "--seed", str(2**64)), "--seed: 18446744073709551616: choose from 0"),
        (("reenact", "-o", "b.mp4", *avatar), "no driver given"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--background", "transparent", *avatar), "cannot be transparent"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--components", "99", *avatar), "stores 6"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--neutral", "first", "--neutral-sheet", "c.png"), "leave it out"),
        (("reenact", "-o", "b.mp4", "--track", "t", "--neutral-sheet", "c.png", *named), "needs no neutral"),
        (("reenact", "-o", "b.mp4", "--track", "t", *avatar), "give it to `gemheads track`"),
        (("reenact", "-o", "b.mp4", "--track", "t", "--neutral", "first", *named), "--neutral: a track needs no"),
        (("reenact", "-o", "b.mp4", "--track", "t", "--side-by-side", *named), "name the video, too"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--track", "t", "--crop", "left", *named), "or add --side-by-side"),
        (("reenact", "a.mp4", "-o", "b.mp4", "--no-badge", "because", *avatar), "say why"),
        (("export", str(tiny), "-o", "a.ply", "--set", "jawOpn=1"), "no ARKit shape is called"),
        (("export", str(tiny), "-o", "a", "--track", "t", "--set", "jawOpen=1"), "leave out one of the two"),
    ):
        code, error = refused(capsys, *words)
        assert code == ExitCode.USAGE, error
        assert said in error


def test_a_terminal_that_cannot_write_a_name(tiny: Path, tmp_path: Path) -> None:
    out = tmp_path / "J\u00fcrgen.ply"
    words = (sys.executable, "-m", "gemheads.app.cli", "export", str(tiny), "-o", str(out))
    surroundings = os.environ | {"PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"}
    ended = subprocess.run(words, env=surroundings, capture_output=True, text=True, timeout=120, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert out.is_file()
    assert "J\\xfcrgen.ply" in ended.stdout


def test_unusable_inputs(capsys: pytest.CaptureFixture[str], tiny: Path, tmp_path: Path, make_clip: Clip) -> None:
    clip, out = str(make_clip()), str(tmp_path / "out.mp4")
    (tmp_path / "text.gem").write_text("no avatar")
    named = ("--avatar", str(tiny))
    avatar = (*named, "--driver", "baseline")
    for words, said in (
        ((clip, "--avatar", "nobody"), "neither an avatar's name"),
        ((clip, "--avatar", str(tmp_path / "text.gem")), "text.gem"),
        ((clip, "--avatar", str(tiny)), "has no regressor"),
        ((str(tmp_path / "none.mp4"), *avatar), "no such file or folder"),
        ((str(tiny), *avatar), "not a readable video"),
        ((clip, "--track", str(tiny), *named), "not a track"),
    ):
        code, error = refused(capsys, "reenact", *words, "-o", out)
        assert code == ExitCode.INPUT, error
        assert said in error
    assert not Path(out).exists()


def test_nobody_in_the_picture(capsys: pytest.CaptureFixture[str], tiny: Path, tmp_path: Path, make_clip: Clip) -> None:
    out = str(tmp_path / "out.mp4")
    words = ("reenact", str(make_clip()), "-o", out, "--avatar", str(tiny), "--driver", "baseline")
    code, error = refused(capsys, *words)
    assert code == ExitCode.NO_FACE
    assert "no face in the whole clip" in error
    assert not Path(out).exists()


def test_what_cannot_be_written(capsys: pytest.CaptureFixture[str], tiny: Path, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    code, error = refused(capsys, "export", str(tiny), "-o", str(tmp_path / "file" / "a.ply"))
    assert code == ExitCode.OUTPUT
    assert "cannot be written" in error


def test_what_nobody_foresaw_is_one_line_and_debug_shows_where(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tiny: Path
) -> None:
    import gemheads.app.export as export

    def torn(*_: object) -> None:
        raise ZeroDivisionError("of no use")

    monkeypatch.setattr(export, "export_expression", torn)
    code, error = refused(capsys, "export", tiny, "-o", "a.ply")
    assert code == ExitCode.UNEXPECTED
    assert "unexpected ZeroDivisionError: of no use" in error
    with pytest.raises(ZeroDivisionError):
        main(["export", str(tiny), "-o", "a.ply", "--debug"])


def test_ply_of_an_expression(tiny: Path, tmp_path: Path) -> None:
    for name, words in (("rest", ()), ("open", ("--set", "jawOpen=1", "mouthSmileLeft=0.5"))):
        assert main(["export", str(tiny), "-o", str(tmp_path / f"{name}.ply"), *words]) == 0
    rest, opened = ((tmp_path / f"{name}.ply").read_bytes() for name in ("rest", "open"))
    assert rest.startswith(b"ply\nformat binary_little_endian 1.0")
    assert len(rest) == len(opened)
    assert rest != opened


@pytest.mark.parametrize(
    "words",
    [
        ("info", "x" * 300),
        ("reenact", "x" * 300, "-o", "b.mp4"),
        ("verify", "x" * 300),
        ("track", "x" * 300, "-o", "t"),
    ],
)
def test_a_name_that_is_too_long_is_refused(capsys: pytest.CaptureFixture[str], words: tuple[str, ...]) -> None:
    code, error = refused(capsys, *words)
    assert code == ExitCode.INPUT, error
    assert "File name too long); check the path" in error


@pytest.mark.parametrize("words", [("distill", "", "-o", "x.gem"), ("train", "cap", "-o", " "), ("info", "")])
def test_an_empty_word_is_not_the_current_folder(capsys: pytest.CaptureFixture[str], words: tuple[str, ...]) -> None:
    code, error = refused(capsys, *words)
    assert code == ExitCode.USAGE, error
    assert "an empty word follows" in error


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--live", "--seconds", "nan"), "--seconds nan: choose from 1 to 3600"),
        (("--live", "--seconds", "0"), "--seconds 0: choose"),
        (("--seconds", "5"), "--seconds is how long --live measures"),
        (("--live", "--quick"), "--quick: the live window has no scenes"),
    ],
)
def test_what_bench_cannot_measure(capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str) -> None:
    code, error = refused(capsys, "bench", *words)
    assert code == ExitCode.USAGE, error
    assert said in error


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("fit", "mara", "{picture}", "-o", "t", "--split", "val"), "--split: does nothing for pictures and videos"),
        (("fit", "mara", "{picture}", "-o", "t", "--cameras", "0"), "--cameras: does nothing for pictures"),
        (("train-regressor", "mara", "--take-over", "theo", "--steps", "5"), "--take-over trains nothing"),
        (("modes", "mara", "-o", "m.png", "--components", "0"), "stores 50; choose from 1 to 50"),
    ],
)
def test_options_that_do_nothing_are_refused(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    code, error = refused(capsys, *(word.format(picture=tmp_path / "a.png") for word in words))
    assert code == ExitCode.USAGE, error
    assert said in error
