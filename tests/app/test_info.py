"""What ``gemheads info`` says."""

from dataclasses import replace
from pathlib import Path

import pytest
from gemheads.app.errors import InputError
from gemheads.app.info import describe
from gemheads.models.gem import Gem
from gemheads.models.gemfile import save_gem


def told(gem: Gem, folder: Path) -> dict[str, str]:
    """Label -> text of the lines about an avatar."""
    save_gem(gem, folder / "a.gem")
    return {line[:12].strip(): line[13:] for line in describe(folder / "a.gem").splitlines()}


def test_it_tells_what_is_in_the_file(tiny_gem: Gem, tmp_path: Path) -> None:
    lines = told(tiny_gem, tmp_path)
    assert lines["Name"] == "Tiny"
    assert lines["Licence"] == "CC0-1.0"
    assert lines["Consent"] == "not a person"
    assert lines["Splats"].startswith("6, UV map of 16")
    assert lines["Position"] == "3 components, 4 splats move (67%), 3 numbers each"
    assert lines["Opacity"] == "does not move"
    assert lines["Driven by"] == "52 ARKit weights and 7 coefficients"
    assert len(lines["SHA-256"].split()[0]) == 64


def test_a_regressor_is_named(tiny_gem: Gem, tmp_path: Path) -> None:
    assert told(replace(tiny_gem, regressor=b"graph"), tmp_path)["Driven by"].startswith("its regressor and ")


@pytest.mark.parametrize("about", [{}, {"consent": "", "licence": "  "}])
def test_a_missing_consent_or_licence_is_said(tiny_gem: Gem, tmp_path: Path, about: dict[str, str]) -> None:
    lines = told(replace(tiny_gem, about=about), tmp_path)
    assert lines["Licence"] == "not stated"
    assert lines["Consent"].startswith("no consent recorded: ")


def test_texts_cannot_steer_the_terminal(tiny_gem: Gem, tmp_path: Path) -> None:
    save_gem(replace(tiny_gem, name="\x1b[2J\nConsent      given\r", about={"x\x07": "y" * 5000}), tmp_path / "a.gem")
    text = describe(tmp_path / "a.gem")
    assert "\x1b" not in text
    assert "\x07" not in text
    assert sum(line.startswith("Consent ") for line in text.splitlines()) == 1
    assert max(map(len, text.splitlines())) < 800


def test_a_damaged_file_is_not_called_sound(tiny_gem: Gem, tmp_path: Path) -> None:
    path = tmp_path / "a.gem"
    save_gem(tiny_gem, path)
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError, match="checksum"):
        describe(path)


def test_no_file_is_one_plain_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="check the path"):
        describe(tmp_path / "nobody.gem")
