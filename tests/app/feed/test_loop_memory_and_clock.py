"""Memory runs out in a stage of the loop, and clocks jump: it is told, and the avatar lives on."""

import numpy as np
import pytest

from ..scripted import World, followed


@pytest.fixture
def world() -> World:
    return followed()


def test_a_tracker_without_memory_costs_pictures_and_nothing_else(world: World) -> None:
    world.person.broken = MemoryError("cannot allocate")
    shots = world.play(2.0)
    assert len(shots) > 30
    assert "cannot allocate" in world.loop.health.message
    world.person.broken = None
    world.play(1.0)
    assert (world.phase, world.loop.health.message) == ("tracking", "")


@pytest.mark.parametrize("jump", [3600.0, 86400.0, 0.9])
def test_a_computer_that_slept_goes_on(world: World, jump: float) -> None:
    world.clock.now += jump
    shots = world.play(3.0)
    assert world.phase == "tracking"
    assert len(shots) > 60
    assert np.isfinite([shot.pose.coefficients for shot in shots]).all()


def test_a_clock_that_goes_back_stops_nothing(world: World) -> None:
    """No monotonic clock should; on some machines they have."""
    world.clock.now -= 30.0
    world.play(35.0)
    shots = world.play(2.0)
    assert world.phase == "tracking"
    assert len(shots) > 40
    assert np.isfinite([shot.pose.coefficients for shot in shots]).all()
