"""What tables hold, and the paper's own: Tables 1, 2 and 3 of *Gaussian Eigen Models for Human Heads*."""

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
CROSSING_BY = "EmoNet's features and FID on images, on NeRSemble: other networks and another data set"
CROSSING: Mapping[str, Mapping[str, float]] = {
    "GEM": {"cosine": 0.9381, "l1": 5.3197, "frechet": 0.4286, "fps": 201.70},
    "CNN": {"cosine": 0.9440, "l1": 5.1044, "frechet": 0.3685, "fps": 35.77},
    "Gaussian Avatars": {"cosine": 0.8917, "l1": 6.6141, "frechet": 0.5593, "fps": 142.71},
    "Animatable Gaussians": {"cosine": 0.9396, "l1": 5.3399, "frechet": 0.4093, "fps": 16.51},
    "INSTA": {"cosine": 0.9087, "l1": 6.3153, "frechet": 0.5299, "fps": 20.62},
}
"""Method -> column -> value of Table 3 (cross-reenactment)."""
