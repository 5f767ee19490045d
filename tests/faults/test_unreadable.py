"""Files that this user may not read: each reader says so in its own error, and nothing else happens."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from refusals import refusal

if not hasattr(os, "getuid"):
    pytest.skip("permissions are those of POSIX", allow_module_level=True)

PROGRAM = """
import json, os, sys, tempfile
from pathlib import Path
from fuzz.formats import FORMATS
import gemheads.app.performing.weights, gemheads.models.importers.lam
try:
    import scipy
except ImportError:
    pass

said = {}
folder = Path(sys.argv[1])
paths = {}
for name, kind in FORMATS.items():
    place = folder / name
    place.mkdir()
    paths[name] = place / kind.name
    paths[name].write_bytes(kind.honest(place))
    kind.read(paths[name])  # what reading imports is loaded before the rights are given up
    paths[name].chmod(0)
if os.getuid() == 0:
    os.setuid(65534)
for name, kind in FORMATS.items():
    try:
        kind.read(paths[name])
        said[name] = ["read", ""]
    except kind.error as error:
        said[name] = ["refused", str(error)]
    except Exception as error:
        said[name] = [type(error).__name__, str(error)]
print(json.dumps(said))
"""
OTHERWISE = {"gem", "settings", "osc", "onnx"}
"""Formats whose reader in tests/fuzz does not raise, or that are no files."""


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """Format -> how reading it went, and the message."""
    folder = tmp_path_factory.mktemp("unreadable")
    for place in (folder, *folder.parents):
        if place.stat().st_uid == os.getuid() and place != Path("/tmp"):
            place.chmod(place.stat().st_mode | 0o055)  # the folders, but not the files, are open to the other user
    places = (str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", ""))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, places))}
    command = [sys.executable, "-c", PROGRAM, str(folder)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_every_reader_says_so(said: dict[str, list[str]]) -> None:
    for name, (how, message) in said.items():
        if name not in OTHERWISE:
            assert how == "refused", (name, how, message)
            assert "ermission denied" in message, (name, message)
    assert len(said) > 10


def test_settings_that_cannot_be_read_are_no_reason_to_stop(said: dict[str, list[str]]) -> None:
    assert said["settings"][0] == "read"


FORBIDDEN = """
import os, sys
from gemheads.app.cli import main

ASKED = (
    ["info", "{}/a.gem"],
    ["verify", "{}/a.mp4"],
    ["track", "{}/a.mp4", "-o", "t"],
    ["modes", "mara", "-o", "{}/m.png"],
)
for words in ASKED:
    main([word.format(sys.argv[2]) for word in words])  # what it imports is loaded before the rights are given up
print("now", file=sys.stderr)
if os.getuid() == 0:
    os.setuid(65534)
for words in ASKED:
    print("code", int(main([word.format(sys.argv[1]) for word in words])))
"""


def test_a_folder_that_may_not_be_entered_is_told_in_one_line(tmp_path: Path) -> None:
    for place in (tmp_path, *tmp_path.parents):
        if place.stat().st_uid == os.getuid() and place != Path("/tmp"):
            place.chmod(place.stat().st_mode | 0o055)
    locked = tmp_path / "locked"
    locked.mkdir(mode=0)
    command = [sys.executable, "-c", FORBIDDEN, str(locked), str(tmp_path / "open")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert [line for line in done.stdout.splitlines() if line.startswith("code")] == 4 * ["code 3"], done.stderr
    lines = done.stderr.partition("now\n")[2].splitlines()
    assert len(lines) == 4
    for line in lines:
        assert refusal(f"{line}\n").startswith(f"error: {locked}")
        assert line.endswith("cannot be opened (Permission denied); check the path and its permissions")
