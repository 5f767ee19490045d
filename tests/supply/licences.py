"""Report of the licences of everything that gemheads installs: ``python -m tests.supply.licences [EXTRA ...]``.

Exits with 1 when a package of the base installation is under a licence that does not go with Apache-2.0.
"""

import re
import sys
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError

from .installed import Package, closure

FREE = re.compile(
    r"\b(apache|bsd|0bsd|mit|mit-cmu|hpnd|isc|zlib|cc0|unlicense|public domain|psf|python software foundation"
    r"|boost|ncsa|mpl|mozilla public|freely distributable|unencumbered)",
    re.IGNORECASE,
)
"""Permissive, or (MPL) asking something only of who changes its own files."""
UNFREE = re.compile(
    r"\b(a?gpl|gnu (affero )?general|lgpl|gnu lesser|sspl|busl|non-?commercial|cc-by-(nc|nd)|proprietary)", re.I
)
COPYLEFT_LIBRARIES = {"libx264": "GPL-2.0-or-later", "libx265": "GPL-2.0-or-later"}
"""Native libraries under the GPL that wheels are known to bring along."""
KNOWN = {("av", "libx264"), ("av", "libx265")}
"""(package, library) of those that are there, and told in SECURITY.md."""


def complaints(packages: Mapping[str, Package]) -> list[str]:
    """What does not go with the base installation, one sentence each."""
    found = []
    for package in packages.values():
        if not package.licence:
            found.append(f"{package.name} {package.version} does not say under which licence it is")
        elif UNFREE.search(package.licence) and not re.search(r"\bOR\b", package.licence):
            found.append(f"{package.name} {package.version} is under {package.licence}")
        elif not FREE.search(package.licence):
            found.append(f"{package.name} {package.version} is under {package.licence}, which nobody has judged yet")
        for library in package.libraries:
            if library in COPYLEFT_LIBRARIES and (package.name, library) not in KNOWN:
                found.append(f"{package.name} {package.version} brings {library} ({COPYLEFT_LIBRARIES[library]})")
    return found


def main() -> int:
    """The command; returns its exit code."""
    try:
        base, packages = closure(), closure(frozenset(sys.argv[1:]))
    except PackageNotFoundError as error:
        print(f"error: {error.name} is not installed here; install the extras that are to be judged", file=sys.stderr)
        return 2
    for name, package in packages.items():
        brings = [f"{each} ({COPYLEFT_LIBRARIES[each]})" for each in package.libraries if each in COPYLEFT_LIBRARIES]
        extra = "" if name in base else "  [extra]"
        told = f"  brings {', '.join(brings)}" if brings else ""
        print(f"{name:34} {package.version:14} {package.licence or 'not stated'}{extra}{told}")
    wrong = complaints(base)
    for sentence in wrong:
        print(f"error: {sentence}", file=sys.stderr)
    print(f"{len(packages)} packages, {len(base)} of them in the base installation; {len(wrong)} do not fit")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
