"""The avatar in torch is the avatar in NumPy, with gradients."""

from dataclasses import replace

import numpy as np
import pytest
from gemheads.app.bench.synthetic import synthetic_gem
from gemheads.models.posing import pose_head

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.synthesis import torchgem  # noqa: E402
from gemheads.models.train.synthesis.torchgem import TorchGem  # noqa: E402

GEM = synthetic_gem(200, 6, np.random.default_rng(3))


def test_composes_as_the_avatar_does() -> None:
    coefficients = np.random.default_rng(0).normal(size=GEM.coefficient_count).astype(np.float32)
    found, wanted = TorchGem.of(GEM).compose(torch.from_numpy(coefficients)), GEM.compose(coefficients)
    for name, tensor in found._asdict().items():
        np.testing.assert_allclose(tensor.numpy(), getattr(wanted, name), rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.2, -0.5, 0.1), (1e-5, 0.0, 0.0), (2.0, 1.0, -1.5)])
def test_poses_as_the_avatar_does(turn: tuple[float, ...]) -> None:
    raw, move = GEM.compose(GEM.rest_coefficients), np.float32([0.01, -0.02, 0.03])
    shares, pivot = np.linspace(0, 1, 200, dtype=np.float32), np.float32([0.01, -0.1, -0.02])
    wanted = pose_head(raw, shares, pivot, np.array(turn), move)
    tensors = torchgem.RawTensors(*(torch.from_numpy(array) for array in vars(raw).values()))
    found = torchgem.pose_head(
        tensors, *map(torch.from_numpy, (shares, pivot)), torch.tensor(turn), torch.from_numpy(move)
    )
    np.testing.assert_allclose(found.positions, wanted.positions, atol=1e-6)
    np.testing.assert_allclose(found.wxyz, wanted.wxyz, atol=1e-5)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.1)])
def test_gradients_are_finite_differences(turn: tuple[float, ...]) -> None:
    gem = TorchGem.of(synthetic_gem(6, 2, np.random.default_rng(1)), dtype=torch.float64)

    def splats(coefficients: "torch.Tensor", turn: "torch.Tensor", move: "torch.Tensor") -> "torch.Tensor":
        posed = gem.posed(gem.compose(coefficients), turn, move)
        return torch.cat([tensor.reshape(-1) for tensor in posed[:4]])

    inputs = (torch.randn(8).double(), torch.tensor(turn).double(), torch.zeros(3).double())
    assert torch.autograd.gradcheck(splats, [tensor.requires_grad_() for tensor in inputs])


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (1e-3, 0.0, -2e-3), (0.3, -0.2, 0.1), (2.0, 1.0, -1.5)])
@pytest.mark.parametrize("still", [0.0, 0.9])
def test_kernels_have_the_gradients_of_plain_torch(turn: tuple[float, ...], still: float) -> None:
    whole = synthetic_gem(1500, 7, np.random.default_rng(1))
    rng = np.random.default_rng(2)
    for basis in whole.bases.values():
        basis.components[:, rng.random(basis.rows.shape[1]) < still] = 0
    assert (whole.bases["position"].moving is None) == (still == 0)
    shares = rng.random(1500).astype(np.float32)
    slopes = None
    found = {}
    for dtype in (torch.float64, torch.float32):
        gem = TorchGem.of(replace(whole, neck_weights=shares), dtype=dtype)
        torch.manual_seed(0)
        inputs = [torch.randn(28).to(dtype), torch.tensor(turn).to(dtype), torch.randn(3).to(dtype)]
        posed = gem.posed(gem.compose(inputs[0].requires_grad_()), *(one.requires_grad_() for one in inputs[1:]))
        together = torch.cat([tensor.reshape(-1) for tensor in posed[:4]])
        slopes = torch.randn(len(together)) if slopes is None else slopes
        found[dtype] = torch.autograd.grad(together, inputs, slopes.to(dtype))
    for plain, kernel in zip(*found.values(), strict=True):
        np.testing.assert_allclose(kernel.numpy(), plain.numpy(), rtol=0, atol=2e-5 * float(plain.abs().max()))
