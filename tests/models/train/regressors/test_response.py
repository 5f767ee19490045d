"""The model of an avatar's response."""

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.regressors.response import fit_response  # noqa: E402


def test_a_response_is_what_most_pictures_say() -> None:
    """A few in which the whole face is read otherwise do not move the others."""
    rng = np.random.default_rng(0)
    weights, rotations = rng.uniform(0, 1, (2000, 6)).astype("f4"), rng.normal(0, 0.2, (2000, 3)).astype("f4")
    clean = weights @ rng.normal(0, 2, (6, 4)).astype("f4") + rotations @ rng.normal(0, 5, (3, 4)).astype("f4")
    misread = rng.random((2000, 1)) < 0.05
    inputs = torch.from_numpy(weights), torch.from_numpy(rotations)
    model, _ = fit_response(inputs, torch.from_numpy(np.where(misread, clean + 100, clean)), 600, 0)
    errors = model(*inputs).numpy() - clean
    assert abs(errors.mean()) < 1, "squares would put a twentieth of the 100 on all of them"
