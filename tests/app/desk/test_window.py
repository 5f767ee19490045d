"""The real window under Xvfb, driven by xdotool: keys, drop, resize, minimise, close."""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gemheads.app.desk.offscreen import DeskOffscreen
from gemheads.app.desk.state import DeskState
from gemheads.app.desk.view import DeskView
from gemheads.app.senders.virtualcamera import CHROMA_GREEN
from refusals import refusal
from sealed import seal
from waiting import eventually, in_words

REASON = "needs Xvfb and xdotool (Debian: apt-get install xvfb xdotool)"
driven = pytest.mark.skipif(not (shutil.which("Xvfb") and shutil.which("xdotool")), reason=REASON)

PROGRAM = """
import json, sys, threading
from gemheads.app.desk import command, window
from gemheads.app.desk.session import Session
from gemheads.app.desk.wish import LiveWish

shown = window.DeskWindow.show
kept = {}

def show(self, picture, view):
    shown(self, picture, view)
    kept["desk"] = self
    state = view.state
    now = {
        "components": state.used_components, "compare": state.compare, "panels": state.panels, "size": self.size,
        "avatars": len(view.avatars), "loading": view.loading, "toasts": bool(view.toasts), "prompt": state.prompt,
        "source": view.health.source, "scale": round(state.ui_scale, 2),
    }
    kept["frames"] = kept.get("frames", 0) + 1
    if now != kept.get("now") or kept["frames"] % 10 == 0:
        kept["now"] = now
        print("STATE", json.dumps({**now, "frames": kept["frames"]}), flush=True)

window.DeskWindow.show = show

def listen():
    # glfw's own callback is called with what a file manager would drop
    for line in sys.stdin:
        kept["desk"].on_drop(None, [line.strip()])

threading.Thread(target=listen, daemon=True).start()
sys.exit(command.live_command(LiveWish(engine="software", size=(128, 128))))
"""


State = dict[str, Any]


@dataclass
class Running:
    """The program, and what it said last."""

    process: subprocess.Popen[str]
    environment: dict[str, str]
    log: Path

    def state(self) -> State:
        """What the window showed last; empty before it showed anything."""
        *_, last = ["{}\n", *(line for line in self.log.read_text().splitlines(True) if line.startswith("STATE"))]
        return json.loads(last.removeprefix("STATE")) if last.endswith("\n") else {}

    def until(self, done: Callable[[State], bool]) -> State:
        """The first state of which this is true."""

        def there() -> State:
            assert self.process.poll() is None, self.log.read_text()[-2000:]
            state = self.state()
            return state if state and done(state) else {}

        return eventually(there, 30, self.state, in_words(done))

    def begun(self) -> State:
        """The first state in which an avatar is on stage and a source is there."""
        return self.until(lambda state: not state["loading"] and state["source"])

    def xdotool(self, *words: str) -> str:
        done = subprocess.run(
            ["xdotool", *words], env=self.environment, capture_output=True, text=True, timeout=20, check=True
        )
        return done.stdout.strip()

    def key(self, *keys: str) -> None:
        self.xdotool("key", "--delay", "60", *keys)

    def drop(self, path: Path) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{path}\n")
        self.process.stdin.flush()


@pytest.fixture
def display() -> Iterator[str]:
    read, write = os.pipe()
    # -r: a key that a busy machine lets go late repeats nothing
    screen = ["-screen", "0", "1280x900x24", "+extension", "GLX", "-nolisten", "tcp", "-r"]
    command = ["Xvfb", "-displayfd", str(write), *screen]
    server = subprocess.Popen(command, pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(write)
    with os.fdopen(read) as numbers:
        number = numbers.readline().strip()
    if not number:
        pytest.skip("Xvfb did not start")
    yield f":{number}"
    server.terminate()
    server.wait()


@pytest.fixture
def running(display: str, tmp_path: Path, tiny: Path) -> Iterator[Running]:
    home = tmp_path / "home"
    environment = {
        **os.environ,
        "DISPLAY": display,
        "HOME": str(home),
        "XDG_CONFIG_HOME": str(home / "config"),
        "XDG_DATA_HOME": str(home / "data"),
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_WAIT_POLICY": "passive",
    }
    log = tmp_path / "log"
    with log.open("w") as out:
        command = [sys.executable, "-c", seal() + PROGRAM]
        process = subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=out, stderr=out, text=True)
        try:
            yield Running(process, environment, log)
        finally:
            process.kill()
            process.wait()
            if process.stdin is not None:
                process.stdin.close()


@driven
def test_the_window_answers_keys_drops_resizing_minimising_and_closes(
    running: Running, tiny: Path, tmp_path: Path
) -> None:
    """In a program that the first socket of the network would kill."""
    running.begun()
    window = running.xdotool("search", "--name", "^gemheads$").splitlines()[0]
    running.key("Escape")
    running.key("b")
    before = running.until(lambda state: state["compare"])["components"]
    running.key("minus")
    running.until(lambda state: state["components"] == before - 5)
    running.key("Tab")
    count = running.until(lambda state: not state["panels"])["avatars"]
    running.drop(tiny)
    running.until(lambda state: state["avatars"] == count + 1)
    broken = tmp_path / "broken.gem"
    broken.write_bytes(b"no avatar")
    running.drop(broken)
    assert running.until(lambda state: state["toasts"])["avatars"] == count + 1
    running.xdotool("windowsize", window, "700", "500")
    running.until(lambda state: state["size"] == [700, 500])
    running.xdotool("windowunmap", "--sync", window)
    unseen = running.state()["frames"]
    running.until(lambda state: state["frames"] >= unseen + 20)
    running.xdotool("windowmap", "--sync", window)
    running.key("Tab")
    running.until(lambda state: state["panels"])
    asked = time.perf_counter()
    running.key("ctrl+q")
    assert running.process.wait(timeout=10) == 0, running.log.read_text()[-2000:]
    seconds = time.perf_counter() - asked
    print(f"closed after {seconds:.2f} s")
    assert seconds < 3  # under a second on an idle machine; this one may be busy
    assert "tiny.gem" in (tmp_path / "home" / "config" / "gemheads" / "live.toml").read_text()


@driven
def test_ctrl_with_the_key_of_a_plus_and_keys_that_edit_a_path(running: Running) -> None:
    before = running.begun()["scale"]
    running.key("Escape")
    running.key("ctrl+minus")
    running.until(lambda state: state["scale"] < before)
    running.key("ctrl+plus")
    running.until(lambda state: state["scale"] == before)
    running.key("ctrl+o")
    source = running.until(lambda state: state["prompt"])["source"]
    running.key("ctrl+w", "ctrl+minus")  # no source, smaller text; what follows them is done after them
    running.key("Escape")
    after = running.until(lambda state: not state["prompt"])
    assert (after["source"], after["scale"]) == (source, before)
    running.key("ctrl+minus")
    assert running.until(lambda state: state["scale"] < before)["source"] == source
    running.key("ctrl+q")
    assert running.process.wait(timeout=10) == 0


@driven
def test_a_window_that_is_ended_from_outside_keeps_what_was_set(running: Running, tmp_path: Path) -> None:
    running.begun()
    running.process.terminate()
    assert running.process.wait(timeout=20) == 0, running.log.read_text()[-2000:]
    assert "mirror" in (tmp_path / "home" / "config" / "gemheads" / "live.toml").read_text()


def numbers_of(script: str, display: str) -> list[int]:
    """What a program of its own prints there."""
    environment = {**os.environ, "DISPLAY": display}
    command = [sys.executable, "-c", seal() + script]
    done = subprocess.run(command, env=environment, timeout=60, check=True, capture_output=True, text=True)
    return [int(value) for value in done.stdout.split()]


HUGE = """
from gemheads.app.desk.window import DeskWindow

desk = DeskWindow((16384, 16384))
print(*desk.size)
desk.close()
"""


@driven
def test_a_window_is_never_larger_than_the_screen(display: str) -> None:
    width, height = numbers_of(HUGE, display)
    assert width <= 1280
    assert height <= 900


GREEN = """
import numpy as np
from gemheads.app.bench.screen import XWindowReader
from gemheads.app.desk.cleanwindow import CleanWindow
from gemheads.app.desk.window import DeskWindow

desk = DeskWindow((640, 480))
clean = CleanWindow((64, 64), lambda window: None)
picture = np.zeros((64, 64, 4), np.uint8)
picture[:, 32:] = (200, 0, 0, 255)
for _ in range(20):
    desk.poll(0.02)
    clean.show(picture)
row = XWindowReader("gemheads clean").row(np.arange(64), 32)
print(row[8], row[56])
clean.close()
desk.close()
"""


@driven
def test_the_clean_window_is_green_where_nothing_is(display: str) -> None:
    left, right = numbers_of(GREEN, display)
    assert abs(left - CHROMA_GREEN[1]) <= 3
    assert right <= 3


@driven
def test_a_window_whose_edge_is_dragged_lives(running: Running) -> None:
    running.until(lambda state: not state["loading"])
    window = running.xdotool("search", "--name", "^gemheads$").splitlines()[0]
    steps = [*range(40), *range(40, 0, -1)]
    drag = [("windowsize", window, str(1280 - 12 * step), str(800 - 8 * step), "sleep", "0.016") for step in steps]
    running.xdotool(*(word for words in drag for word in words))
    running.xdotool("windowsize", window, "700", "500")
    running.until(lambda state: state["size"] == [700, 500])
    running.key("ctrl+q")
    assert running.process.wait(timeout=10) == 0, running.log.read_text()[-2000:]


MISSED = """
import ctypes
import glfw
from gemheads.app.desk.window import DeskWindow

desk = DeskWindow((640, 480))
library = ctypes.CDLL("libX11.so.6")
library.XMapWindow.argtypes, library.XSync.argtypes = [ctypes.c_void_p, ctypes.c_ulong], [ctypes.c_void_p, ctypes.c_int]
library.XMapWindow(glfw.get_x11_display(), 1)
library.XSync(glfw.get_x11_display(), 0)
desk.close()
"""


@driven
def test_what_the_x_server_refuses_does_not_end_the_program(display: str) -> None:
    """As it refuses a picture for a window that became smaller a moment ago."""
    command = [sys.executable, "-c", seal() + MISSED]
    subprocess.run(command, env={**os.environ, "DISPLAY": display}, timeout=60, check=True)


RESIZED = """
import sys, time
import glfw
import numpy as np
from gemheads.app.bench.screen import XWindowReader
from gemheads.app.desk import presenter
from gemheads.app.desk.screen import PANELS_EVERY
from gemheads.app.desk.state import DeskState
from gemheads.app.desk.view import DeskView
from gemheads.app.desk.window import TITLE, DeskWindow

if sys.argv[1] == "swapped":
    presenter.SOFTWARE = ()
desk, view = DeskWindow((640, 480)), DeskView(state=DeskState(welcome=False))
pictures = np.random.default_rng(0).integers(0, 255, (2, 64, 64, 3), np.uint8)

def show():
    desk.poll(0.005)
    for picture in pictures:
        desk.show(picture, view)

def settle(size):
    latest = time.perf_counter() + 20
    while desk.size != size:
        assert time.perf_counter() < latest, desk.size
        show()
    # imgui settles its windows in the first frames, and panels that nobody touches are drawn now and then
    begun = time.perf_counter()
    for _ in range(10):
        show()
    while time.perf_counter() - begun < 2 * PANELS_EVERY:
        show()

settle((640, 480))
for path in sys.argv[2:]:
    width, height = (int(side) for side in path.split("/")[-1].split(".")[0].split("x"))
    glfw.set_window_size(desk._window, width, height)
    settle((width, height))
    reader = XWindowReader(TITLE)
    rows = [reader.row(np.arange(width), row) for row in range(height)]
    np.save(path, np.stack(rows))
desk.close()
"""


@driven
@pytest.mark.parametrize("way", ["swapped", "copied"])
def test_a_window_of_another_size_shows_what_it_shows_when_it_is_opened_in_that_size(
    display: str, tmp_path: Path, way: str
) -> None:
    """Every pixel as the X server has it, whether buffers are swapped or only their changes are copied."""
    sizes = [(1000, 700), (520, 600), (1280, 900)]
    paths = [tmp_path / f"{width}x{height}.npy" for width, height in sizes]
    command = [sys.executable, "-c", seal() + RESIZED, way, *map(str, paths)]
    subprocess.run(command, env={**os.environ, "DISPLAY": display}, timeout=120, check=True)
    view = DeskView(state=DeskState(welcome=False))
    picture = np.random.default_rng(0).integers(0, 255, (2, 64, 64, 3), np.uint8)[1]
    for size, path in zip(sizes, paths, strict=True):
        desk = DeskOffscreen(size)
        for _ in range(3):  # imgui settles its windows in the first frames
            desk.show(picture, view)
        wanted = desk.pixels()[..., 1]
        desk.close()
        unlike = np.abs(np.load(path).astype(int) - wanted) > 3
        assert unlike.mean() < 0.002, f"{100 * unlike.mean():.1f} % of the pixels at {size}"


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="other systems always have a display")
def test_without_a_display_it_says_so_in_one_line(tmp_path: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    command = [sys.executable, "-m", "gemheads.app.cli", "live"]
    environment["XDG_CONFIG_HOME"] = str(tmp_path)
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 3
    assert refusal(done.stderr).startswith("error: gemheads live: ")
