"""SSIM by hand is SSIM by convolutions."""

from collections.abc import Callable

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.train.losses import photometric, psnr, ssim, ssim_by_convolution  # noqa: E402

Similarity = Callable[["torch.Tensor", "torch.Tensor"], "torch.Tensor"]


def ssim_by_window(image: "torch.Tensor", target: "torch.Tensor") -> "torch.Tensor":
    taps = torch.exp(-((torch.arange(11).double() - 5) ** 2) / 4.5)
    window = (taps[:, None] * taps / taps.sum() ** 2).expand(3, 1, 11, 11)

    def mean(picture: "torch.Tensor") -> "torch.Tensor":
        return torch.nn.functional.conv2d(picture, window, padding=5, groups=3)

    x, y = (picture.double().permute(2, 0, 1)[None] for picture in (image, target))
    mx, my = mean(x), mean(y)
    vx, vy, vxy = mean(x * x) - mx**2, mean(y * y) - my**2, mean(x * y) - mx * my
    top = (2 * mx * my + 1e-4) * (2 * vxy + 9e-4)
    return (top / ((mx**2 + my**2 + 1e-4) * (vx + vy + 9e-4))).mean()


def pictures(height: int, width: int) -> tuple["torch.Tensor", "torch.Tensor"]:
    rng = np.random.default_rng(0)
    rows, columns = np.mgrid[:height, :width]
    smooth = 0.5 + 0.4 * np.sin(0.3 * rows + 0.2 * columns)[..., None] * np.array([1, 0.6, -0.8])
    noisy = np.clip(smooth + 0.1 * rng.normal(size=smooth.shape), 0, 1)
    return torch.tensor(noisy, dtype=torch.float32).requires_grad_(), torch.tensor(smooth, dtype=torch.float32)


@pytest.mark.parametrize("similarity", [ssim, ssim_by_convolution])
@pytest.mark.parametrize(("height", "width"), [(40, 33), (7, 5)])
def test_value_and_gradient(height: int, width: int, similarity: Similarity) -> None:
    image, target = pictures(height, width)
    found, wanted = similarity(image, target), ssim_by_window(image, target)
    assert found.item() == pytest.approx(wanted.item(), abs=2e-5)
    slope, correct = (torch.autograd.grad(value, image)[0] for value in (found, wanted))
    assert (slope - correct).abs().max() <= 1e-4 * correct.abs().max()


def test_the_same_picture_is_perfect() -> None:
    image, target = pictures(20, 20)
    assert ssim(target, target).item() == pytest.approx(1, abs=1e-6)
    assert photometric(target, target).item() == pytest.approx(0, abs=1e-6)
    assert photometric(image, target).item() > 0.05
    assert psnr(target + 0.1, target) == pytest.approx(20, abs=1e-3)
