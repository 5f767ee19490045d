import os
import subprocess
import sys
from pathlib import Path

PROGRAM = """
from gemheads.models.driver.face import FaceTracker

FaceTracker()
"""


def test_a_tracker_leaves_nothing_in_the_home_folder(tmp_path: Path) -> None:
    """The inference library has telemetry of its own, which begins with a device id in the cache folder."""
    home = {name: str(tmp_path) for name in ("HOME", "USERPROFILE", "LOCALAPPDATA", "XDG_CACHE_HOME", "XDG_DATA_HOME")}
    clean = {name: value for name, value in os.environ.items() if name != "ORT_DISABLE_TELEMETRY"}
    subprocess.run([sys.executable, "-c", PROGRAM], env=clean | home, check=True, timeout=60)
    assert [str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()] == []
