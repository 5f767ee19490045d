"""The viewers from npm, at exact versions, in a cache folder outside the repository."""

import json
import shutil
import subprocess
from pathlib import Path

from trouble import Trouble

PINNED = {
    "@mkkellogg/gaussian-splats-3d": "0.4.7",
    "@sparkjsdev/spark": "2.2.0",
    "three": "0.180.0",  # the oldest that Spark takes, the nearest to what GaussianSplats3D was made for
    "fflate": "0.8.3",
}
INSTALL_SECONDS = 600


def installed(cache: Path) -> Path:
    """The ``node_modules`` folder with PINNED in it; says what it fetches when something is missing.

    Raises Trouble without npm, or when it fails.
    """
    modules = cache / "node_modules"
    if all(_version(modules / name) == version for name, version in PINNED.items()):
        return modules
    npm = shutil.which("npm")
    if npm is None:
        raise Trouble("npm, which fetches the viewers, is not here; install Node.js (Debian: apt-get install npm)")
    wanted = [f"{name}@{version}" for name, version in PINNED.items()]
    print(f"fetching into {cache} by npm: {', '.join(wanted)}", flush=True)
    cache.mkdir(parents=True, exist_ok=True)
    (cache / "package.json").write_text('{"private": true}\n', "utf-8")
    options = ["--ignore-scripts", "--no-audit", "--no-fund", "--save-exact", "--no-package-lock"]
    try:
        ran = subprocess.run(
            [npm, "install", *options, *wanted], cwd=cache, capture_output=True, text=True, timeout=INSTALL_SECONDS
        )
    except subprocess.TimeoutExpired:
        raise Trouble(f"npm did not finish within {INSTALL_SECONDS} s; check the network and run again") from None
    if ran.returncode:
        lines = [line for line in ran.stderr.splitlines() if "warn" not in line]
        raise Trouble(f"npm could not fetch {', '.join(wanted)} ({' '.join(lines)[:300]}); check the network")
    return modules


def _version(folder: Path) -> str | None:
    try:
        return json.loads((folder / "package.json").read_text("utf-8"))["version"]
    except (OSError, ValueError, KeyError):
        return None
