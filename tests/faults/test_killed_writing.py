"""kill -9 at any moment while a file is written over another: there is the one, or the other, and nothing between."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

if not hasattr(os, "fork"):
    pytest.skip("only POSIX can kill so", allow_module_level=True)

ROUNDS = 8
KILLER = """
import json, os, random, signal, sys, time
from pathlib import Path
from faults.writers import WRITTEN

folder, rounds, seed = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
rng = random.Random(seed)
found = {}
for written in WRITTEN:
    path = folder / written.name
    written.write(path, 0)
    began = time.perf_counter()
    written.write(path, 1)
    took = time.perf_counter() - began
    states = found[written.name] = []
    for _ in range(rounds):
        child = os.fork()
        if child == 0:
            for version in range(10_000):
                written.write(path, version % 2)
        time.sleep(rng.uniform(0, 4 * took))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        try:
            states.append(written.read(path))
        except Exception as error:
            states.append(f"{type(error).__name__}: {error}"[:200])
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[object]]:
    """Name -> what was there after each kill."""
    command = [sys.executable, "-c", KILLER, str(tmp_path_factory.mktemp("killed")), str(ROUNDS), "5"]
    places = (str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", ""))
    environment = {"PYTHONPATH": os.pathsep.join(filter(None, places)), "OPENBLAS_NUM_THREADS": "1", "PATH": ""}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.parametrize("name", ["a.gem", "a.track", "a.weights", "a.ply", "live.toml", "report.json", "sheet.png"])
def test_a_file_is_the_old_or_the_new_one(found: dict[str, list[object]], name: str) -> None:
    assert set(found[name]) <= {0, 1}
    assert len(found[name]) == ROUNDS


def test_a_neutral_is_the_old_or_the_new_one(found: dict[str, list[object]]) -> None:
    (name,) = (name for name in found if name.startswith("camera-"))
    assert set(found[name]) <= {0, 1}


def test_a_folder_of_pictures_is_whole_or_says_that_it_is_not(found: dict[str, list[object]]) -> None:
    """Written over an older one: its list goes first and comes last."""
    states = {state if isinstance(state, int) else state.split(":")[0] for state in found["pictures"]}
    assert states <= {0, 1, "FileNotFoundError"}
    assert "FileNotFoundError" in states  # or no kill ever hit
