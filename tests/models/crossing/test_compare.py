"""The loop, and what is made of a driver beside an avatar."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gemheads.models.crossing import pace
from gemheads.models.crossing.channels import CHANNELS, correlations, moving, table, unrests
from gemheads.models.crossing.clip import Clip
from gemheads.models.crossing.compare import WORST, WORST_APART_SECS, compare, worst_frames
from gemheads.models.crossing.loop import echo
from gemheads.models.crossing.mirror import UnseenAvatar
from gemheads.models.driver.answer import Answer, Express
from numpy.typing import NDArray
from pixelface import painted

from .conftest import PaintedMirror

NAMES = [channel.name for channel in CHANNELS]
JAW, SMILE, PUCKER, YAW = (NAMES.index(name) for name in ("jawOpen", "mouthSmile", "mouthPucker", "yaw"))


def test_what_is_copied_correlates_and_what_is_still_is_not_judged(
    clip: Clip, mirror: PaintedMirror, express: Express
) -> None:
    found = compare(clip, echo(clip, express, mirror))
    for channel in (JAW, SMILE, YAW):
        assert found.likeness.correlation[channel] > 0.99
    assert found.likeness.amplitude[SMILE] == pytest.approx(1, abs=0.05)
    assert np.isnan(found.likeness.correlation[PUCKER])
    assert found.unseen == 0
    assert found.agreement is not None
    assert found.agreement.cosine > found.agreement.chance + 0.1


def test_what_is_not_followed_is_found_and_shown(clip: Clip, mirror: PaintedMirror, express: Express) -> None:
    def stubborn(relative: NDArray[np.floating], rotation: NDArray[np.floating]) -> Answer:
        answer = express(relative, rotation)
        answer.coefficients[0] = 0.0
        return answer

    found = compare(clip, echo(clip, stubborn, mirror))
    assert found.likeness.correlation[JAW] == 0
    assert found.likeness.correlation[SMILE] > 0.99
    assert found.worst[0].channel == "jawOpen"
    assert abs(found.worst[0].driver) > 1.5
    assert found.worst[0].avatar == 0


def test_movement_of_its_own_is_among_the_worst(clip: Clip, mirror: PaintedMirror, express: Express) -> None:
    still = replace(clip, readings=clip.readings.only(np.zeros(50, int)))
    answers = iter(np.linspace(0, 1, 50))

    def restless(relative: NDArray[np.floating], rotation: NDArray[np.floating]) -> Answer:
        answer = express(relative, rotation)
        answer.coefficients[1] = next(answers)
        return answer

    found = compare(still, echo(still, restless, mirror))
    assert np.isnan(found.likeness.correlation[SMILE])
    assert found.worst[0].channel == "mouthSmile"
    assert found.worst[0].driver == pytest.approx(0, abs=1e-6)
    assert abs(found.worst[0].avatar) > 3


def test_frames_in_which_the_avatar_is_not_seen_come_first(clip: Clip, mirror: PaintedMirror, express: Express) -> None:
    mirror.hidden = {1 + 20, 1 + 40}  # the first picture is the neutral
    shown = echo(clip, express, mirror)
    assert np.flatnonzero(~shown.seen).tolist() == [20, 40]
    assert len(shown.readings) == 48
    found = compare(clip, shown)
    assert found.unseen == 2
    assert [(worst.frame, worst.channel) for worst in found.worst[:2]] == [(20, None), (40, None)]
    assert found.likeness.correlation[SMILE] > 0.99
    assert len(found.times) == 48


def test_an_avatar_that_is_hardly_ever_seen_follows_nothing(
    clip: Clip, mirror: PaintedMirror, express: Express
) -> None:
    mirror.hidden = set(range(2, 60))
    found = compare(clip, echo(clip, express, mirror))
    assert found.agreement is None
    assert found.likeness.correlation[SMILE] == 0
    assert np.isnan(found.likeness.correlation[PUCKER])
    assert len(found.worst) >= 3


def test_an_avatar_that_is_not_seen_at_rest_is_an_error(clip: Clip, mirror: PaintedMirror, express: Express) -> None:
    mirror.hidden = {0}
    with pytest.raises(UnseenAvatar, match="sees no face in the neutral picture of avatar 'Tiny'"):
        echo(clip, express, mirror)


def test_worst_frames_are_apart_and_few() -> None:
    times = np.arange(200) / 25
    driver = np.zeros((200, len(CHANNELS)))
    driver[:, JAW] = np.sin(times)
    avatar = driver.copy()
    avatar[100:110, JAW] -= 4
    worst = worst_frames(times, np.ones(200, bool), driver, avatar)
    assert 100 <= worst[0].frame < 110
    seconds = sorted(found.seconds for found in worst)
    assert min(np.diff(seconds)) >= WORST_APART_SECS
    assert len(worst) == WORST
    assert worst_frames(times, np.ones(200, bool), driver, driver) == ()


def test_a_channel_that_stands_still_on_the_avatar_has_no_correlation_and_no_warning(clip: Clip) -> None:
    driver = table(clip.readings, clip.neutral)
    frozen = np.zeros_like(driver)
    assert correlations(driver, frozen)[JAW] == 0
    assert np.isfinite(unrests(driver, frozen)).all()
    assert moving(driver)[[JAW, SMILE, YAW, PUCKER]].tolist() == [True, True, True, False]
    assert painted(jaw=1)[0, 0, 0] > painted()[0, 0, 0]


def test_ways_of_driving_are_timed_by_turns(
    clip: Clip, mirror: PaintedMirror, express: Express, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a clock that stands still but for what each stage takes: what else the machine does is in no figure."""
    now, order = 0.0, []

    def spend(seconds: float) -> None:
        nonlocal now
        now += seconds

    def way(name: str, seconds: float) -> Express:
        def taken(relative: NDArray[np.floating], rotation: NDArray[np.floating]) -> Answer:
            order.append(name)
            spend(seconds if len(order) > 2 * pace.WARMING else 100.0)
            return express(relative, rotation)

        return taken

    draw, read = mirror.draw, mirror.read
    monkeypatch.setattr(pace, "time", SimpleNamespace(perf_counter=lambda: now))
    monkeypatch.setattr(mirror, "draw", lambda *words: (spend(0.25), draw(*words))[1])
    monkeypatch.setattr(mirror, "read", lambda *words: (spend(0.5), read(*words))[1])
    slow, quick = pace.paces(clip, [way("slow", 4.0), way("quick", 1.0)], mirror)
    assert order == ["slow", "quick"] * (pace.WARMING + pace.STEPS)
    assert (slow.step, quick.step) == (4.25, 1.25)
    assert slow.tracking == quick.tracking == 0.5
