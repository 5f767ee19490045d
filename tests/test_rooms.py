"""The house as docs/architecture.md tells it: every room with its sentence, and rooms that look only downwards."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
MAP = ROOT / "docs" / "architecture.md"


def rooms() -> list[tuple[str, str]]:
    """Folder and sentence of each row of the map, from the highest room to the lowest."""
    rows = [line.split("|") for line in MAP.read_text("utf-8").splitlines() if line.startswith("| `")]
    return [(cells[1].strip().strip("`").rstrip("/"), cells[2].strip()) for cells in rows]


def test_the_map_has_every_room_and_its_sentence() -> None:
    there = {}
    for layer in ("app", "models", "render"):
        for file in ROOT.glob(f"{layer}/**/__init__.py"):
            sentence = ast.get_docstring(ast.parse(file.read_text("utf-8"))) or ""
            there[file.parent.relative_to(ROOT).as_posix()] = sentence.replace("``", "`")
    assert dict(rooms()) == there


def imported(file: Path) -> Iterator[str]:
    """The rooms that a file names in relative imports, as folders from the root."""
    here = file.relative_to(ROOT).parent.parts
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = here[: len(here) - node.level + 1]
            named = (*base, *(node.module or "").split(".")) if node.module else base
            for parts in {named, *((*named, name.name) for name in node.names)}:
                if (ROOT.joinpath(*parts)).is_dir():
                    yield "/".join(parts)
                elif ROOT.joinpath(*parts).with_suffix(".py").is_file():
                    yield "/".join(parts[:-1])


@pytest.mark.parametrize("upstairs", [room for room, _ in rooms()])
def test_a_room_looks_only_into_those_below_it(upstairs: str) -> None:
    """Files beside the rooms (app/live.py, app/errors.py) are for all; import-linter holds the three layers apart."""
    order = [room for room, _ in rooms()]
    for_all = {"app", "models", "render", upstairs, upstairs.rpartition("/")[0]}
    seen = {to for file in (ROOT / upstairs).glob("*.py") for to in imported(file)} - for_all
    above = seen & set(order[: order.index(upstairs)])
    assert not above, f"{upstairs} stands below {above}"
