"""Pictures of high dynamic range (PQ, HLG) or of BT.2020's colours, as sRGB: what is brighter than white is white."""

import cv2
import numpy as np
from numpy.typing import NDArray

PQ, HLG = 16, 18
"""The numbers of their transfer in H.273."""
BT2020 = 9
"""That of its primaries."""
WHITE_NITS = 203
"""Of white paper in such pictures (ITU-R BT.2408)."""
_HLG_NITS, _HLG_GAMMA = 1000, 1.2
"""Of the display that HLG is told for (ITU-R BT.2100), and how much more than light of the scene it shows."""
_WEIGHTS = np.array([[0.2627, 0.6780, 0.0593]], np.float32)
"""Of red, green and blue in the luminance of BT.2020."""
_TO_BT709 = np.array(
    [[1.660491, -0.587641, -0.072850], [-0.124550, 1.132900, -0.008349], [-0.018151, -0.100579, 1.118730]], np.float32
)
_STEPS = 4096


def is_no_srgb(transfer: int, primaries: int) -> bool:
    """Whether pictures with these numbers of H.273 are shown wrongly as if they were sRGB."""
    return transfer in (PQ, HLG) or primaries == BT2020


def as_srgb(rgb: NDArray[np.uint16], transfer: int, primaries: int) -> NDArray[np.uint8]:
    """[H, W, 3] sRGB of [H, W, 3] RGB of 16 bits, as 8 are too few in the dark, with these numbers of H.273."""
    light = _LIGHT.get(transfer, _SRGB_LIGHT)[rgb]
    if transfer == HLG:
        luminance = cv2.transform(light, _WEIGHTS)
        light *= np.power(luminance, np.float32(_HLG_GAMMA - 1))[..., None] * np.float32(_HLG_NITS / WHITE_NITS)
    if primaries == BT2020:
        light = cv2.transform(light, _TO_BT709)
    roots = np.sqrt(np.clip(light, 0, 1))  # so that steps in the dark are fine enough for one table
    return _BYTES[(roots * (_STEPS - 1) + np.float32(0.5)).astype(np.uint16)]


def _pq_light(signal: NDArray[np.float64]) -> NDArray[np.float32]:
    """SMPTE ST 2084, in units of white."""
    root = signal ** (1 / 78.84375)
    nits = 10000 * (np.maximum(root - 0.8359375, 0) / (18.8515625 - 18.6875 * root)) ** (1 / 0.1593017578125)
    return (nits / WHITE_NITS).astype(np.float32)


def _hlg_light(signal: NDArray[np.float64]) -> NDArray[np.float32]:
    """Light of the scene of ARIB STD-B67, in [0, 1]."""
    a, b, c = 0.17883277, 0.28466892, 0.55991073
    return np.where(signal <= 0.5, signal**2 / 3, (np.exp((signal - c) / a) + b) / 12).astype(np.float32)


def _srgb_light(signal: NDArray[np.float64]) -> NDArray[np.float32]:
    return np.where(signal <= 0.04045, signal / 12.92, ((signal + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _srgb_signal(light: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)


_SIGNALS = np.arange(65536) / 65535
_LIGHT = {PQ: _pq_light(_SIGNALS), HLG: _hlg_light(_SIGNALS)}
_SRGB_LIGHT = _srgb_light(_SIGNALS)
_BYTES = np.round(255 * _srgb_signal((np.arange(_STEPS) / (_STEPS - 1)) ** 2)).astype(np.uint8)
