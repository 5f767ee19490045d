"""An avatar that was baked anew and reads as before does what the former one has learned."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from gemheads.models.driver.regressor import Regressor, RegressorError

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.controls import (  # noqa: E402
    controls_of,
)
from gemheads.models.train.regressors.export_onnx import export_onnx  # noqa: E402
from gemheads.models.train.regressors.takeover import taken_over  # noqa: E402
from toygem import toy_gem  # noqa: E402
from toynetwork import network_of, relative_features  # noqa: E402


def test_an_avatar_that_takes_over_shows_the_same_arkit_weights() -> None:
    old, anew = toy_gem(), toy_gem(components=4)
    assert anew.arkit_weights is not None
    anew = replace(anew, arkit_weights=1.5 * anew.arkit_weights)
    members = [network_of(controls_of(old)), network_of(controls_of(old), trained=False)]
    regressor = Regressor(taken_over(replace(old, regressor=export_onnx(members)), anew), anew.coefficient_count)
    features, still = relative_features(10, 2) * 5, np.zeros((10, 3), np.float32)
    with torch.no_grad():
        answers = [member.weights(torch.from_numpy(features), torch.from_numpy(still)).numpy() for member in members]
    wanted = controls_of(anew).coefficients(np.mean(answers, 0))
    got = np.stack([regressor(one, np.zeros(3)).coefficients for one in features])
    np.testing.assert_allclose(got, wanted, atol=1e-3)
    assert np.ptp(got, axis=0).max() > 0.1


def foreign() -> bytes:
    """The graph of another avatar: what it calls its constants is not what this one's are."""
    gem = toy_gem()
    return export_onnx([network_of(controls_of(replace(gem, rest=gem.rest_coefficients + 1)))])


@pytest.mark.parametrize(
    ("rigged", "graph", "said"),
    [
        (True, lambda: None, "'toy' has no regressor to take over"),
        (True, lambda: b"no graph", "cannot be used"),
        (True, foreign, "is not one that train-regressor wrote"),
        (False, lambda: None, "only avatars with ARKit shapes"),
    ],
)
def test_what_cannot_be_taken_over_is_an_error(rigged: bool, graph: Callable[[], bytes | None], said: str) -> None:
    with pytest.raises(RegressorError, match=said):
        taken_over(replace(toy_gem(rigged), regressor=graph()), toy_gem())
