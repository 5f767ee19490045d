"""A browser of our own: Chromium with ANGLE on OpenGL, on a display that nobody sees."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from trouble import Trouble

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OPTIONS = (
    "--ozone-platform=x11",
    "--use-gl=angle",
    "--use-angle=gl",
    "--ignore-gpu-blocklist",
    "--force-device-scale-factor=1",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-extensions",
    # nothing but the page runs, and it runs at full pace though no one looks at it
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-background-timer-throttling",
    "--disable-backgrounding-occluded-windows",
    "--disable-renderer-backgrounding",
    "--disable-dev-shm-usage",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
)
SCREEN = "1280x1024x24"
END_SECONDS = 10


class Chromium:
    """A browser that shows one address until ``close``, with a profile that is thrown away."""

    def __init__(self, address: str, program: str) -> None:
        """``program``: see ``program_of``. Raises Trouble without a display and without Xvfb."""
        self.program = program
        self._profile = tempfile.TemporaryDirectory(prefix="peers-", ignore_cleanup_errors=True)
        self._display: subprocess.Popen[bytes] | None = None
        self._log = Path(self._profile.name) / "log.txt"
        try:
            environment = dict(os.environ, DISPLAY=os.environ.get("DISPLAY") or self._open_display())
            options = [*OPTIONS, f"--user-data-dir={self._profile.name}"]
            if hasattr(os, "geteuid") and os.geteuid() == 0:
                options.append("--no-sandbox")  # Chromium has none for root; it sees only our own pages
            with self._log.open("wb") as log:
                self._browser = subprocess.Popen(
                    [self.program, *options, address], env=environment, stdout=log, stderr=log
                )
        except BaseException:
            self._end(self._display)
            raise

    @property
    def version(self) -> str:
        """What the browser calls itself."""
        ran = subprocess.run([self.program, "--version"], capture_output=True, text=True, timeout=60)
        return ran.stdout.strip()

    def check(self) -> None:
        """Raises Trouble with the last words of a browser that ended."""
        if self._browser.poll() is not None:
            words = " ".join(self._log.read_text("utf-8", "replace").split()[-40:])
            raise Trouble(f"{self.program} ended by itself ({words}); see whether it starts by hand")

    def close(self) -> None:
        """End the browser and its display."""
        self._end(self._browser)
        self._end(self._display)
        self._profile.cleanup()

    def _open_display(self) -> str:
        xvfb = shutil.which("Xvfb")
        if xvfb is None:
            raise Trouble("there is no display and no Xvfb to make one; install it (Debian: apt-get install xvfb)")
        reading, writing = os.pipe()
        command = [xvfb, "-displayfd", str(writing), "-screen", "0", SCREEN, "-nolisten", "tcp"]
        silent = subprocess.DEVNULL
        self._display = subprocess.Popen(command, pass_fds=[writing], stdout=silent, stderr=silent)
        os.close(writing)
        with os.fdopen(reading) as said:
            number = said.readline().strip()  # comes when the display is ready, empty when Xvfb ended
        if not number:
            raise Trouble("Xvfb ended by itself; see whether `Xvfb :77` starts by hand")
        return f":{number}"

    @staticmethod
    def _end(process: subprocess.Popen[bytes] | None) -> None:
        if process is None:
            return
        process.terminate()
        try:
            process.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def program_of(wanted: str | None = None) -> str:
    """Where the browser is. Raises Trouble when there is none."""
    for name in (wanted,) if wanted else NAMES:
        if found := shutil.which(name):
            return found
    if wanted:
        raise Trouble(f"{wanted} is no program; give --chromium the path of one")
    raise Trouble(
        "no Chromium is here; install it (Debian: apt-get install chromium) or name a Chrome with --chromium PATH"
    )
