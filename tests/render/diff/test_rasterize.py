"""Differentiable splatting draws the reference's picture, and its gradients are those of that picture."""

import dataclasses
import logging
import tracemalloc

import numpy as np
import pytest
from gemheads.render.camera import Camera, orbit
from gemheads.render.gaussians import activate
from gemheads.render.reference import render_reference

from ..scenes import awkward, portrait_camera, shell

torch = pytest.importorskip("torch", reason="torch is the optional extra gemheads[train]")

from gemheads.render.diff import cpu, cuda  # noqa: E402
from gemheads.render.diff import rasterize as door  # noqa: E402
from gemheads.render.diff.rasterize import rasterize  # noqa: E402
from gemheads.render.diff.tensors import GaussianTensors, RawTensors, tensors_of  # noqa: E402
from gemheads.render.diff.tensors import activate as activated  # noqa: E402

NAMES = ("positions", "wxyz", "scales", "opacities", "colors", "background", "world_to_camera")
SHELL = (shell(3_000), portrait_camera(128, 112))


def few() -> tuple[GaussianTensors, Camera]:
    """Splats set by hand, float64: overlapping, oblique, one capped at 0.99, one behind others, one at the margin."""
    positions = [[0.0, 0.0, 0.0], [0.01, 0.012, 0.03], [-0.02, 0.005, -0.03], [0.0, -0.015, 0.05], [0.075, 0.01, 0.1]]
    wxyz = [[1.0, 0, 0, 0], [0.8, 0.3, -0.4, 0.2], [0.2, -1.3, 0.5, 0.9], [-0.3, 0.1, 0.2, 0.6], [1, 1, 0, 0.5]]
    scales = [[0.02, 0.012, 0.015], [0.01, 0.03, 0.006], [0.025, 0.01, 0.012], [0.008, 0.02, 0.012], [0.02, 0.02, 0.1]]
    opacities = [0.6, 0.995, 0.8, 0.35, 0.7]
    colors = [[0.9, 0.1, 0.2], [0.2, 0.8, 0.3], [0.1, 0.3, 0.9], [0.7, 0.7, 0.1], [0.5, 0.4, 0.6]]
    tensors = (torch.tensor(values, dtype=torch.float64) for values in (positions, wxyz, scales, opacities, colors))
    return GaussianTensors(*tensors), orbit((0, 0, 0), 0.4, 15, 10, 20, 14, 12)


def gradients(splats: GaussianTensors, camera: Camera, engine: str) -> dict[str, "torch.Tensor"]:
    """Of a sum of the picture with random weights, by every input."""
    like = splats.positions
    leaves = [tensor.detach().clone().requires_grad_() for tensor in vars(splats).values()]
    background = torch.tensor([0.3, 0.6, 0.9], dtype=like.dtype, requires_grad=True)
    view = torch.tensor(camera.world_to_camera, requires_grad=True)
    image = rasterize(GaussianTensors(*leaves), camera, background, engine, view)  # pyright: ignore[reportArgumentType]
    weights = torch.randn(image.shape, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    found = torch.autograd.grad((image * weights.to(like.dtype)).sum(), [*leaves, background, view])
    return dict(zip(NAMES, found, strict=True))


def worst(found: "torch.Tensor", wanted: "torch.Tensor") -> float:
    """The largest error as a share of the largest gradient."""
    return float((found.double() - wanted).abs().max() / wanted.abs().max())


@pytest.mark.parametrize(
    ("scene", "engine", "most"),
    [
        (SHELL, "torch", 1e-9),
        (SHELL, "cpu", 3e-6),
        ((awkward(2_000), portrait_camera(150, 101)), "torch", 1e-9),
        # splats capped at 0.99, two behind each other, leave 1e-4 of the light: whether that is too little to go on is
        # a matter of rounding, and it is worth as much
        ((awkward(2_000), portrait_camera(150, 101)), "cpu", 1.2e-4),
    ],
)
def test_draws_the_reference(scene: tuple, engine: str, most: float) -> None:
    raw, camera = scene
    splats = tensors_of(activate(raw)).to("cpu", torch.float64 if engine == "torch" else torch.float32)
    found = rasterize(splats, camera, engine=engine).numpy()  # pyright: ignore[reportArgumentType]
    wanted = render_reference(activate(raw), camera)
    assert wanted[..., 3].mean() > 0.2
    assert np.abs(found - wanted).max() <= most


def test_oracle_gradients_are_finite_differences() -> None:
    splats, camera = few()
    background = torch.tensor([0.3, 0.6, 0.9], dtype=torch.float64)
    view = torch.tensor(camera.world_to_camera[:3])

    def picture(*inputs: "torch.Tensor") -> "torch.Tensor":
        *tensors, ground, rows = inputs
        matrix = torch.cat([rows, torch.tensor([[0, 0, 0, 1.0]])])
        return rasterize(GaussianTensors(*tensors), camera, ground, "torch", matrix)

    inputs = [tensor.clone().requires_grad_() for tensor in (*vars(splats).values(), background, view)]
    assert torch.autograd.gradcheck(picture, inputs, eps=1e-7, atol=1e-5, rtol=1e-4)


@pytest.fixture(scope="module")
def pairs() -> list[tuple[dict, dict]]:
    """Gradients of two scenes by the float32 kernels, and by the oracle in float64 from the same numbers."""
    hand, camera = few()
    scenes = ((hand.to("cpu", torch.float32), camera), (tensors_of(activate(SHELL[0])), SHELL[1]))
    return [
        (gradients(splats, camera, "cpu"), gradients(splats.to("cpu", torch.float64), camera, "torch"))
        for splats, camera in scenes
    ]


@pytest.mark.parametrize("name", NAMES)
def test_cpu_gradients_are_those_of_the_oracle(name: str, pairs: list[tuple[dict, dict]]) -> None:
    for found, wanted in pairs:
        assert wanted[name].abs().max() > 0
        assert worst(found[name], wanted[name]) <= 1e-5


def test_cpu_gradients_are_finite_differences() -> None:
    splats, camera = few()
    splats = splats.to("cpu", torch.float32)
    slopes = gradients(splats, camera, "cpu")
    weights = torch.randn(12, 14, 3, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    rng = torch.Generator().manual_seed(1)
    for name, tensor in vars(splats).items():
        way = torch.randn(tensor.shape, generator=rng) * tensor.abs().mean() * 1e-3
        sums = []
        for sign in (1, -1):
            moved = dataclasses.replace(splats, **{name: tensor + sign * way})
            image = rasterize(moved, camera, torch.tensor([0.3, 0.6, 0.9]), "cpu")
            sums.append(float((image * weights).sum()))
        assert (sums[0] - sums[1]) / 2 == pytest.approx(float((slopes[name] * way).sum()), rel=2e-2), name


def test_a_picture_behind_the_splats_has_its_gradient() -> None:
    splats, camera = few()
    scene, weights = (
        torch.rand(12, 14, 3, generator=torch.Generator().manual_seed(2)),
        torch.linspace(-1, 2, 12 * 14 * 3),
    )
    found = []
    for engine, dtype in (("cpu", torch.float32), ("torch", torch.float64)):
        leaves = [tensor.to(dtype).requires_grad_() for tensor in (*vars(splats).values(), scene)]
        image = rasterize(GaussianTensors(*leaves[:5]), camera, leaves[5], engine)  # pyright: ignore[reportArgumentType]
        found.append(torch.autograd.grad((image.flatten() * weights.to(dtype)).sum(), leaves))
    for single, wanted in zip(*found, strict=True):
        assert worst(single, wanted) <= 1e-5


def test_the_same_input_gives_the_same_bits() -> None:
    splats = tensors_of(activate(SHELL[0]))
    first, second = (gradients(splats, SHELL[1], "cpu") for _ in range(2))
    assert all(torch.equal(first[name], second[name]) for name in NAMES)


@pytest.mark.parametrize("engine", ["torch", "cpu"])
def test_ruined_splats_are_left_out_and_get_no_gradient(engine: str) -> None:
    splats, camera = tensors_of(activate(shell(600))), portrait_camera(48, 40)
    bad = torch.arange(600) % 3 == 0
    whole = GaussianTensors(*(tensor[~bad] for tensor in vars(splats).values()))
    for turn, index in enumerate(bad.nonzero()[:, 0].tolist()):
        tensor = list(vars(splats).values())[turn % 5]
        tensor[index] = (torch.nan, torch.inf, -torch.inf)[turn // 5 % 3]
    found, wanted = gradients(splats, camera, engine), gradients(whole, camera, engine)
    for name in NAMES[:5]:
        assert torch.allclose(found[name][~bad], wanted[name], rtol=1e-4, atol=1e-5 * float(wanted[name].abs().max()))
        assert not found[name][bad].any()


@pytest.mark.parametrize("engine", ["torch", "cpu"])
def test_nothing_to_draw_is_the_background(engine: str) -> None:
    splats, camera = few()
    splats = splats.to("cpu", torch.float32)
    behind = dataclasses.replace(splats, positions=splats.positions + torch.tensor([0.0, 0.0, 9.0]))
    none = GaussianTensors(*(tensor[:0] for tensor in vars(splats).values()))
    ground = torch.rand(12, 14, 3)
    for nothing in (behind, none):
        found = gradients(nothing, camera, engine)
        assert not any(found[name].any() for name in NAMES if name != "background")
        assert torch.equal(rasterize(nothing, camera, ground, engine), ground)  # pyright: ignore[reportArgumentType]


def test_auto_follows_the_tensors(monkeypatch: pytest.MonkeyPatch) -> None:
    splats, camera = few()
    taken = []
    for name in ("cpu", "oracle"):
        engine = getattr(door, name)
        draw = engine.render
        monkeypatch.setattr(engine, "render", lambda *inputs, name=name, draw=draw: taken.append(name) or draw(*inputs))
    assert rasterize(splats, camera).dtype == torch.float64
    assert rasterize(splats.to("cpu", torch.float32), camera).shape == (12, 14, 4)
    assert taken == ["oracle", "cpu"]


def test_without_cuda_one_line_says_so(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(cuda, "missing", lambda: "no CUDA device")
    monkeypatch.setattr(door, "_told", set())
    splats = tensors_of(activate(SHELL[0]))
    with caplog.at_level(logging.WARNING):
        images = [rasterize(splats, SHELL[1], engine=engine) for engine in ("cuda", "cuda", "cpu")]
    assert torch.equal(images[0], images[2])
    assert [record.message for record in caplog.records] == [
        "gsplat is not used (no CUDA device); splats are drawn by the engine 'cpu'"
    ]


def test_broken_cuda_is_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    if torch.cuda.is_available():
        pytest.skip("CUDA works here")
    monkeypatch.setattr(torch.cuda, "is_available", lambda: True)
    cuda.missing.cache_clear()
    reason = cuda.missing()
    cuda.missing.cache_clear()
    assert reason
    assert "\n" not in reason


def test_gsplat_draws_the_reference() -> None:
    reason = cuda.missing()
    if reason:
        pytest.skip(f"gsplat cannot draw here: {reason}")
    raw, camera = SHELL
    splats = tensors_of(activate(raw))
    splats = dataclasses.replace(splats, opacities=splats.opacities.clamp_max(0.99))
    found, wanted = gradients(splats, camera, "cuda"), gradients(splats.to("cpu", torch.float64), camera, "torch")
    assert all(worst(found[name], wanted[name]) <= 1e-2 for name in NAMES)
    image = rasterize(splats, camera, engine="cuda").numpy()
    assert np.abs(image - render_reference(activate(raw), camera)).max() <= 2 / 255


def test_raw_space_is_that_of_numpy() -> None:
    raw, _ = SHELL
    found = activated(RawTensors(*(torch.tensor(array) for array in vars(raw).values())))
    for name, wanted in vars(activate(raw)).items():
        tensor = getattr(found, name)
        tensor = torch.nn.functional.normalize(tensor, dim=1) if name == "wxyz" else tensor
        np.testing.assert_allclose(tensor.numpy(), wanted, rtol=1e-5, atol=1e-6)


def test_wrong_input_is_refused() -> None:
    splats, camera = few()
    with pytest.raises(ValueError, match="float32 on the CPU"):
        rasterize(splats, camera, engine="cpu")
    with pytest.raises(ValueError, match="engine must be"):
        rasterize(splats, camera, engine="fast")  # pyright: ignore[reportArgumentType]
    with pytest.raises(ValueError, match="world_to_camera"):
        rasterize(splats, camera, world_to_camera=torch.eye(3))
    with pytest.raises(ValueError, match="opacities of 5 splats must be"):
        dataclasses.replace(splats, opacities=splats.opacities[:, None])
    with pytest.raises(ValueError, match="bring them together"):
        dataclasses.replace(splats, colors=splats.colors.float())


def test_splats_that_would_fill_the_memory_are_refused_before_they_do() -> None:
    sound, camera = shell(60_000), portrait_camera(512, 512)
    huge = tensors_of(dataclasses.replace(activate(sound), scales=np.ones((60_000, 3), np.float32)))
    tracemalloc.start()
    with pytest.raises(cpu.TooManyPairs, match="far too large"):
        rasterize(huge, camera, engine="cpu")
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 32e6


def test_input_changed_before_backward_is_noticed() -> None:
    splats, camera = few()
    tensors = [tensor.float().requires_grad_() for tensor in vars(splats).values()]
    copies = [tensor * 1 for tensor in tensors]
    image = rasterize(GaussianTensors(*copies), camera, engine="cpu")
    copies[0] += 0.01
    with pytest.raises(RuntimeError, match="inplace"):
        image.sum().backward()
