"""A regressor from a person's own frames: a capture of a shipped avatar, whose coefficients are known."""

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from facecapture import person, write_capture  # noqa: E402
from gemheads.models.captures.layout import CaptureError  # noqa: E402
from gemheads.models.captures.reader import Capture  # noqa: E402
from gemheads.models.driver.regressor import Regressor  # noqa: E402
from gemheads.models.gem import Gem  # noqa: E402
from gemheads.models.train.regressors.capture_regressor import RegressorEffort, capture_regressor, invented  # noqa: E402
from gemheads.models.train.regressors.controls import free_controls  # noqa: E402
from gemheads.models.train.regressors.selfreenact import self_reenactment  # noqa: E402
from gemheads.models.train.regressors.sightings import frontal_cameras, neutral_of, see  # noqa: E402
from gemheads.models.train.synthesis.fit import HeadPose, Start  # noqa: E402

TRAIN = 16


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Gem, Capture, dict[int, Start]]:
    gem = person()
    capture, known = write_capture(tmp_path_factory.mktemp("capture"), gem, train=TRAIN, test=4)
    return gem, capture, {time: Start(k, HeadPose.rest()) for time, k in known.items()}


def test_the_cameras_in_front_come_first(filmed: tuple[Gem, Capture, dict[int, Start]]) -> None:
    _, capture, _ = filmed
    for split in ("train", "test"):
        assert frontal_cameras(capture, split)[0] == 1
        assert set(frontal_cameras(capture, split, 2)) < {0, 1, 2}


def test_a_camera_that_is_held_out_takes_no_other_ones_place(
    filmed: tuple[Gem, Capture, dict[int, Start]], tmp_path: Path
) -> None:
    gem, _, moments = filmed
    capture, _ = write_capture(tmp_path, gem, train=4, test=1, held_out=(1,))
    assert set(frontal_cameras(capture, "train", 2)) == {0, 2}
    assert frontal_cameras(capture, "test")[0] == 1
    learned = capture_regressor(gem, capture, moments, RegressorEffort(pictures=0, steps=1, photometric=False))
    assert set(learned.cameras) == {shot.camera_index for shot in learned.sightings.shots} == {0, 2}


def test_the_neutral_is_the_moments_nearest_to_rest(filmed: tuple[Gem, Capture, dict[int, Start]]) -> None:
    _, capture, _ = filmed
    neutral = neutral_of(capture)
    front = [shot for shot in capture.train if shot.camera_index == 1]
    moved = np.abs(see(capture, front, neutral).features).mean(1)
    assert moved[0] < np.median(moved[1:])


def test_it_drives_its_person_on_moments_it_never_saw(filmed: tuple[Gem, Capture, dict[int, Start]]) -> None:
    gem, capture, moments = filmed
    seen = {time: moment for time, moment in moments.items() if time < TRAIN}
    effort = RegressorEffort(pictures=0, steps=120, photometric=False)
    learned = capture_regressor(gem, capture, seen, effort)
    assert len(learned.sightings) + learned.sightings.unseen == 3 * TRAIN
    figures = self_reenactment(learned.gem, capture, learned.neutral)
    assert figures.missed < 0.4
    assert figures.psnr["rest"] + 3 < figures.psnr["driven"] <= figures.psnr["fitted"] + 0.5


def test_the_same_seed_gives_the_same_regressor(filmed: tuple[Gem, Capture, dict[int, Start]]) -> None:
    gem, capture, moments = filmed
    effort = RegressorEffort(pictures=0, steps=6, seed=3)
    one, two = (capture_regressor(gem, capture, moments, effort).gem.regressor for _ in range(2))
    assert one == two


def test_the_loop_is_closed_for_strangers(filmed: tuple[Gem, Capture, dict[int, Start]]) -> None:
    gem, capture, moments = filmed
    learned = capture_regressor(gem, capture, moments, RegressorEffort(pictures=40, steps=12))
    assert learned.mismatches is not None
    assert learned.gem.regressor is not None
    answer = Regressor(learned.gem.regressor, gem.coefficient_count)(learned.neutral.features * 9, np.ones(3))
    assert (np.abs(answer.coefficients) <= 3 * gem.sigma * (1 + 1e-5)).all()


def test_invented_faces_are_near_what_the_person_did() -> None:
    gem = person()
    rng = np.random.default_rng(0)
    known = gem.rest_coefficients + rng.normal(size=(10, gem.coefficient_count)) * gem.sigma
    faces = invented(gem, free_controls(gem), known.astype(np.float32), 200, rng)
    assert faces.shape == (200, gem.coefficient_count)
    assert not faces[0].any()
    assert np.abs(faces).max() <= 3
    assert faces[2::2].std() > 0.2


def test_moments_of_nobody_are_refused(filmed: tuple[Gem, Capture, dict[int, Start]]) -> None:
    gem, capture, moments = filmed
    with pytest.raises(ValueError, match="no picture"):
        capture_regressor(gem, capture, {99: moments[0]}, RegressorEffort(pictures=0, steps=1))


def test_a_face_that_nobody_sees_is_told(
    filmed: tuple[Gem, Capture, dict[int, Start]], monkeypatch: pytest.MonkeyPatch
) -> None:
    _, capture, _ = filmed
    monkeypatch.setattr(Capture, "read", lambda self, shot: np.full((192, 192, 4), 255, np.uint8))
    with pytest.raises(CaptureError, match="sees no face"):
        neutral_of(capture)
