"""The picture of the window and its outputs: on which cores it is drawn."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numba
import numpy as np
import pytest
from gemheads.app.desk import onstage
from gemheads.app.desk.painter import Painter
from gemheads.app.desk.state import DeskState
from gemheads.app.library import find_avatar
from gemheads.app.performing.casting import Avatar
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.timing import Stopwatch
from gemheads.models import blend, posing
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.render import compositing
from gemheads.render.camera import Camera
from gemheads.render.gaussians import RawGaussians
from gemheads.render.software import SoftwareEngine
from gems import ball


class Watched(SoftwareEngine):
    """Keeps on how many threads it was asked to draw."""

    def draw(self, raw: RawGaussians, camera: Camera) -> np.ndarray:
        self.threads = numba.get_num_threads()
        return super().draw(raw, camera)


@contextmanager
def cores(count: int) -> Iterator[None]:
    before = numba.get_num_threads()
    if count > before:
        pytest.skip(f"needs {count} cores, there are {before}")
    numba.set_num_threads(count)
    try:
        yield
    finally:
        numba.set_num_threads(before)


@pytest.mark.parametrize("count", [1, 2])
def test_drawing_takes_all_cores_and_composing_one(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    gem = load_gem(find_avatar("mara"))
    composed, sound = [], Gem.compose

    def compose(self: Gem, *args: object, **named: object) -> RawGaussians:
        composed.append(numba.get_num_threads())
        return sound(self, *args, **named)  # type: ignore[arg-type]

    pose = Pose(gem.rest_coefficients, np.zeros(3, np.float32))
    with cores(count):
        engine = Watched()
        painter = Painter(engine, (64, 64), Stopwatch())
        painter.picture(gem, pose, DeskState(), gem.components)  # what a stage holds is made with its first picture
        monkeypatch.setattr(Gem, "compose", compose)
        painter.picture(gem, pose, DeskState(), gem.components)
        assert numba.get_num_threads() == count
    assert (engine.threads, composed) == (count, [1])
    assert engine.description == f"numba tiles on {count} thread" + "s" * (count > 1)


def test_all_that_an_avatar_needs_is_compiled_before_anybody_has_to_wait_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """While its kernels run, whichever way its splats are stored, nobody may draw."""
    kernels = (
        blend.blend,
        blend.blend_columns,
        blend.moving_columns,
        blend.gather,
        posing.pose_splats,
        compositing._over,
    )
    counts: list[int] = []

    @contextmanager
    def watched() -> Iterator[None]:
        counts.append(sum(len(kernel.signatures) for kernel in kernels))
        yield
        counts.append(sum(len(kernel.signatures) for kernel in kernels))

    for gem in (load_gem(find_avatar("mara")), ball()):
        monkeypatch.setattr(onstage, "KERNELS", watched())
        onstage.compiled(Avatar(gem, Path("a.gem"), "sha"), lambda: None)
    assert counts[0] >= len(kernels)
    assert len(set(counts)) == 1
