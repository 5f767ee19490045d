"""Pages of docs/ whose table a bench prints: what is between two marks is replaced, the prose around it stays."""

from pathlib import Path

from gemheads.models.wholefile import write_whole

MARKS = "<!-- table -->", "<!-- end of table -->"
DOCS_HELP = f"a page in which what is between {' and '.join(MARKS)} is replaced"
"""Of the option ``--docs``."""


def put_table(page: Path, table: str) -> None:
    """Raises ValueError where the page has no such place, OSError."""
    text = page.read_text("utf-8")
    if any(text.count(mark) != 1 for mark in MARKS):
        raise ValueError(f"{page} needs one {MARKS[0]} and one {MARKS[1]}")
    before, after = text.split(MARKS[0])[0], text.split(MARKS[1])[1]
    write_whole(page, [f"{before}{MARKS[0]}\n{table}\n{MARKS[1]}{after}".encode()])
