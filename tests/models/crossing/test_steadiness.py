"""Noise, turned heads and other neutrals: what is measured there is what was put in."""

import numpy as np
import pytest
from gemheads.models.crossing import neutrals
from gemheads.models.crossing.clip import Clip, UnseenDriver
from gemheads.models.crossing.extent import Extent
from gemheads.models.crossing.mirror import UnseenAvatar
from gemheads.models.crossing.neutrals import spread_of_correlations, spread_of_means, sway
from gemheads.models.crossing.poseleak import PITCH_DEG, YAW_DEG, leak, path, turn
from gemheads.models.crossing.still import FRAMES, Still, hold_still, jitter
from gemheads.models.crossing.webcam import resensed
from gemheads.models.driver.answer import Answer, Express
from gemheads.models.driver.features import DIMENSION
from gemheads.models.driver.smoothing import OneEuro
from gemheads.models.gem import Gem
from numpy.typing import NDArray

from .conftest import PaintedMirror, performed


def test_a_webcams_noise_is_fresh_bright_and_inside_its_box() -> None:
    rng = np.random.default_rng(0)
    picture = np.full((80, 120, 3), 128, np.uint8)
    picture[:, 60:] = 12
    one, other = (resensed(picture, (10, 10, 110, 70), rng) for _ in range(2))
    inside = one[12:68, 12:58].astype(float)
    assert 1.5 < inside.std() < 5
    assert abs(inside.mean() - 128) < 1
    assert (one != other).any()
    outside = one.copy()
    outside[10:70, 10:110] = picture[10:70, 10:110]
    np.testing.assert_array_equal(outside, picture)
    again = resensed(picture, (10, 10, 110, 70), np.random.default_rng(0))
    np.testing.assert_array_equal(again, one)


def test_jitter_is_the_rms_in_sigma_and_smoothing_lessens_it(clip: Clip, tiny_gem: Gem) -> None:
    still = hold_still(clip, performed())
    assert len(still.readings) == FRAMES
    assert 0.5 < still.noise < 6
    rng = np.random.default_rng(5)
    away = rng.normal(0, 0.2, (FRAMES, tiny_gem.coefficient_count))
    answers = iter(tiny_gem.rest_coefficients + tiny_gem.sigma * away)
    found = jitter(still, clip.neutral, lambda *_: Answer(next(answers), np.zeros(3)), tiny_gem, OneEuro(1.0, 0.0))
    assert found.raw.sigma == pytest.approx(0.2, rel=0.1)
    assert found.smoothed.sigma < 0.6 * found.raw.sigma
    assert 0 < found.smoothed.mm < 0.6 * found.raw.mm
    calm = jitter(still, clip.neutral, lambda *_: Answer(tiny_gem.rest_coefficients, np.zeros(3)), tiny_gem, OneEuro())
    assert calm.raw == calm.smoothed == Extent(0, 0)


def test_the_neutral_has_to_be_there_again(clip: Clip) -> None:
    with pytest.raises(UnseenDriver, match="the picture of its neutral is gone"):
        hold_still(clip, [])
    black = ((np.zeros_like(picture), now) for picture, now in performed())
    with pytest.raises(UnseenDriver, match="the picture of its neutral is gone"):
        hold_still(clip, black)


def test_the_path_goes_to_all_ends_and_no_further() -> None:
    yaw, pitch = path().T
    assert {yaw.min(), yaw.max()} == {-YAW_DEG, YAW_DEG}
    assert {pitch.min(), pitch.max()} == {-PITCH_DEG, PITCH_DEG}
    assert ((np.abs(yaw) == YAW_DEG) & (pitch == 0)).sum() >= 2
    assert np.hypot(yaw / YAW_DEG, pitch / PITCH_DEG).max() < 1 + 1e-9


def test_a_leak_is_what_the_turn_alone_does(mirror: PaintedMirror, tiny_gem: Gem) -> None:
    turned = turn(mirror)
    assert len(turned.readings) == len(path())

    def leaking(relative: NDArray[np.floating], rotation: NDArray[np.floating]) -> Answer:
        assert relative.shape == (DIMENSION,)
        return Answer(tiny_gem.rest_coefficients + tiny_gem.sigma * np.float32(rotation[1]), rotation)

    found = leak(turned, leaking, tiny_gem)
    assert found.at_yaw.sigma == pytest.approx(np.radians(YAW_DEG), rel=0.03)
    assert 0 < found.all.sigma < found.at_yaw.sigma
    sigma = tiny_gem.sigma[tiny_gem.slices["position"]].astype(float)
    wanted = 1000 * np.radians(YAW_DEG) * np.sqrt((sigma**2).sum() / len(tiny_gem))
    assert found.at_yaw.mm == pytest.approx(wanted, rel=0.03)
    assert found.at_yaw.over(found.at_yaw) == Extent(1, 1)
    assert found.at_yaw.over(Extent(0, 0)) == Extent(0, 0)
    tight = leak(turned, lambda *_: Answer(tiny_gem.rest_coefficients + 5, np.zeros(3)), tiny_gem)
    assert tight.at_yaw == tight.all == Extent(0, 0)


def test_an_avatar_that_is_not_seen_from_the_side_gives_no_leak(mirror: PaintedMirror) -> None:
    mirror.hidden = {1 + place for place, (yaw, _) in enumerate(path()) if yaw == YAW_DEG}
    with pytest.raises(UnseenAvatar, match="turned 20 degrees to a side"):
        turn(mirror)


def test_neutrals_shift_the_mean_and_not_what_is_copied(
    clip: Clip, mirror: PaintedMirror, express: Express, tiny_gem: Gem
) -> None:
    calls: list[int] = []
    swayed = sway(clip, express, mirror, lambda: calls.append(1))
    count = len(clip.others) + 1
    assert len(calls) == count
    assert swayed.correlations.shape[0] == swayed.means.shape[0] == count
    assert spread_of_correlations(swayed)[1] < 0.1
    relative = clip.readings.features[clip.others] - clip.neutral.features
    shifts = np.array([0, *(-express(r, np.zeros(3)).coefficients[1] for r in relative)])
    np.testing.assert_allclose(swayed.means[:, 1] - swayed.means[0, 1], shifts, atol=1e-5)
    assert spread_of_means(swayed, tiny_gem).sigma > 0
    frozen = neutrals.Swayed(swayed.correlations, np.ones_like(swayed.means))
    assert spread_of_means(frozen, tiny_gem) == Extent(0, 0)


def test_a_still_has_its_readings(clip: Clip) -> None:
    assert Still(clip.readings, 1.0).readings[3].features.shape == (DIMENSION,)
