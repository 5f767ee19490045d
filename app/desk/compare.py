"""A and B beside each other: all components and those in use, or where they differ. Pure."""

import numpy as np

from ...render.arrays import Image

GAIN = 8.0
"""The error map shows differences so many times enlarged."""
EXACT_DB = 100.0
"""Said of pictures that are the same."""


def joined(left: Image, right: Image, split: float) -> Image:
    """``left`` up to the split in [0, 1] of the width, ``right`` from there on; both [H, W, 3|4]."""
    column = round(split * left.shape[1])
    depth = min(left.shape[2], right.shape[2])
    return np.concatenate([left[:, :column, :depth], right[:, column:, :depth]], 1)


def heat(whole: Image, used: Image) -> Image:
    """[H, W, 3] the largest difference of a channel, GAIN times enlarged: black over violet and orange to white."""
    import cv2

    error = cv2.absdiff(np.ascontiguousarray(whole[..., :3]), np.ascontiguousarray(used[..., :3])).max(2)
    scaled = cv2.convertScaleAbs(error, alpha=GAIN)
    return cv2.cvtColor(cv2.applyColorMap(scaled, cv2.COLORMAP_INFERNO), cv2.COLOR_BGR2RGB)


def decibels(whole: Image, used: Image) -> float:
    """PSNR in dB of colours; EXACT_DB where nothing differs."""
    difference = whole[..., :3].astype(np.float32) - used[..., :3]
    mean = float(np.square(difference).mean())
    return EXACT_DB if mean == 0 else min(EXACT_DB, 10 * np.log10(255**2 / mean))
