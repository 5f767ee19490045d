"""What a network sees of the features."""

import numpy as np
import pytest
from gemheads.models.driver.features import BLOCKS, DIMENSION, SCORE_NAMES, SCORES
from gemheads.models.driver.measures import MEASURES

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.channels import (  # noqa: E402
    AGAPE_TOLERANCE,
    PARTED,
    channel_indices,
    channel_tolerances,
    felt,
)
from gemheads.models.train.regressors.reduction import compared_channels, principal_components  # noqa: E402


def test_principal_components_are_whitened_and_drop_what_is_only_rounding() -> None:
    rng = np.random.default_rng(0)
    flat = rng.normal(size=(400, 7)) @ rng.normal(size=(7, DIMENSION))
    reduction = principal_components(flat.astype("f4"))
    kappa = (flat - reduction.mean) @ reduction.projection
    assert kappa.shape[1] == 7
    np.testing.assert_allclose(np.cov(kappa.T), np.eye(7), atol=1e-3)


def test_principal_components_of_features_of_which_some_never_differ() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(size=(60, DIMENSION)).astype("f4")
    features[:, BLOCKS["gaze"]] = 0
    reduction = principal_components(features)
    assert np.isfinite(reduction.projection).all()
    assert not reduction.projection[BLOCKS["gaze"]].any()
    for alike in (features[:1], np.repeat(features[:1], 5, 0)):
        with pytest.raises(ValueError, match="do not differ"):
            principal_components(alike)


def test_compared_channels_are_all_that_a_network_of_the_closed_loop_sees() -> None:
    rng = np.random.default_rng(0)
    features = (rng.normal(size=(400, DIMENSION)) * rng.uniform(0.05, 0.5, DIMENSION)).astype("f4")
    places = channel_indices()
    features[:, places[3]] = 0.2
    reduction = compared_channels(features)
    kappa = (features - reduction.mean) @ reduction.projection
    differ = np.arange(len(places)) != 3
    np.testing.assert_allclose(kappa.std(0)[differ], 1, atol=1e-3)
    np.testing.assert_allclose(kappa[:, 3], 0, atol=1e-3)
    others = np.setdiff1d(np.arange(DIMENSION), places)
    features[:, others] += rng.normal(size=(400, len(others)))
    np.testing.assert_allclose((features - reduction.mean) @ reduction.projection, kappa, atol=1e-5)


def test_channels_and_tolerances_go_together() -> None:
    indices, tolerances = channel_indices(), channel_tolerances()
    assert len(indices) == len(tolerances) == len(set(indices))
    assert (tolerances > 0).all()
    jaw = SCORES.start + SCORE_NAMES.index("jawOpen")
    assert jaw in indices
    assert not set(indices) & set(range(BLOCKS["mixer"].start, BLOCKS["mixer"].stop))


def test_lips_that_part_count_more_finely_than_those_that_are_wide_open() -> None:
    lips = list(channel_indices()).index(BLOCKS["measures"].start + MEASURES.index("lip_gap"))
    tolerance = channel_tolerances()[lips]
    gaps = torch.zeros(6, len(channel_indices()))
    gaps[:, lips] = torch.tensor([-0.1, 0.0, PARTED, PARTED + AGAPE_TOLERANCE, PARTED + 1.2, -PARTED - 1.2]) / tolerance
    counted = felt(gaps)[:, lips].numpy()
    assert tolerance < AGAPE_TOLERANCE
    near = PARTED / tolerance
    wide = 1.2 / AGAPE_TOLERANCE
    np.testing.assert_allclose(counted, [-0.1 / tolerance, 0, near, near + 1, near + wide, -near - wide], rtol=1e-5)
    rng = np.random.default_rng(0)
    others = torch.from_numpy(rng.normal(0, 9, (40, len(channel_indices()))).astype("f4"))
    aside = np.arange(others.shape[1]) != lips
    np.testing.assert_array_equal(felt(others)[:, aside], others[:, aside])
