"""The thread itself, with real time where only that tells: it closes from any state, and follows a real face."""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np
import pytest
from devices import Device
from faces import face
from gemheads.app.feed.capture import Capture, Tuning, glancing
from gemheads.app.feed.loop import Loop
from gemheads.app.files.frames import Frame
from gemheads.app.files.sources import open_source
from gemheads.app.inputs import CameraChoice, open_camera, open_input
from gemheads.app.inputs.source import Delivery
from gemheads.app.inputs.transport import Playhead
from gemheads.app.library import DEMO_CLIP, find_avatar
from gemheads.app.performing.casting import Avatar, open_avatar
from gemheads.app.performing.shots import Shot
from gemheads.models.driver.face import FaceTracker
from gemheads.models.driver.neutral import neutral_of
from waiting import SOON, eventually, in_words

from ..scripted import Clock, Person, Source, avatar, picture

FRAME = 1.01 / 30
"""Seconds from one frame of the demo clip to the next, and a little more."""


def next_shot(capture: Capture, fit: Callable[[Shot], bool] | None = None) -> Shot:
    def there() -> Shot | None:
        shot = capture.newest()
        return shot if shot is not None and (fit is None or fit(shot)) else None

    found = eventually(there, what="a shot" if fit is None else in_words(fit))
    assert found is not None
    return found


@dataclass
class Hanging(Source):
    """A source whose reading never ends by itself."""

    go_on: threading.Event = field(default_factory=threading.Event)
    reading: threading.Event = field(default_factory=threading.Event)
    """Set as soon as it hangs."""

    def read(self, timeout: float) -> Delivery | None:
        self.reading.set()
        self.go_on.wait(SOON)
        return None


class OneThenHanging(Hanging):
    """The same after one delivery."""

    def read(self, timeout: float) -> Delivery | None:
        return Source.read(self, timeout) if self.next is not None else super().read(timeout)


@pytest.fixture
def capture() -> Iterator[Capture]:
    person = Person(Clock(), face())
    with Capture(avatar(), lambda: person) as capture:
        yield capture


def close_in_time(capture: Capture) -> None:
    begun = time.perf_counter()
    capture.close()
    assert time.perf_counter() - begun < 1.0


def test_it_closes_without_a_source(capture: Capture) -> None:
    next_shot(capture)
    close_in_time(capture)
    assert not capture._thread.is_alive()


def test_it_closes_while_a_source_hangs_in_opening(capture: Capture) -> None:
    go_on = threading.Event()
    late = Source()

    def hang() -> Source:
        go_on.wait(SOON)
        return late

    capture.use(hang, "slow")
    eventually(lambda: capture.health.phase == "opening")
    next_shot(capture)  # the avatar lives on meanwhile
    close_in_time(capture)
    go_on.set()
    eventually(lambda: late.closed)


def test_it_closes_while_a_source_hangs_in_reading(capture: Capture) -> None:
    hanging = Hanging()
    capture.use(lambda: hanging, "hanging")
    assert hanging.reading.wait(SOON)
    close_in_time(capture)
    hanging.go_on.set()


def test_it_closes_while_a_camera_hangs_in_its_driver(capture: Capture) -> None:
    go_on = threading.Event()
    device = Device(lambda: go_on.wait(SOON) and None)
    choice = CameraChoice("Cam", 0)
    capture.use(open_camera(choice, connected=lambda: [choice], open_device=lambda _: device), "Cam")
    eventually(lambda: capture._loop.link is not None and capture._loop.link.source is not None)
    next_shot(capture)
    close_in_time(capture)
    go_on.set()
    assert device.released.wait(SOON)


def test_health_and_buttons_are_never_those_of_the_source_before(capture: Capture) -> None:
    before = OneThenHanging(name="before", transport=Playhead(10.0, 1 / 30))
    before.next = Frame(picture(), 0, Fraction(1, 30))
    capture.use(lambda: before, "before")
    eventually(lambda: capture.health.frames == 1)
    assert capture.transport is before.transport
    after = Source(name="what it says itself")
    capture.use(lambda: after, "after")
    health = capture.health  # while the capture thread still hangs in the one before
    assert (health.phase, health.source, health.frames) == ("opening", "after", 0)
    assert capture.transport is None
    before.go_on.set()
    eventually(lambda: capture.health.source == after.name)


def test_wishes_return_at_once_whatever_the_source_does(capture: Capture) -> None:
    hanging = Hanging()
    capture.use(lambda: hanging, "hanging")
    assert hanging.reading.wait(SOON)
    begun = time.perf_counter()
    capture.cast(avatar(1))
    capture.tune(Tuning(smoothing=0.1))
    capture.rest(neutral_of(face(), 0, 0.0, "taken"))
    capture.relock()
    capture.use(None)
    capture.newest()
    assert capture.health
    assert time.perf_counter() - begun < 1.0
    hanging.go_on.set()
    next_shot(capture, lambda shot: shot.avatar == "sha of 1")


def test_a_neutral_that_is_none_is_refused_at_once(capture: Capture) -> None:
    taken = neutral_of(face(), 0, 0.0, "taken")
    for wrong in (replace(taken, features=taken.features[:-1]), replace(taken, rotation=np.full(3, np.nan))):
        with pytest.raises(ValueError, match="no neutral"):
            capture.rest(wrong)
    capture.rest(taken)


def test_a_wish_that_fails_does_not_end_the_show(capture: Capture) -> None:
    capture._loop.ask(lambda: 1 / 0)  # pyright: ignore[reportArgumentType]
    eventually(lambda: "could not be done" in capture._loop._trouble[0])
    next_shot(capture)


def test_a_wish_that_changes_a_paused_video_is_seen_at_once(capture: Capture) -> None:
    capture.use(open_input(str(DEMO_CLIP)), "clip")
    eventually(lambda: capture.transport is not None and capture.health.neutral != "")
    assert capture.transport is not None
    capture.transport.pause()
    paused_at = capture.transport.position
    next_shot(capture, lambda shot: paused_at - shot.source_secs < FRAME)  # behind this one comes none by itself
    capture.rest(neutral_of(face(jaw=0.9), 0, 0.0, "another"))
    shot = next_shot(capture)
    assert shot.pose.phase.name == "TRACKING"
    assert "track" not in shot.stages, "a frame of the video came, too"


def test_a_real_face_drives_a_real_avatar_in_time() -> None:
    cast: Avatar = open_avatar(find_avatar())
    with Capture(cast) as capture:
        capture.use(open_input(str(DEMO_CLIP)), "clip")
        eventually(lambda: capture.health.neutral != "")
        shots: list[Shot] = []

        def enough() -> bool:
            shot = capture.newest()
            shots.extend([shot] if shot else [])
            return len(shots) >= 40

        eventually(enough)
        health = capture.health
    assert health.phase == "tracking"
    assert health.neutral
    assert health.rejected == 0
    moved = np.ptp([shot.pose.coefficients / cast.gem.sigma for shot in shots], axis=0)
    assert moved.max() > 0.5
    assert all(np.isfinite(shot.pose.coefficients).all() for shot in shots)
    assert {shot.avatar for shot in shots} == {cast.sha256}
    seen = shots[-1].observed
    assert seen is not None
    assert 0.3 < seen.luma < 0.9
    assert seen.picture_size == (512, 512)
    sketch = shots[-1].sketch
    assert sketch is not None
    assert 0.2 < float(np.median(sketch[:, 0])) < 0.8


def test_a_real_tracker_survives_everything_a_camera_may_send() -> None:
    clock, source = Clock(), Source()
    loop = Loop(avatar(), FaceTracker, clock, lambda _: None, lambda work: work())
    loop.use(lambda: source, "camera")
    rng = np.random.default_rng(0)
    images = [
        picture(1),
        rng.integers(0, 255, (48, 64, 3), dtype=np.uint8),
        np.zeros((16, 16, 3), np.uint8),
        np.zeros((2, 4000, 3), np.uint8),
        np.full((300, 16, 3), 255, np.uint8),
        rng.integers(0, 255, (480, 640, 3), dtype=np.uint8)[:, ::-1],
    ]
    for index, image in enumerate(images * 2):
        clock.now += 1 / 30
        source.next = Frame(image, index, Fraction(1, 30))
        loop.turn()
    assert loop.health.phase == "searching"
    assert loop.health.rejected == 2
    assert loop.health.frames == 10


def test_every_shot_wakes_the_window(capture: Capture) -> None:
    woken = threading.Event()
    capture.rouse(woken.set)
    assert woken.wait(SOON)
    assert capture.newest() is not None


def test_of_two_real_faces_the_locked_one_stays_until_the_other_is_asked_for() -> None:
    clock, source = Clock(), Source()
    loop = Loop(avatar(), FaceTracker, clock, lambda _: None, lambda work: work())
    loop.use(lambda: source, "camera")
    frames = [frame.rgb for frame, _ in zip(open_source(str(DEMO_CLIP)).frames(), range(24), strict=False)]

    def play() -> float:
        """The clip beside itself, a little later; returns where the followed face is, in widths of the picture."""
        sides = []
        for index, rgb in enumerate(frames[:20]):
            clock.now += 1 / 30
            both = np.hstack([rgb[::2, ::2], frames[index + 4][::2, ::2]])
            source.next = Frame(both, round(clock.now * 1000), Fraction(1, 1000))
            loop.turn()
            shot = loop.shots.take()
            assert shot is not None
            if index > 0:
                assert shot.sketch is not None
                sides.append(float(shot.sketch[:, 0].mean()))
        assert np.ptp(sides) < 0.1
        return sides[-1]

    first = play() > 0.5
    assert (play() > 0.5) == first
    assert "Somebody else" in " ".join(loop.health.hints)
    loop.acting.relock()
    assert (play() > 0.5) != first
    loop.acting.relock()
    assert (play() > 0.5) == first


def test_a_window_looks_once_at_a_face_that_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    still = next(open_source(str(DEMO_CLIP)).frames()).rgb
    looks: list[object] = []
    look = FaceTracker._look
    monkeypatch.setattr(FaceTracker, "_look", lambda *given: looks.append(given) or look(*given))
    counts: list[int] = []
    for tracker in (glancing(), FaceTracker()):
        tracker.track(still)
        looks.clear()
        assert tracker.track(np.roll(still, 8, 1)) is not None
        counts.append(len(looks))
    assert counts == [1, 2]
