"""Where skin folds when it is pushed together: forehead, brows, eyes, nose, cheeks and chin."""

import numpy as np

from ...render.arrays import Floats
from .noise import value_noise

MM = 1e-3


def creases(canvas: Floats, seed: int) -> Floats:
    """How deep [N] in 0..1 each point of the canvas [N, 3] lies in a line that folding would deepen."""
    x, y = np.abs(canvas[:, 0]) / MM, canvas[:, 1] / MM
    bend = 1.6 * value_noise(canvas, 28 * MM, seed + 31) + 0.5 * value_noise(canvas, 9 * MM, seed + 32)
    uneven = np.clip(0.8 + 0.5 * value_noise(canvas, 18 * MM, seed + 33), 0.25, 1)
    lines = [
        _window(x, 0, 44) * _window(y, 50, 22) * _rows(y + bend - 0.003 * x * x, 8.5, 1.0),  # forehead
        _window(x, 8.5, 3.5) * _window(y, 17, 13) * _rows(x + 0.4 * bend + 0.10 * (y - 17), 11.0, 1.0),  # between brows
        _window(x, 0, 11) * _window(y, -4, 9) * _rows(y + 0.25 * x + bend, 5.5, 0.8),  # bridge of the nose
        _window(x, 31, 17) * _bell(y + 17 - 0.018 * (x - 32) ** 2 + 0.5 * bend, 1.2),  # under the eye
        _window(x, 31, 17) * _bell(y + 21 - 0.018 * (x - 32) ** 2 + 0.7 * bend, 1.2),
        _window(x, 0, 17) * _bell(y + 96 - 0.02 * x * x + 0.4 * bend, 2.2),  # above the chin
        _fold(x + 0.6 * bend, y),
    ]
    angle = np.arctan2(y + 1 + 0.3 * bend, np.maximum(x - 38, 0.1))
    fan = _bell((angle * 4.2 + 0.3 * bend) % 1.0 - 0.5, 0.12) * (np.abs(angle) < 0.9)
    lines.append(fan * np.clip((x - 45) / 4, 0, 1) * np.clip((70 - x) / 12, 0, 1))  # beside the eye
    front = np.clip((canvas[:, 2] + 0.075) / 0.03, 0, 1)
    return np.clip(np.max(lines, axis=0) * uneven * front, 0, 1)


def _fold(x: Floats, y: Floats) -> Floats:
    """From the wing of the nose past the corner of the mouth."""
    path = np.interp(y, [-90, -72, -55, -40], [39.0, 35.0, 28.0, 20.0])
    return 0.7 * _bell(x - path, 2.2) * _window(y, -56, 15)


def _rows(height: Floats, apart: float, wide: float) -> Floats:
    """Lines ``apart`` millimetres from each other, ``wide`` across."""
    return _bell((height % apart) - apart / 2, wide)


def _bell(values: Floats, wide: float) -> Floats:
    return np.exp(-((values / wide) ** 2))


def _window(values: Floats, middle: float, reach: float) -> Floats:
    return np.exp(-(((values - middle) / reach) ** 4))
