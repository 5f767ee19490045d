"""The script of the examples, small: every stage from a capture to somebody else who drives."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from facecapture import person, write_capture
from sealed import can_seal, seal

SCRIPT = Path(__file__).parents[2] / "examples" / "learn_an_avatar.sh"
SMALL = {
    **{"STEPS": "6", "COMPONENTS": "4", "ITERATIONS": "10", "PICTURES": "0", "LESSONS": "10", "SHOTS": "2"},
    **{"PERCEPTUAL": "--no-perceptual", "NETWORK": "none", "PYTHON": sys.executable},
}
PROGRAM = "import sys\nfrom gemheads.app.cli import main\n\nsys.exit(main())\n"
PICTURES = ("2_mesh", "3_train", "4_distill", "5_refine", "6_fit", "7_regressor", "9_table")


STUB = """import json, sys
from pathlib import Path
words = sys.argv[1:]
log, folder = Path(sys.argv[0]).with_name("log"), Path(words[words.index("-o") + 1] if "-o" in words else words[1])
log.write_text((log.read_text() if log.exists() else "") + json.dumps(words) + chr(10))
made = {
    "capture": [folder / "images" / "00000_00.png", folder / "transforms_train.json"],
    "train": [folder / "previews" / "1.png"],
}
for file in made.get(words[0], [folder] if "-o" in words else []):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text('{"frames": [{"file_path": "a"}]}')
"""
"""Says in a file beside it what it was asked for, and makes files where results would be."""
pytestmark = pytest.mark.skipif(shutil.which("bash") is None, reason="the script is one for bash")


class Stubbed:
    """The script with a command that learns nothing."""

    def __init__(self, folder: Path) -> None:
        self.out, self._log, command = folder / "learned", folder / "log", folder / "gemheads"
        for place in (command, folder / "python"):
            place.write_text(f"#!{sys.executable}\n{STUB}")
            place.chmod(0o755)
        self._settings = {**os.environ, "GEMHEADS": str(command), "PYTHON": str(folder / "python")}

    def run(self, *stages: str, **settings: str) -> tuple[str, list[list[str]]]:
        """What it prints, and the words of each command it gave."""
        self._log.unlink(missing_ok=True)
        words = ["bash", str(SCRIPT), str(self.out), *stages]
        done = subprocess.run(
            words, env={**self._settings, **settings}, capture_output=True, text=True, timeout=100, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout, [json.loads(line) for line in self._log.read_text().splitlines()]


def test_a_capture_without_held_out_pictures_goes_the_whole_way(tmp_path: Path) -> None:
    said, commands = Stubbed(tmp_path).run()
    (fitted,) = (words for words in commands if words[0] == "fit")
    assert fitted[-2:] == ["--split", "train"]
    assert not any("--strip" in words for words in commands)
    assert "holds out no pictures" in said
    assert commands[-1][0] == "reenact"


@pytest.mark.parametrize("split", ["val", "test"])
def test_what_is_held_out_is_what_judges(tmp_path: Path, split: str) -> None:
    stubbed, capture = Stubbed(tmp_path), tmp_path / "mine"
    capture.mkdir()
    for name in ("train", split):
        (capture / f"transforms_{name}.json").write_text('{"frames": [{"file_path": "a"}]}')
    _, commands = stubbed.run(CAPTURE=str(capture))
    (fitted,) = (words for words in commands if words[0] == "fit")
    assert fitted[-2:] == ["--split", split]
    assert any("--strip" in words for words in commands) == (split == "test")
    assert commands[-1][0].endswith("learning_table.py")


def test_the_avatars_say_whose_face_it_is(tmp_path: Path) -> None:
    stubbed = Stubbed(tmp_path)
    _, commands = stubbed.run("capture", "mesh", "train", "distill")
    for words in (words for words in commands if words[0] == "distill"):
        assert words[words.index("--name") + 1] == "learned"
    stated = {"name": "Ann B.", "author": "me", "licence": "CC0-1.0", "consent": "she said: yes"}
    _, commands = stubbed.run("mesh", "distill", **{key.upper(): value for key, value in stated.items()})
    distilled = [words for words in commands if words[0] == "distill"]
    assert len(distilled) == 2
    for words in distilled:
        assert {key: words[words.index(f"--{key}") + 1] for key in stated} == stated


def test_named_stages_are_done_anew_and_what_uses_them_afterwards(tmp_path: Path) -> None:
    stubbed = Stubbed(tmp_path)
    stubbed.run()
    stale, kept = stubbed.out / "run" / "stale", stubbed.out / "mesh.gem"
    stale.write_text("")
    kept.write_text("kept")
    _, commands = stubbed.run("train")
    assert [words[0] for words in commands] == ["train"]
    assert not stale.exists()
    assert (stubbed.out / "refined.gem").exists()
    said, commands = stubbed.run()
    assert [words[0] for words in commands if words[0] != "modes"] == [
        *("distill", "refine", "fit", "train-regressor", "reenact")
    ]
    assert "mesh: finished before" in said
    assert kept.read_text() == "kept"


def test_what_was_stopped_goes_on_though_it_is_named(tmp_path: Path) -> None:
    stubbed = Stubbed(tmp_path)
    stubbed.run("capture")
    begun = stubbed.out / "run" / "checkpoint.pt"
    begun.parent.mkdir()
    begun.write_text("")
    stubbed.run("train")
    assert begun.exists()


def test_a_capture_of_ones_own_is_never_removed(tmp_path: Path) -> None:
    stubbed, capture = Stubbed(tmp_path), tmp_path / "learned" / "capture"
    capture.mkdir(parents=True)
    (capture / "transforms_train.json").write_text('{"file_path": 0}')
    for _ in range(2):
        stubbed.run("capture", "mesh", CAPTURE=str(capture))
        assert (capture / "transforms_train.json").exists()


def test_the_table_of_a_capture_that_holds_out_nothing_is_refused(tmp_path: Path) -> None:
    capture, _ = write_capture(tmp_path / "capture", person(), train=2, test=0)
    words = [sys.executable, str(SCRIPT.parents[1] / "tests" / "bench" / "learning_table.py"), str(capture.folder)]
    words += [word for name in ("--mesh", "--run", "--distilled", "--refined") for word in (name, "x")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 2
    assert "holds out no pictures (val, test)" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.timeout(900)
def test_every_stage_and_each_alone(tmp_path: Path) -> None:
    """No command of it opens a socket, where that can be seen: the first one would be killed."""
    command = tmp_path / "gemheads"
    command.write_text(f"#!{sys.executable}\n{seal() if can_seal() else ''}{PROGRAM}")
    command.chmod(0o755)
    capture, _ = write_capture(tmp_path / "capture", person(), train=4, test=1, held_out=(2,))
    driver = str(capture.folder / "images" / "%05d_01.png")
    settings = {**os.environ, **SMALL, "GEMHEADS": str(command), "CAPTURE": str(capture.folder), "DRIVER": driver}

    def run(*stages: str) -> str:
        words = ["bash", str(SCRIPT), str(tmp_path / "learned"), *stages]
        done = subprocess.run(words, env=settings, capture_output=True, text=True, timeout=800, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    run()
    for name in PICTURES:
        assert (tmp_path / "learned" / f"{name}.png").stat().st_size > 1000, name
    assert (tmp_path / "learned" / "8_reenact.mp4").stat().st_size > 1000
    figures = json.loads((tmp_path / "learned" / "table.json").read_text())
    assert set(figures) == {"val", "test"}
    assert figures["test"]["GEM fitted"]["PSNR"] > 5  # the mesh of this capture is a sheet, the person is not
    before = (tmp_path / "learned" / "refined.gem").stat().st_mtime_ns
    assert "table: finished before" in run()
    told = run("distill")
    assert "distill: " in told
    assert "finished" not in told
    assert (tmp_path / "learned" / "refined.gem").stat().st_mtime_ns == before
