from gemheads.app.inputs.attempt import Attempt
from gemheads.app.inputs.link import Link

from ..scripted import Clock, Source, World, unplugged


def test_drops_and_rejects_outlive_the_source() -> None:
    clock = Clock()
    sources = [Source(drops=3, rejected=1), Source(drops=4)]
    link = Link(lambda: sources.pop(0), "camera", clock, lambda _: None, lambda work: work())
    link.read(0)
    first = link.source
    assert isinstance(first, Source)
    first.lost = unplugged()
    link.read(0)
    clock.now += 1
    link.read(0)
    link.read(0)
    assert (link.drops, link.rejected) == (7, 1)


def test_a_source_that_was_well_for_a_while_is_sought_soon_again() -> None:
    world = World()
    for _ in range(3):
        world.play(3.0)
        world.opened.clear()
        world.source.lost = unplugged()
        gone = world.clock.now
        world.silence(0.1)
        world.source.lost = None
        world.play(1.0)
        assert 0.4 < world.opened[0] - gone < 0.7
        assert world.phase == "tracking"


def test_a_camera_that_freezes_again_and_again_is_left_more_and_more_alone() -> None:
    from ..scripted import picture

    world = World()
    frozen = picture(1)
    world.opened.clear()
    world.play(20.0, lambda: world.frame(frozen))
    waits = [after - before for before, after in zip(world.opened, world.opened[1:], strict=False)]
    assert waits == sorted(waits)
    assert len(world.opened) < 8


def test_a_camera_may_take_its_time_before_the_first_picture() -> None:
    world = World()
    world.silence(4.5)
    assert world.phase == "searching"
    world.silence(1.0)
    assert world.phase == "stalled"


def test_what_opens_after_everybody_left_is_closed() -> None:
    works, source = [], Source()
    attempt = Attempt(lambda: source, works.append)
    attempt.forget()
    works[0]()
    assert source.closed == 1
    done = Attempt(lambda: source, lambda work: work())
    done.forget()
    assert source.closed == 2
