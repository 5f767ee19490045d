"""Which part of a picture is looked at."""

import numpy as np
import pytest
from gemheads.app.errors import UsageError
from gemheads.app.files.crop import WHOLE, Crop, read_crop

PICTURE = np.arange(10 * 20 * 3, dtype=np.uint8).reshape(10, 20, 3)


@pytest.mark.parametrize(
    ("word", "rows", "columns"),
    [
        ("whole", slice(0, 10), slice(0, 20)),
        ("left", slice(0, 10), slice(0, 10)),
        (" Right", slice(0, 10), slice(10, 20)),
        ("25, 10, 50, 80.0", slice(1, 9), slice(5, 15)),
        ("0,0,100,100", slice(0, 10), slice(0, 20)),
    ],
)
def test_a_part_is_named_or_given_in_percent(word: str, rows: slice, columns: slice) -> None:
    part = read_crop(word).of(PICTURE)
    np.testing.assert_array_equal(part, PICTURE[rows, columns])
    assert part.flags.c_contiguous


def test_it_is_told_as_it_is_typed() -> None:
    assert [str(read_crop(word)) for word in ("whole", "left", "30,12.5,40,50")] == [
        "whole",
        "0,0,50,100",
        "30,12.5,40,50",
    ]
    assert str(Crop()) == str(WHOLE)


@pytest.mark.parametrize("word", ["", "middle", "10,10,20", "-5,0,20,20", "1,2,3,4,5", "nan,0,1,1"])
def test_what_is_no_part_is_refused_with_the_cure(word: str) -> None:
    with pytest.raises(UsageError, match="use left, right, or X,Y,WIDTH,HEIGHT in percent"):
        read_crop(word)


@pytest.mark.parametrize("word", ["60,0,50,100", "0,60,100,50", "0,0,0,100", "0,0,100,0"])
def test_what_lies_beyond_the_picture_is_refused(word: str) -> None:
    with pytest.raises(UsageError, match="at most 100 percent"):
        read_crop(word)
