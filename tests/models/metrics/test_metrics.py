"""Each metric against what others compute, at its ends, and under a mask."""

import numpy as np
import pytest
from gemheads.models.metrics.flip import flip_map
from gemheads.models.metrics.pixels import BEST_DB, l1, psnr
from gemheads.models.metrics.structure import ssim, ssim_map


def pictures(height: int = 48, width: int = 40) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    rows, columns = np.mgrid[:height, :width]
    smooth = 0.5 + 0.4 * np.sin(0.3 * rows + 0.2 * columns)[..., None] * np.array([1, 0.6, -0.8])
    return np.clip(smooth + 0.05 * rng.normal(size=smooth.shape), 0, 1).astype("f4"), smooth.astype("f4")


def test_equal_pictures() -> None:
    image, _ = pictures()
    assert l1(image, image) == 0
    assert psnr(image, image) == BEST_DB
    assert ssim(image, image) == pytest.approx(1, abs=1e-6)


def test_known_differences() -> None:
    grey = np.full((20, 20, 3), 0.5, np.float32)
    assert l1(grey + 0.1, grey) == pytest.approx(0.1, abs=1e-6)
    assert psnr(grey + 0.1, grey) == pytest.approx(20, abs=1e-4)


def test_ssim_is_that_of_others_away_from_the_edges() -> None:
    metrics = pytest.importorskip("skimage.metrics", reason="scikit-image is the oracle of SSIM")
    image, target = pictures()
    _, wanted = metrics.structural_similarity(
        image.astype("f8"), target.astype("f8"), channel_axis=2, gaussian_weights=True, sigma=1.5,
        use_sample_covariance=False, data_range=1.0, full=True,
    )  # fmt: skip
    inner = np.s_[6:-6, 6:-6]
    np.testing.assert_allclose(ssim_map(image, target)[inner], wanted[inner], atol=2e-4)


def test_masks_leave_pixels_out() -> None:
    image, target = pictures()
    spoilt = image.copy()
    spoilt[:, :20] = 0
    mask = np.zeros(image.shape[:2], np.float32)
    mask[:, 30:] = 1
    for metric in (l1, psnr, ssim):
        assert metric(spoilt, target, mask) == pytest.approx(metric(image, target, mask), rel=1e-6)
        assert metric(spoilt, target) != pytest.approx(metric(image, target), rel=1e-2)
        assert metric(image, target, np.ones_like(mask)) == pytest.approx(metric(image, target), rel=1e-6)
    assert l1(image, target, mask) == pytest.approx(l1(image[:, 30:], target[:, 30:]), rel=1e-6)


@pytest.mark.parametrize("metric", [l1, psnr, ssim])
def test_what_does_not_belong_together_is_refused(metric) -> None:
    image, target = pictures()
    with pytest.raises(ValueError, match="one size"):
        metric(image, target[:-1])
    with pytest.raises(ValueError, match="mask"):
        metric(image, target, np.ones((3, 3), np.float32))
    with pytest.raises(ValueError, match="no pixel"):
        metric(image, target, np.zeros(image.shape[:2], np.float32))


def test_flip() -> None:
    image, target = pictures()
    same = flip_map(target, target)
    if same is None:
        pytest.skip("flip-evaluator is not installed (extra gemheads[train])")
    assert same.shape == target.shape[:2]
    assert same.max() < 1e-3
    near, far = flip_map(image, target), flip_map(1 - target, target)
    assert near is not None
    assert far is not None
    assert 0.01 < near.mean() < far.mean() <= 1
