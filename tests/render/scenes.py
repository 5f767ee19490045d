"""Splats to draw in tests: random ones, and what no driver should be asked to draw."""

import numpy as np
from gemheads.render.camera import Camera, orbit
from gemheads.render.gaussians import RawGaussians


def portrait_camera(width: int = 512, height: int = 512) -> Camera:
    """Half a metre in front of the origin, a little to the side."""
    return orbit((0, 0, 0), 0.6, 20, 10, 25, width, height)


def shell(count: int, seed: int = 0) -> RawGaussians:
    """Splats of random shape, opacity and colour on and about a sphere of a head's size: dense, as avatars are."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return _raw(
        directions * 0.1 * rng.uniform(0.9, 1.1, (count, 1)),
        rng.normal(size=(count, 4)),
        np.log(0.0012) + 0.5 * rng.normal(size=(count, 3)),
        1 + 2 * rng.normal(size=count),
        rng.random((count, 3)),
    )


def awkward(count: int, seed: int = 1) -> RawGaussians:
    """Valid but unkind: behind the camera, off screen, needles, discs, huge, opaque, invisible."""
    rng = np.random.default_rng(seed)
    positions = rng.normal(size=(count, 3)) * 0.4
    log_scales = np.log(0.002) + rng.normal(size=(count, 3))
    log_scales[::17, 0] = -18
    log_scales[::19] = np.float32([-3, -12, -12])
    log_scales[::501] = -1
    logits = 2 * rng.normal(size=count)
    logits[::5] = 30
    logits[::7] = -30
    return _raw(positions, rng.normal(size=(count, 4)), log_scales, logits, rng.random((count, 3)))


def spoiled(raw: RawGaussians, every: int = 3) -> RawGaussians:
    """The same splats with every third one ruined: NaN, infinite, absurdly far, or absurdly large."""
    copy = RawGaussians(*(array.copy() for array in vars(raw).values()))
    bad = np.arange(0, len(raw), every)
    poisons = (np.nan, np.inf, -np.inf, 1e30, -1e30)
    targets = (copy.positions, copy.wxyz, copy.log_scales, copy.opacity_logits[:, None])
    for turn, index in enumerate(bad):
        target = targets[turn % len(targets)]
        poison = poisons[turn // len(targets) % len(poisons)]
        if target is targets[3] and np.isfinite(poison):
            poison = np.nan  # a large finite logit is a valid splat
        target[index, turn % target.shape[1]] = poison
    return copy


def kept(raw: RawGaussians, every: int = 3) -> RawGaussians:
    """What ``spoiled`` leaves whole."""
    whole = np.arange(len(raw)) % every != 0
    return RawGaussians(*(array[whole] for array in vars(raw).values()))


def psnr(image: np.ndarray, reference: np.ndarray) -> float:
    """Decibels over all four channels."""
    return float(-10 * np.log10(np.mean((image.astype(np.float64) - reference) ** 2) + 1e-20))


def _raw(*arrays: np.ndarray) -> RawGaussians:
    return RawGaussians(*(array.astype(np.float32) for array in arrays))
