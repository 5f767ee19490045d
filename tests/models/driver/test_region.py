"""What the landmark network sees of an image lies where the region says."""

import numpy as np
import pytest
from gemheads.models.driver.region import Region

SIDE = 64


@pytest.mark.parametrize("size", [40.0, 100.0, 111.0, 112.0, 150.0, 333.3])
@pytest.mark.parametrize("middle", [(301.3, 222.7), (20.0, 390.5)])
def test_a_crop_shows_the_place_however_large_the_face(size: float, middle: tuple[float, float]) -> None:
    down, across = np.mgrid[:411, :603]
    image = np.stack([across * 0.4, down * 0.5, 0 * down], 2).round().astype(np.uint8)
    region = Region(*middle, size, 0.4)
    crop = region.crop(image, SIDE)
    places = np.stack(np.meshgrid(np.arange(SIDE) + 0.5, np.arange(SIDE) + 0.5), 2)
    matrix = region.to_image(SIDE)
    x, y = np.moveaxis(places @ matrix[:, :2].T + matrix[:, 2], 2, 0)
    inside = (x > 4) & (x < 598) & (y > 4) & (y < 406)
    assert inside.mean() > 0.3
    np.testing.assert_allclose(crop[..., 0][inside], 0.4 * (x[inside] - 0.5), atol=1.2)
    np.testing.assert_allclose(crop[..., 1][inside], 0.5 * (y[inside] - 0.5), atol=1.2)


def test_grain_in_a_large_face_is_averaged() -> None:
    grain = np.random.default_rng(2).normal(128, 30, (700, 700, 1)).clip(0, 255).astype(np.uint8).repeat(3, 2)
    left = [float(Region(350.0, 350.0, times * SIDE, 0.3).crop(grain, SIDE).std()) for times in (1, 2, 4, 8)]
    assert left[1] < 0.75 * left[0]
    assert left[2] < 0.6 * left[1]
    assert left[3] < 0.6 * left[2]


@pytest.mark.parametrize("middle", [(-900.0, 50.0), (50.0, 4000.0), (-1e12, 1e12)])
def test_a_large_region_beside_the_image_repeats_its_border(middle: tuple[float, float]) -> None:
    image = np.full((90, 120, 3), 77, np.uint8)
    assert (Region(*middle, 500.0, 0.2).crop(image, SIDE) == 77).all()


def test_regions_are_as_far_apart_as_they_differ_most() -> None:
    region = Region(100.0, 60.0, 50.0, 3.1)
    assert region.apart(region) == 0
    assert region.apart(Region(103.0, 56.0, 50.0, 3.1)) == pytest.approx(5 / 50)
    assert region.apart(Region(101.0, 60.0, 60.0, 3.1)) == pytest.approx(0.2)
    assert region.apart(Region(100.0, 60.0, 0.0, 3.1)) == pytest.approx(1)
    assert region.apart(Region(100.0, 60.0, 51.0, -3.1)) == pytest.approx(2 * np.pi - 6.2)  # as tilts go, side by side
