"""Which pictures judge, and through which others an expression is looked for."""

from pathlib import Path

import numpy as np
import pytest
from gemheads.models.captures.heldout import VIEWS, judged_shots, spread, viewers
from gemheads.models.captures.layout import Shot
from gemheads.render.camera import Camera

LENS = Camera(100, 100, 32, 32, 64, 64, np.eye(4))


class Footage:
    """As much of a capture as is asked for: which pictures it has."""

    def __init__(self, **splits: list[tuple[int, int]]) -> None:
        self._splits = {
            split: tuple(Shot(Path(f"{moment}_{camera}.png"), None, LENS, camera, moment) for moment, camera in pairs)
            for split, pairs in splits.items()
        }

    def shots(self, split: str) -> tuple[Shot, ...]:
        return self._splits.get(split, ())

    @property
    def train(self) -> tuple[Shot, ...]:
        return self.shots("train")


def grid(moments: range, cameras: range) -> list[tuple[int, int]]:
    return [(moment, camera) for moment in moments for camera in cameras]


@pytest.mark.parametrize("count", [5, 24, 64, 200])
def test_few_pictures_still_meet_every_camera_and_all_of_time(count: int) -> None:
    shots = judged_shots(Footage(test=grid(range(64), range(16))), "test", count)
    assert len(shots) == len({shot.picture for shot in shots}) == count
    cameras = [shot.camera_index for shot in shots]
    assert len(set(cameras)) == min(16, count)
    assert max(cameras) - min(cameras) > 8
    moments = [shot.timestep for shot in shots]
    assert moments == sorted(moments)
    assert min(moments) < 64 / count + 1
    assert max(moments) > 63 - 64 / count - 1


def test_as_many_as_are_asked_for_where_moments_have_few_cameras() -> None:
    uneven = [*grid(range(8), range(16)), *grid(range(8, 16), range(1))]
    assert len(judged_shots(Footage(test=uneven), "test", 24)) == 24


def test_all_means_all() -> None:
    footage = Footage(val=grid(range(9), range(2)))
    assert len(judged_shots(footage, "val", None)) == len(judged_shots(footage, "val", 99)) == 18
    assert judged_shots(footage, "test", None) == ()


@pytest.mark.parametrize("cameras", [2, 3, 5, 7, 8, 16])
def test_the_judged_picture_is_never_looked_at(cameras: int) -> None:
    footage = Footage(test=grid(range(2), range(cameras)))
    for shot in footage.shots("test"):
        seen = viewers(footage, "test", shot)
        assert shot.camera_index not in {other.camera_index for other in seen}
        assert {other.timestep for other in seen} == {shot.timestep}
        assert len(seen) == min(VIEWS, cameras - 1)


def test_two_sets_of_cameras_serve_a_moment() -> None:
    footage = Footage(test=grid(range(1), range(16)))
    sets = {tuple(other.camera_index for other in viewers(footage, "test", s)) for s in footage.shots("test")}
    assert len(sets) == 2


def test_a_held_out_camera_is_judged_through_training_pictures() -> None:
    footage = Footage(train=grid(range(3), range(5)), val=grid(range(3), range(5, 6)))
    (first, *_) = footage.shots("val")
    seen = viewers(footage, "val", first)
    assert len(seen) == VIEWS
    assert {id(shot) for shot in seen} <= {id(shot) for shot in footage.train}


def test_one_camera_alone_looks_at_itself() -> None:
    footage = Footage(test=grid(range(2), range(1)))
    (first, _) = footage.shots("test")
    assert viewers(footage, "test", first) == (first,)


def test_spread_takes_the_middles_of_equal_parts() -> None:
    assert spread(range(12)) == {1, 4, 7, 10}
    assert spread([3, 4]) == {3, 4}
