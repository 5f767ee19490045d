"""Which pictures of an avatar are drawn to learn from."""

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors import response, series, train_regressor  # noqa: E402
from gemheads.models.train.regressors.response import Responses  # noqa: E402
from pixelface import PixelTracker, painted  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import relative_features  # noqa: E402


def test_pictures_of_whole_series_are_the_first_of_more(monkeypatch: pytest.MonkeyPatch) -> None:
    def drawing(gem, controls, weights, rng, progress, rotations, sitting):
        rotations = rng.normal(size=(len(weights), 3))
        return Responses(weights, rotations, rotations, relative_features(len(weights)))

    monkeypatch.setattr(series, "measure_responses", drawing)
    few, more = (train_regressor.pictures_of(toy_gem(), count, 3) for count in (series.LENGTH, 1300))
    assert len(more) == 1300
    np.testing.assert_array_equal(few.weights, more.weights[: len(few)])
    np.testing.assert_array_equal(few.rotations, more.rotations[: len(few)])
    assert np.abs(more.weights[series.LENGTH] - more.weights[1]).max() > 0


def test_some_pictures_show_a_face_at_rest_that_turns_further(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = PixelTracker().track(painted())

    class Studio:
        def __init__(self, gem: object, sitting: object) -> None:
            pass

        def read(self, coefficients, rotation, rng, still=False):
            return seen

    monkeypatch.setattr(response, "_Studio", Studio)
    drawn = train_regressor.pictures_of(toy_gem(), 4000, 3)
    rest = ~drawn.weights.any(1)
    turned = drawn.rotations[drawn.rotations.any(1) & ~rest], drawn.rotations[rest]
    assert train_regressor.RESTING <= rest.mean() < train_regressor.RESTING + 0.05
    assert 1.15 < turned[1].std() / turned[0].std() < 1.45
