"""What an installation consists of."""

import tomllib
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def test_every_package_is_installed_once() -> None:
    """An editable installation finds what the list forgets; a wheel would not."""
    listed = Counter(tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]["packages"])
    folders = {file.parent for layer in ("app", "assets", "models", "render") for file in ROOT.glob(f"{layer}/**/*.py")}
    there = {".".join(("gemheads", *folder.relative_to(ROOT).parts)) for folder in folders}
    assert set(listed) == there | {"gemheads"}
    assert max(listed.values()) == 1
    assert all((folder / "__init__.py").is_file() for folder in folders)
