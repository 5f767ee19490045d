"""What tables of pictures hold, and the paper's own: Tables 1 and 2 of *Gaussian Eigen Models for Human Heads*."""

from collections.abc import Mapping

METRICS = ("PSNR", "SSIM", "LPIPS", "L1", "FLIP")
"""PSNR in decibels; the others have no unit."""
LARGER_IS_BETTER = frozenset({"PSNR", "SSIM"})
DIGITS: Mapping[str, int] = {"PSNR": 2, "SSIM": 4, "LPIPS": 4, "L1": 4, "FLIP": 4}
"""Behind the point."""
DATA_SET = "NeRSemble, real people, 802x550: another data set"
PUBLISHED: Mapping[str, Mapping[str, Mapping[str, float]]] = {
    "val": {
        "GEM": {"PSNR": 33.5528, "SSIM": 0.9662, "LPIPS": 0.0678, "L1": 0.0061},
        "CNN": {"PSNR": 32.4622, "SSIM": 0.9617, "LPIPS": 0.0713, "L1": 0.0067},
        "Gaussian Avatars": {"PSNR": 31.3197, "SSIM": 0.9567, "LPIPS": 0.0786, "L1": 0.0075},
    },
    "test": {
        "GEM": {"PSNR": 32.6781, "SSIM": 0.9633, "LPIPS": 0.0675, "L1": 0.0069},
        "CNN": {"PSNR": 29.2454, "SSIM": 0.9448, "LPIPS": 0.0777, "L1": 0.0096},
        "Gaussian Avatars": {"PSNR": 28.3137, "SSIM": 0.9433, "LPIPS": 0.0815, "L1": 0.0102},
    },
}
"""Split -> method -> metric -> mean: val is Table 1 (novel view), test is Table 2 (novel expression). Of another data
set: they say what to expect, not who wins. FLIP is not among them."""
