"""The networks that pictures are compared by, and the way of their weights out of pickles."""

import pickle
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.registry import default_cache  # noqa: E402
from gemheads.models.train import perceptualweights  # noqa: E402
from gemheads.models.train.perceptual import NETWORKS, TINY, Perceptual  # noqa: E402
from gemheads.models.train.perceptualweights import UnsafePickle, WeightsMissing, kept_at, unpickle  # noqa: E402


def picture(side: int = 40) -> "torch.Tensor":
    rows, columns = np.mgrid[:side, :side]
    waves = 0.5 + 0.4 * np.sin(0.3 * rows + 0.2 * columns) * np.array([1, 0.6, -0.8])[:, None, None]
    return torch.tensor(waves[None], dtype=torch.float32)


def real(network: str) -> Perceptual:
    if not kept_at(network, default_cache()).is_file():
        pytest.skip(f"the weights of {network} are not in the cache; Perceptual('{network}') fetches them")
    return Perceptual(network)


@pytest.fixture(params=[TINY, "alex", "vgg"])
def network(request: pytest.FixtureRequest) -> Perceptual:
    return Perceptual(TINY) if request.param == TINY else real(request.param)


def test_the_same_picture_differs_by_nothing(network: Perceptual) -> None:
    assert network.lpips(picture(), picture()).item() == 0
    assert network.feature_loss(picture(), picture()).item() == 0


def test_more_noise_is_farther_away(network: Perceptual) -> None:
    noise = torch.randn(picture().shape, generator=torch.Generator().manual_seed(0))
    noisy = [(picture() + strength * noise).clamp(0, 1) for strength in (0.02, 0.05, 0.1, 0.2)]
    for measure in (network.lpips, network.feature_loss):
        far = [measure(image, picture()).mean().item() for image in noisy]
        assert far == sorted(far)
        assert far[0] > 0


def test_every_picture_of_a_batch_counts_alone(network: Perceptual) -> None:
    other = picture().flip(3)
    both = network.lpips(torch.cat([picture(), other]), torch.cat([other, other]))
    assert both[0].item() == pytest.approx(network.lpips(picture(), other).item(), rel=1e-4)
    assert both[1].item() == pytest.approx(0, abs=1e-6)


def test_gradients_by_finite_differences() -> None:
    network = Perceptual(TINY)
    image, target = picture(16).requires_grad_(), picture(16).flip(3)
    for measure in (lambda x: network.lpips(x, target).sum(), lambda x: network.feature_loss(x, target)):
        (slope,) = torch.autograd.grad(measure(image), image)
        step = 1e-3 * slope.sign()
        change = measure(image.detach() + step) - measure(image.detach() - step)
        assert change.item() == pytest.approx(2 * (slope * step).sum().item(), rel=0.05)


def test_black_pictures_have_gradients(network: Perceptual) -> None:
    image = torch.zeros(1, 3, 40, 40, requires_grad=True)
    (slope,) = torch.autograd.grad(network.lpips(image, picture()).sum(), image)
    assert torch.isfinite(slope).all()


@pytest.mark.parametrize("name", NETWORKS)
def test_the_least_picture_reaches_the_last_layer(name: str) -> None:
    network = Perceptual(name) if name == TINY else real(name)
    side = network.least_side
    assert network.features(torch.zeros(1, 3, side, side))[-1].shape[2:] == (1, 1)
    with pytest.raises(RuntimeError):
        network.features(torch.zeros(1, 3, side - 1, side - 1))


def test_these_are_the_published_networks() -> None:
    """torchvision's vgg16 has 14,714,688 parameters in its convolutions, LPIPS's heads 1,472, none below zero."""
    arrays = perceptualweights.read_weights(kept_at("vgg", default_cache())) if real("vgg") else {}
    assert sum(array.size for name, array in arrays.items() if name.startswith("conv")) == 14_714_688
    assert sum(array.size for name, array in arrays.items() if name.startswith("head")) == 64 + 128 + 256 + 512 + 512
    assert all(array.min() >= 0 for name, array in arrays.items() if name.startswith("head"))
    np.testing.assert_allclose(arrays["conv.0.bias"][:4], [0.4034, 0.3778, 0.4644, -0.3228], atol=5e-5)


def test_arrays_come_out_of_a_pickle() -> None:
    tree = {"layer": {"kernel": np.arange(6, dtype="f4").reshape(2, 3)}, "other": {"bias": np.float32([1, 2])}}
    for protocol in (3, 4):
        found = unpickle(pickle.dumps(tree, protocol))
        np.testing.assert_array_equal(found["layer"]["kernel"], tree["layer"]["kernel"])
        np.testing.assert_array_equal(found["other"]["bias"], tree["other"]["bias"])


class Shell:
    def __reduce__(self):
        return Path.unlink, (Path("victim"),)


@pytest.mark.parametrize(
    "value", [Shell(), Path("."), np.array([object()]), np.arange(3), np.float64([1]), {"a": print}, 1j]
)
def test_anything_else_is_refused(value: object) -> None:
    for protocol in (3, 4):
        with pytest.raises(UnsafePickle):
            unpickle(pickle.dumps({"x": value}, protocol))


def test_without_a_network_the_cure_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = perceptualweights.PACKAGE
    offline = type(package)(package.name, package.archive, package.sha256, ("false",))
    monkeypatch.setattr(perceptualweights, "PACKAGE", offline)
    with pytest.raises(WeightsMissing, match=r"put it into .*" + tmp_path.name):
        Perceptual("vgg", cache=tmp_path)


def test_another_archive_is_refused(tmp_path: Path) -> None:
    (tmp_path / perceptualweights.PACKAGE.archive).write_bytes(b"something else")
    with pytest.raises(WeightsMissing, match="sha256"):
        Perceptual("alex", cache=tmp_path)
    assert not kept_at("alex", tmp_path).exists()
