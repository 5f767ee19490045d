"""The packages that an installation brings, as they say about themselves; nothing is asked of a network."""

import re
from dataclasses import dataclass
from importlib import metadata
from pathlib import PurePosixPath

from packaging.requirements import Requirement


@dataclass(frozen=True)
class Package:
    """One installed distribution."""

    name: str
    version: str
    licence: str
    """An SPDX expression where it gives one, else its words; empty where it says nothing."""
    libraries: tuple[str, ...]
    """Names of the native libraries that its wheel brings along, such as libx264."""
    needs: tuple[str, ...]
    """Names of the packages that it needs here."""


def closure(extras: frozenset[str] = frozenset(), root: str = "gemheads") -> dict[str, Package]:
    """Name -> package, of all that ``root`` with these extras needs on this machine, without itself.

    Raises PackageNotFoundError when something that is needed is not installed.
    """
    found: dict[str, Package] = {}
    waiting = _needed(root, extras)
    while waiting:
        name, wanted = waiting.pop()
        more = _needed(name, wanted)
        if name not in found:
            found[name] = _package(name, tuple(sorted({need for need, _ in more})))
            waiting += more
    return dict(sorted(found.items()))


def canonical(name: str) -> str:
    """A distribution's name as indexes write it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _needed(name: str, extras: frozenset[str]) -> list[tuple[str, frozenset[str]]]:
    """(name, extras) of what a package needs on this machine."""
    needs = []
    for line in metadata.requires(name) or ():
        wanted = Requirement(line)
        if wanted.marker is None or any(wanted.marker.evaluate({"extra": extra}) for extra in extras | {""}):
            needs.append((canonical(wanted.name), frozenset(wanted.extras)))
    return needs


def _package(name: str, needs: tuple[str, ...]) -> Package:
    about = metadata.metadata(name)
    return Package(name, metadata.version(name), _licence(about), _libraries(name), needs)


def _licence(about: metadata.PackageMetadata) -> str:
    words = (about.get("License-Expression") or "").strip()
    prefix = "License :: "
    classes = [line.removeprefix(prefix) for line in about.get_all("Classifier") or () if line.startswith(prefix)]
    exact = [line.rsplit(" :: ", 1)[-1] for line in classes if " :: " in line]
    text = (about.get("License") or "").strip()
    return words or " AND ".join(exact) or text.split("\n")[0][:80]


def _libraries(name: str) -> tuple[str, ...]:
    """Shared libraries inside the wheel: the tools that put them there each have a folder for them."""
    names = set()
    for file in metadata.files(name) or ():
        path = PurePosixPath(str(file))
        if any(part.endswith(".libs") or part == ".dylibs" for part in path.parts[:-1]):
            names.add(re.split(r"[-.]", path.name, maxsplit=1)[0])
    return tuple(sorted(names))
