from fractions import Fraction

import pytest
from gemheads.app.errors import UsageError
from gemheads.app.person.neutrals import NeutralRule, read_rule
from gemheads.app.words import read_colour, read_rate, read_size


def test_colours() -> None:
    assert read_colour("#ff8000") == pytest.approx((1, 128 / 255, 0))
    assert read_colour("FF8000") == read_colour("#ff8000")
    assert read_colour("White") == (1, 1, 1)
    assert read_colour("transparent") is None


@pytest.mark.parametrize("text", ["", "#ff80", "mauvish", "#gg0000"])
def test_what_is_no_colour_is_told(text: str) -> None:
    with pytest.raises(UsageError, match="not a colour; use #rrggbb"):
        read_colour(text)


def test_sizes() -> None:
    assert read_size("640x480") == (640, 480)
    assert read_size("640X480") == (640, 480)


@pytest.mark.parametrize("text", ["640", "640x", "0x0", "641x480", "64000x64000", "-2x4", "8x8"])
def test_what_is_no_size_is_told(text: str) -> None:
    with pytest.raises(UsageError, match="512x512"):
        read_size(text)


def test_rates() -> None:
    assert read_rate("30000/1001") == Fraction(30000, 1001)
    assert read_rate("12.5") == Fraction(25, 2)
    assert read_rate("29.97002997002997") == Fraction(30000, 1001)
    for text in ("0", "-1", "fast", "1/0", "1e9", "1/100000000000"):
        with pytest.raises(UsageError, match="not a rate"):
            read_rate(text)


def test_neutral_rules() -> None:
    assert read_rule("auto") == NeutralRule("auto")
    assert read_rule("first") == NeutralRule("first")
    assert read_rule("frame=12") == NeutralRule("frame", "12")
    assert read_rule("time=1.5") == NeutralRule("time", "1.5")
    assert read_rule("image=a=b.png") == NeutralRule("image", "a=b.png")
    assert read_rule("profile=HD Camera: 720p") == NeutralRule("profile", "HD Camera: 720p")


@pytest.mark.parametrize(
    "text", ["", "autos", "auto=1", "frame", "frame=-1", "frame=1.5", "time=nan", "time=-1", "image=", "profile="]
)
def test_what_is_no_neutral_rule_is_told(text: str) -> None:
    with pytest.raises(UsageError, match="use auto, first, frame=N"):
        read_rule(text)
