"""A bench puts its table into a page without touching the prose around it."""

from pathlib import Path

import pytest

from .pages import MARKS, put_table


def test_what_is_between_the_marks_is_replaced(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(f"before\n{MARKS[0]}\nold\n{MARKS[1]}\nafter\n")
    put_table(page, "| new |")
    assert page.read_text() == f"before\n{MARKS[0]}\n| new |\n{MARKS[1]}\nafter\n"


@pytest.mark.parametrize("text", ["no marks", MARKS[0], " ".join((*MARKS, MARKS[1]))])
def test_a_page_without_the_place_is_left_alone(text: str, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(text)
    with pytest.raises(ValueError, match="needs one"):
        put_table(page, "| new |")
    assert page.read_text() == text
