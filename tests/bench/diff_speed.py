"""Milliseconds of differentiable splatting, forward and backward, against the torch oracle, and gsplat where it draws:

    python tests/bench/diff_speed.py [--runs 30] [--oracle-runs 3]

Engines take turns, so that a machine that is busy now and then is so for all; the least and the median are printed.
"""

import argparse
import os
import time

os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import torch
from gemheads.app.bench.synthetic import synthetic_gem
from gemheads.app.performing.portrait import portrait
from gemheads.models.gem import Viewing
from gemheads.render.camera import Camera
from gemheads.render.diff import cuda
from gemheads.render.diff.rasterize import rasterize
from gemheads.render.diff.tensors import GaussianTensors, tensors_of
from gemheads.render.gaussians import activate
from torch import Tensor

SCENES = ((4_000, 128), (15_000, 256), (60_000, 256), (60_000, 512))


def head(count: int, device: str) -> GaussianTensors:
    """The scene of `gemheads bench`: flat splats on an ellipsoid that they cover without holes."""
    gem = synthetic_gem(count, 1, np.random.default_rng(0))
    splats = tensors_of(activate(gem.compose(gem.rest_coefficients))).to(device)
    return GaussianTensors(*(tensor.requires_grad_() for tensor in vars(splats).values()))


def step(splats: GaussianTensors, camera: Camera, engine: str, weights: Tensor) -> tuple[float, float]:
    """Seconds forward and in all; the pixels' ``weights`` are where the splats are."""
    device = weights.device
    background = torch.ones(3, requires_grad=True, device=device)
    view = torch.tensor(camera.world_to_camera, dtype=torch.float32, device=device).requires_grad_()
    _finish(device)
    started = time.perf_counter()
    image = rasterize(splats, camera, background, engine, view)  # type: ignore[arg-type]
    _finish(device)
    drawn = time.perf_counter()
    torch.autograd.grad((image * weights).sum(), [*vars(splats).values(), background, view])
    _finish(device)
    return drawn - started, time.perf_counter() - started


def _finish(device: torch.device) -> None:
    if device.type == "cuda":
        torch.cuda.synchronize()


def main() -> None:
    """Measure and print one row per scene."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=30)
    parser.add_argument("--oracle-runs", type=int, default=3)
    wish = parser.parse_args()
    reason = cuda.missing()
    print(f"gsplat: {reason or torch.cuda.get_device_name()}")
    print("ms, least (median)     forward        forward+backward     torch oracle        median over median", end="")
    print("" if reason else "      gsplat, forward        forward+backward")
    for count, side in SCENES:
        splats, camera = head(count, "cpu"), portrait(Viewing((0.0, 0.0, 0.0), 0.23), side, side)
        weights = torch.randn(side, side, 3, generator=torch.Generator().manual_seed(0))
        step(splats, camera, "cpu", weights)
        own, oracle = [], []
        for _ in range(wish.oracle_runs):
            own += [step(splats, camera, "cpu", weights) for _ in range(max(1, wish.runs // wish.oracle_runs))]
            oracle.append(step(splats, camera, "torch", weights)[1])
        forward, both = 1e3 * np.array(own).T
        slow = 1e3 * np.array(oracle)
        print(
            f"{count:6} splats {side:3}^2  {forward.min():6.1f} ({np.median(forward):5.1f})"
            f"   {both.min():6.1f} ({np.median(both):5.1f})    {slow.min():8.0f} ({np.median(slow):5.0f})"
            f"       {np.median(slow) / np.median(both):5.1f}x",
            end="",
        )
        print("" if reason else _gsplat(head(count, "cuda"), camera, weights.to("cuda"), wish.runs))


def _gsplat(splats: GaussianTensors, camera: Camera, weights: Tensor, runs: int) -> str:
    step(splats, camera, "cuda", weights)
    forward, both = 1e3 * np.array([step(splats, camera, "cuda", weights) for _ in range(runs)]).T
    return f"    {forward.min():6.1f} ({np.median(forward):5.1f})  {both.min():6.1f} ({np.median(both):5.1f})"


if __name__ == "__main__":
    main()
