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


@pytest.mark.timeout(900)
@pytest.mark.skipif(shutil.which("bash") is None, reason="the script is one for bash")
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
