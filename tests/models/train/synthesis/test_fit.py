"""A picture of an avatar leads back to the expression and the pose it was drawn with."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.app.bench.synthetic import synthetic_gem
from gemheads.app.performing.portrait import portrait
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.posing import pose_head
from gemheads.render.camera import Camera
from gemheads.render.compositing import over
from gemheads.render.rotations import matrix_from_wxyz, rotvec_from_matrix, wxyz_from_rotvec
from gemheads.render.software import SoftwareEngine

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.synthesis.fit import FIRST, NEXT, Descent, Effort, HeadPose, Start, error_map, fit  # noqa: E402

GREY = (0.75, 0.75, 0.75)
BRIEF = Effort((Descent(None, 2),))
AVATAR = Path(__file__).parents[4] / "assets" / "avatars" / "mara.gem"
TURN, MOVE = np.float32([0.06, -0.14, 0.05]), np.float32([0.003, -0.002, 0.004])


@pytest.fixture(scope="module")
def mara() -> Gem:
    if not AVATAR.exists():
        pytest.skip(f"no avatar at {AVATAR}; make it with `make avatars`")
    return load_gem(AVATAR).truncated(20)


def taken(gem: Gem, coefficients: np.ndarray, pose: HeadPose, camera: Camera) -> np.ndarray:
    """A picture by the engine that people see, not by the one that fits."""
    raw = pose_head(gem.compose(coefficients), gem.neck_weights, gem.neck_pivot, pose.turn, pose.move)
    return over(SoftwareEngine().draw(raw, camera), GREY).copy()


def degrees_apart(first: np.ndarray, second: np.ndarray) -> float:
    turns = [matrix_from_wxyz(wxyz_from_rotvec(turn.astype(float))) for turn in (first, second)]
    return float(np.degrees(np.linalg.norm(rotvec_from_matrix(turns[0] @ turns[1].T))))


def smiling(gem: Gem, amount: float) -> np.ndarray:
    weights = np.zeros(52, np.float32)
    weights[[17, 23, 24, 43, 44]] = amount
    return gem.clamped(gem.arkit_coefficients(weights))


def test_a_first_picture_and_the_next(mara: Gem) -> None:
    camera = portrait(mara.viewing, 256, 256)
    wanted, pose = smiling(mara, 0.5), HeadPose(TURN, MOVE)
    first = fit(mara, [taken(mara, wanted, pose, camera)], [camera], effort=FIRST)
    assert first.psnr >= 38
    assert degrees_apart(first.pose.turn, TURN) < 0.5
    assert np.linalg.norm(first.pose.move - MOVE) < 0.002

    later = HeadPose(TURN + np.float32(0.02), MOVE)
    picture = taken(mara, smiling(mara, 0.6), later, camera)
    second = fit(mara, [picture], [camera], start=first.start, effort=NEXT)
    assert second.psnr >= 38
    assert degrees_apart(second.pose.turn, later.turn) < 0.5
    assert np.abs(second.pictures[0] - picture / 255).mean() < 0.01


def test_two_views_agree(mara: Gem) -> None:
    cameras = [portrait(mara.viewing, 128, 160, yaw_deg=yaw) for yaw in (-30, 30)]
    wanted, pose = smiling(mara, 0.4), HeadPose(TURN, MOVE)
    found = fit(mara, [taken(mara, wanted, pose, camera) for camera in cameras], cameras, effort=FIRST)
    assert found.psnr >= 38
    assert degrees_apart(found.pose.turn, TURN) < 0.5
    assert len(found.pictures) == 2


@pytest.mark.parametrize(("rate", "better"), [(0.02, True), (5.0, False)])
def test_the_last_step_of_adam_counts_where_it_is_better(rate: float, better: bool) -> None:
    gem = synthetic_gem(300, 4, np.random.default_rng(0))
    camera = portrait(gem.viewing, 48, 48)
    picture = taken(gem, gem.clamped(gem.rest_coefficients + gem.sigma), HeadPose.rest(), camera)
    found = fit(gem, [picture], [camera], effort=Effort((), adam_steps=1, adam_rate=rate))
    before, after = found.losses
    assert (after < before) == better
    assert np.any(found.coefficients != gem.rest_coefficients) == better


def test_the_prior_holds_back_what_cannot_be_seen() -> None:
    gem = synthetic_gem(300, 4, np.random.default_rng(0))
    camera = portrait(gem.viewing, 48, 48)
    blank = np.full((48, 48, 3), 191, np.uint8)
    loose, tight = (fit(gem, [blank], [camera], prior=prior, effort=BRIEF) for prior in (1e-4, 1e4))
    assert np.abs(tight.coefficients).max() < 0.05 < np.abs(loose.coefficients).max()
    assert gem.limit_share(loose.coefficients) <= 1
    assert gem.limit_share(3 * gem.sigma) == 1


def test_an_avatar_without_components_has_a_pose() -> None:
    gem = synthetic_gem(300, 0, np.random.default_rng(0))
    camera = portrait(gem.viewing, 48, 48)
    picture = taken(gem, gem.rest_coefficients, HeadPose(TURN, MOVE), camera)
    found = fit(gem, [picture], [camera], effort=Effort((Descent(None, 8, pose_only=True), Descent(None, 8))))
    assert degrees_apart(found.pose.turn, TURN) < 3
    assert gem.limit_share(found.coefficients) == 0


def test_starts_at_the_rest_of_the_avatar() -> None:
    plain = synthetic_gem(300, 4, np.random.default_rng(0))
    gem = replace(plain, rest=np.full(plain.coefficient_count, 0.5, np.float32))
    camera = portrait(gem.viewing, 48, 48)
    found = fit(gem, [taken(gem, gem.rest_coefficients, HeadPose.rest(), camera)], [camera], effort=BRIEF)
    np.testing.assert_allclose(found.coefficients, 0.5, atol=0.2)
    assert found.psnr > 38


def test_wrong_input_is_refused() -> None:
    gem = synthetic_gem(50, 2, np.random.default_rng(0))
    camera, picture = portrait(gem.viewing, 48, 40), np.zeros((40, 48, 3), np.uint8)
    with pytest.raises(ValueError, match="1 pictures, 2 cameras"):
        fit(gem, [picture], [camera, camera])
    with pytest.raises(ValueError, match="picture 0 is 40x48, its camera 48x40"):
        fit(gem, [picture.swapaxes(0, 1)], [camera])
    with pytest.raises(ValueError, match="must be"):
        fit(gem, [picture[..., 0]], [camera])
    with pytest.raises(ValueError, match="not finite"):
        fit(gem, [picture * np.nan], [camera])
    with pytest.raises(ValueError, match="background"):
        fit(gem, [picture], [camera], background=(1, 1))
    with pytest.raises(ValueError, match="8 coefficients, the start"):
        fit(gem, [picture], [camera], start=Start(np.zeros(3, np.float32), HeadPose.rest()))


def test_alpha_is_laid_on_the_background() -> None:
    gem = synthetic_gem(50, 2, np.random.default_rng(0))
    camera = portrait(gem.viewing, 32, 32)
    opaque = np.full((32, 32, 3), 0.75, np.float32)
    clear = np.zeros((32, 32, 4), np.float32)
    assert fit(gem, [clear], [camera], GREY, effort=BRIEF).psnr == fit(gem, [opaque], [camera], GREY, effort=BRIEF).psnr


def test_the_error_map_is_black_where_nothing_differs() -> None:
    fitted = np.zeros((2, 2, 3), np.float32)
    picture = np.zeros((2, 2, 3), np.uint8)
    picture[0, 0], picture[1, 1] = 255, 9
    shown = error_map(fitted, picture)
    assert shown[0, 0].tolist() == [255, 255, 255]
    assert not shown[0, 1].any()
    assert shown[1, 1, 0] > shown[1, 1, 1]
