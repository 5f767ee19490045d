"""Texture maps: reading, sampling smoothly, and which way their strokes run."""

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats


def load_map(path: Path) -> NDArray[np.float32]:
    """An image as RGBA [H, W, 4] in [0, 1], as stored (sRGB-encoded)."""
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise FileNotFoundError(f"{path} is missing or not an image")
    if image.ndim == 2:
        image = cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    if image.shape[2] == 3:
        image = cv2.cvtColor(image, cv2.COLOR_BGR2BGRA)
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGRA2RGBA), np.float32) / np.float32(255)


def sample_map(image: Floats, uv: Floats) -> NDArray[np.float32]:
    """[N, C] bicubic samples at ``uv`` [N, 2] (v upwards, wraps round), clipped to [0, 1]."""
    height, width = image.shape[:2]
    if not len(uv):
        return np.zeros((0, image.shape[2]), np.float32)
    x = (uv[:, 0] % 1 * width - 0.5).astype(np.float32)
    y = ((1 - uv[:, 1]) % 1 * height - 0.5).astype(np.float32)
    block = 30000  # cv2.remap's maps must stay below 32768 rows
    parts = [
        cv2.remap(
            np.asarray(image, np.float32),
            x[i : i + block, None],
            y[i : i + block, None],
            cv2.INTER_CUBIC,
            borderMode=cv2.BORDER_REPLICATE,
        )
        for i in range(0, len(x), block)
    ]
    return np.clip(np.concatenate(parts).reshape(len(uv), -1), 0, 1).astype(np.float32)


def strokes(image: Floats, smooth_px: float) -> NDArray[np.float32]:
    """Direction of the strokes at each pixel as cos and sin of twice the angle in (u, v) [H, W, 2].

    The structure tensor's weaker eigenvector, averaged over ``smooth_px``.
    """
    gray = np.asarray(image[..., :3].mean(-1) * image[..., 3], np.float32)
    gx = cv2.Scharr(gray, cv2.CV_32F, 1, 0)
    gy = -cv2.Scharr(gray, cv2.CV_32F, 0, 1)
    size = (0, 0)
    xx, yy, xy = (cv2.GaussianBlur(g, size, smooth_px) for g in (gx * gx, gy * gy, gx * gy))
    # The gradient's double angle is (xx - yy, 2 xy); strokes run across it.
    double = -np.stack([xx - yy, 2 * xy], -1)
    return double / np.maximum(np.linalg.norm(double, axis=-1, keepdims=True), 1e-12)


def encoded(linear: Floats) -> Floats:
    """Linear light to sRGB."""
    linear = np.clip(linear, 0, None)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def linear(srgb: Floats) -> Floats:
    """sRGB to linear light."""
    srgb = np.asarray(srgb, float)
    return np.where(srgb <= 0.04045, srgb / 12.92, ((np.maximum(srgb, 0) + 0.055) / 1.055) ** 2.4)
