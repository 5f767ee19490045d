"""What was done is taken again for the same alone, and only whole."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models.crossing.clip import Clip
from gemheads.models.crossing.kept import Kept


def same(one: Clip, other: Clip) -> None:
    for name in ("times", "others"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    for name in ("features", "rotations", "landmarks", "embeddings"):
        np.testing.assert_array_equal(getattr(one.readings, name), getattr(other.readings, name))
    np.testing.assert_array_equal(one.neutral.features, other.neutral.features)
    np.testing.assert_array_equal(one.pictures[4], other.pictures[4])
    assert (one.reason, one.lost, one.neutral_time) == (other.reason, other.lost, other.neutral_time)
    assert isinstance(other.lost, int)


def test_a_record_comes_back_as_it_was(clip: Clip, tmp_path: Path) -> None:
    kept = Kept(tmp_path / "deep" / "down")
    same(clip, kept.get("clip", ["a", 3, 1.5], Clip, lambda: clip))
    same(clip, kept.get("clip", ["a", 3, 1.5], Clip, lambda: pytest.fail("made again")))


def test_anything_else_is_made_anew(clip: Clip, tmp_path: Path) -> None:
    kept = Kept(tmp_path)
    made: list[int] = []

    def make() -> Clip:
        made.append(1)
        return clip

    for parts in (["a", 3], ["a", 4], ["b", 3], ["a", 3]):
        kept.get("clip", parts, Clip, make)
    assert len(made) == 3
    (one, *_) = sorted(tmp_path.iterdir())
    for damage in (b"", b"{}", one.read_bytes()[:-1], one.read_bytes()[:40], b"\xff" * 200):
        one.write_bytes(damage)
        made.clear()
        for parts in (["a", 3], ["a", 4], ["b", 3]):
            kept.get("clip", parts, Clip, make)
        assert len(made) == 1


def test_a_file_of_another_key_under_the_right_name_is_not_taken(clip: Clip, tmp_path: Path) -> None:
    kept = Kept(tmp_path)
    kept.get("clip", ["a"], Clip, lambda: clip)
    (first,) = tmp_path.iterdir()
    kept.get("clip", ["b"], Clip, lambda: clip)
    (second,) = (path for path in tmp_path.iterdir() if path != first)
    second.write_bytes(first.read_bytes())
    made: list[int] = []
    kept.get("clip", ["b"], Clip, lambda: made.append(1) or clip)
    assert made


def test_what_is_stopped_while_it_is_made_leaves_nothing(tmp_path: Path) -> None:
    def stopped() -> Clip:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Kept(tmp_path).get("clip", ["a"], Clip, stopped)
    assert not list(tmp_path.iterdir())
