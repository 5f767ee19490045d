"""Pieces of HTML that every section of the report is made of."""

from collections.abc import Sequence
from html import escape


def table(heads: Sequence[str], rows: Sequence[str]) -> str:
    """A table that scrolls where it is too wide; ``heads`` are plain words, ``rows`` are made by ``row``."""
    head = "".join(f"<th>{escape(word)}</th>" for word in heads)
    return f"<div class='wide'><table><tr>{head}</tr>{''.join(rows)}</table></div>"


def row(cells: Sequence[str]) -> str:
    """Cells are HTML already."""
    return f"<tr>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
