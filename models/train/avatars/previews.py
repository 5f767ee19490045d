"""Pictures to judge a training by: held-out shots beside what is drawn of them, and the curve of the loss."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from ...captures.pictures import png_bytes
from ...wholefile import write_whole
from ..synthesis.fit import error_map

Pixels = NDArray[np.uint8]
_INK, _FAINT, _DOTS = (40, 40, 40), (225, 225, 225), (170, 190, 225)
_LINE = (30, 80, 170)
_SIZE, _MARGIN = (420, 760), (20, 20, 40, 70)
"""Height and width of the curve, and its margins at the top, right, bottom and left, pixels."""


def comparison(pairs: Sequence[tuple[Tensor, Tensor]]) -> Pixels:
    """Rows of truth | rendered | error, where an error of 0.1 is white; pictures [H, W, 3] in [0, 1]."""
    rows = []
    for truth, image in pairs:
        drawn, wanted = (x.detach().cpu().numpy() for x in (image, truth))
        pictures = [np.round(255 * np.clip(x, 0, 1)).astype(np.uint8) for x in (wanted, drawn)]
        rows.append(np.concatenate([*pictures, error_map(drawn, wanted)], 1))
    widest = max(row.shape[1] for row in rows)
    padded = [np.pad(row, ((0, 4), (0, widest - row.shape[1]), (0, 0)), constant_values=255) for row in rows]
    return np.concatenate(padded)


def loss_curve(steps: NDArray[np.floating], losses: NDArray[np.floating]) -> Pixels:
    """The loss over the steps, its scale logarithmic: each value as a dot, their running mean as a line."""
    height, width = _SIZE
    top, right, bottom, left = _MARGIN
    picture = np.full((height, width, 3), 255, np.uint8)
    sound = np.isfinite(losses) & (losses > 0)
    if sound.sum() < 2:
        return picture
    steps, logs = np.asarray(steps[sound], np.float64), np.log10(losses[sound].astype(np.float64))
    low, high = np.percentile(logs, [0, 99.5])
    low, high = low - 0.05, max(high, low + 0.1) + 0.05
    first, last = steps[0], max(steps[-1], steps[0] + 1)

    def place(x: NDArray[np.floating], y: NDArray[np.floating]) -> NDArray[np.int32]:
        across = left + (x - first) / (last - first) * (width - left - right)
        down = top + (high - y) / (high - low) * (height - top - bottom)
        return np.stack([across, np.clip(down, top, height - bottom)], -1).round().astype(np.int32)

    for level in np.linspace(low, high, 6):
        y = int(place(np.array([first]), np.array([level]))[0, 1])
        cv2.line(picture, (left, y), (width - right, y), _FAINT)
        _write(picture, f"{10**level:.3g}", (8, y + 4))
    for step in np.linspace(first, last, 6):
        x = int(place(np.array([step]), np.array([low]))[0, 0])
        _write(picture, f"{step:.0f}", (x - 14, height - 14))
    _write(picture, "loss", (8, 14))
    _write(picture, "step", (8, height - 14))
    for x, y in place(steps, logs):
        cv2.circle(picture, (int(x), int(y)), 1, _DOTS, -1)
    window = max(1, len(logs) // 40)
    mean = np.convolve(logs, np.full(window, 1 / window), "valid")
    line = place(steps[window - 1 :], mean)
    cv2.polylines(picture, [line.reshape(-1, 1, 2)], False, _LINE, 2, cv2.LINE_AA)
    return picture


def loss_table(rows: Sequence[Sequence[float]], terms: Sequence[str]) -> str:
    """CSV of rows: the step, its ``terms``, and the loss."""
    lines = [",".join(["step", *terms, "loss"])]
    lines += [",".join([f"{row[0]:.0f}", *(f"{value:.6g}" for value in row[1:])]) for row in rows]
    return "\n".join(lines) + "\n"


def write_png(path: Path, picture: Pixels) -> None:
    """Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, [png_bytes(picture)])


def _write(picture: Pixels, text: str, place: tuple[int, int]) -> None:
    cv2.putText(picture, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.42, _INK, 1, cv2.LINE_AA)
