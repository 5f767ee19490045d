"""The real window under Xvfb, driven by xdotool: keys, drop, resize, minimise, close."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

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
import sys, threading
from gemheads.app.desk import command, window
from gemheads.app.desk.session import Session

shown = window.DeskWindow.show
kept = {}

def show(self, picture, view):
    shown(self, picture, view)
    kept["desk"] = self
    state = view.state
    words = f"{view.on_stage} {state.used_components} {state.compare} {state.panels} {self.size} {self.visible}"
    words += f" {len(view.avatars)} {view.loading or '-'} {bool(view.toasts)} {view.health.source or '-'}"
    words += f" {state.ui_scale:.2f}"
    if words != kept.get("words"):
        kept["words"] = words
        print("STATE", words, flush=True)

window.DeskWindow.show = show

def listen():
    # glfw's own callback is called with what a file manager would drop
    for line in sys.stdin:
        kept["desk"].on_drop(None, [line.strip()])

threading.Thread(target=listen, daemon=True).start()
sys.exit(command.live_command(engine="software", size=(128, 128)))
"""


@dataclass
class Running:
    """The program, and what it said last."""

    process: subprocess.Popen[str]
    environment: dict[str, str]
    log: Path

    def state(self) -> str:
        lines = [line for line in self.log.read_text().splitlines() if line.startswith("STATE")]
        return lines[-1] if lines else ""

    def until(self, done: Callable[[str], bool]) -> str:
        """The first state of which this is true."""

        def there() -> str:
            assert self.process.poll() is None, self.log.read_text()[-2000:]
            state = self.state()
            return state if done(state) else ""

        return eventually(there, 30, self.state, in_words(done))

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
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x900x24", "+extension", "GLX", "-nolisten", "tcp"]
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


def word(state: str, index: int) -> str:
    return state.replace(", ", ",").split()[index + 1]


@driven
def test_the_window_answers_keys_drops_resizing_minimising_and_closes(
    running: Running, tiny: Path, tmp_path: Path
) -> None:
    """In a program that the first socket of the network would kill."""
    running.until(lambda state: bool(state) and word(state, 7) == "-" and word(state, 9) != "-")
    window = running.xdotool("search", "--name", "^gemheads$").splitlines()[0]
    running.key("Escape")
    running.key("b")
    running.until(lambda state: word(state, 2) == "True")
    before = int(word(running.state(), 1))
    running.key("minus")
    running.until(lambda state: int(word(state, 1)) == before - 5)
    running.key("Tab")
    running.until(lambda state: word(state, 3) == "False")
    count = int(word(running.state(), 6))
    running.drop(tiny)
    running.until(lambda state: int(word(state, 6)) == count + 1)
    broken = tmp_path / "broken.gem"
    broken.write_bytes(b"no avatar")
    running.drop(broken)
    running.until(lambda state: word(state, 8) == "True")
    assert int(word(running.state(), 6)) == count + 1
    running.xdotool("windowsize", window, "700", "500")
    running.until(lambda state: word(state, 4) == "(700,500)")
    running.xdotool("windowunmap", window)
    time.sleep(0.3)
    assert running.process.poll() is None
    running.xdotool("windowmap", "--sync", window)
    running.key("Tab")
    running.until(lambda state: word(state, 3) == "True")
    asked = time.perf_counter()
    running.key("ctrl+q")
    assert running.process.wait(timeout=10) == 0, running.log.read_text()[-2000:]
    seconds = time.perf_counter() - asked
    print(f"closed after {seconds:.2f} s")
    assert seconds < 3  # under a second on an idle machine; this one may be busy
    assert "tiny.gem" in (tmp_path / "home" / "config" / "gemheads" / "live.toml").read_text()


@driven
def test_ctrl_with_the_key_of_a_plus_and_keys_that_edit_a_path(running: Running) -> None:
    running.until(lambda state: bool(state) and word(state, 7) == "-" and word(state, 9) != "-")
    running.key("Escape")
    before = float(word(running.state(), -2))
    running.key("ctrl+minus")
    running.until(lambda state: float(word(state, -2)) < before)
    running.key("ctrl+plus")
    running.until(lambda state: float(word(state, -2)) == before)
    running.key("ctrl+o")
    time.sleep(0.5)
    source = word(running.state(), 9)
    running.key("ctrl+w", "ctrl+minus")  # no source, smaller text
    time.sleep(0.5)
    assert (word(running.state(), 9), float(word(running.state(), -2))) == (source, before)
    running.key("Escape")
    running.key("ctrl+minus")
    running.until(lambda state: float(word(state, -2)) < before)
    running.key("ctrl+q")
    assert running.process.wait(timeout=10) == 0


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
    command = [sys.executable, "-c", seal() + GREEN]
    done = subprocess.run(
        command, env={**os.environ, "DISPLAY": display}, timeout=60, check=True, capture_output=True, text=True
    )
    left, right = (int(value) for value in done.stdout.split())
    assert abs(left - CHROMA_GREEN[1]) <= 3
    assert right <= 3


@driven
def test_a_window_whose_edge_is_dragged_lives(running: Running) -> None:
    running.until(lambda state: bool(state) and word(state, 7) == "-")
    window = running.xdotool("search", "--name", "^gemheads$").splitlines()[0]
    steps = [*range(40), *range(40, 0, -1)]
    drag = [("windowsize", window, str(1280 - 12 * step), str(800 - 8 * step), "sleep", "0.016") for step in steps]
    running.xdotool(*(word for words in drag for word in words))
    running.xdotool("windowsize", window, "700", "500")
    running.until(lambda state: word(state, 4) == "(700,500)")
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
from gemheads.app.desk.state import DeskState
from gemheads.app.desk.view import DeskView
from gemheads.app.desk.window import TITLE, DeskWindow

if sys.argv[1] == "swapped":
    presenter.SOFTWARE = ()
desk, view = DeskWindow((640, 480)), DeskView(state=DeskState(welcome=False))
pictures = np.random.default_rng(0).integers(0, 255, (2, 64, 64, 3), np.uint8)

def show(seconds):
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        desk.poll(0.005)
        for picture in pictures:
            desk.show(picture, view)

show(0.3)
for path in sys.argv[2:]:
    width, height = (int(side) for side in path.split("/")[-1].split(".")[0].split("x"))
    glfw.set_window_size(desk._window, width, height)
    show(1.0)
    assert desk.size == (width, height), desk.size
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
