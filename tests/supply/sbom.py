"""What is installed, as a CycloneDX 1.6 bill of materials: ``python -m tests.supply.sbom [EXTRA ...] > sbom.json``.

The same installation gives the same bytes: no time and no random number is in it.
"""

import json
import re
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

from .installed import Package, canonical, closure

ROOT = Path(__file__).resolve().parents[2]
LOCK = ROOT / ".ci" / "requirements.txt"


def bill(packages: dict[str, Package], hashes: dict[tuple[str, str], tuple[str, ...]]) -> dict[str, Any]:
    """The document; ``hashes``: (name, version) -> SHA-256 of each file of that release, where they are known."""
    version = metadata.version("gemheads")
    ours = {"type": "application", "name": "gemheads", "version": version, "bom-ref": f"pkg:pypi/gemheads@{version}"}
    direct = [canonical(name) for name in _direct() if canonical(name) in packages]
    edges = [{"ref": ours["bom-ref"], "dependsOn": sorted(_ref(packages[name]) for name in direct)}]
    for package in packages.values():
        known = sorted(_ref(packages[name]) for name in package.needs if name in packages)
        edges.append({"ref": _ref(package), "dependsOn": known})
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"component": {**ours, "licenses": [{"license": {"id": "Apache-2.0"}}]}},
        "components": [_component(package, hashes) for package in packages.values()],
        "dependencies": edges,
    }


def locked(text: str) -> dict[tuple[str, str], tuple[str, ...]]:
    """(name, version) -> hashes of a requirements file."""
    found = {}
    for name, version, rest in re.findall(r"^([\w.-]+)==(\S+)((?: \\\n\s+--hash=sha256:[0-9a-f]{64})+)", text, re.M):
        found[canonical(name), version] = tuple(re.findall(r"sha256:([0-9a-f]{64})", rest))
    return found


def _component(package: Package, hashes: dict[tuple[str, str], tuple[str, ...]]) -> dict[str, Any]:
    component: dict[str, Any] = {
        "type": "library",
        "name": package.name,
        "version": package.version,
        "bom-ref": _ref(package),
        "purl": _ref(package),
        "licenses": [{"license": {"name": package.licence or "not stated"}}],
    }
    if files := hashes.get((package.name, package.version)):
        # a release has one file for each system: they are listed as what it may be taken from
        component["externalReferences"] = [
            {"type": "distribution", "url": _ref(package), "hashes": [{"alg": "SHA-256", "content": each}]}
            for each in files
        ]
    if package.libraries:
        component["components"] = [{"type": "library", "name": library} for library in package.libraries]
    return component


def _ref(package: Package) -> str:
    return f"pkg:pypi/{package.name}@{package.version.replace('+', '%2B')}"


def _direct() -> list[str]:
    return [re.split(r"[^\w.-]", line, maxsplit=1)[0] for line in metadata.requires("gemheads") or ()]


def main() -> None:
    """The command."""
    hashes = locked(LOCK.read_text("utf-8")) if LOCK.is_file() else {}
    json.dump(bill(closure(frozenset(sys.argv[1:])), hashes), sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    main()
