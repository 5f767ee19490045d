"""What tables hold, and the paper's own: Tables 1 to 4 of *Gaussian Eigen Models for Human Heads*."""

from collections.abc import Mapping
from dataclasses import dataclass

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


@dataclass(frozen=True)
class PublishedSize:
    """One row of Table 4."""

    method: str
    maps: int
    """Texels along a side of the UV maps."""
    components: int | None
    psnr: float
    """Decibels, of about 1000 frames of one person from a novel view."""
    megabytes: float
    fps: float


SIZES_OF = "one person of NeRSemble from a novel view, on an A100: another data set and another machine"
SIZES = (
    PublishedSize("GEM", 128, 10, 31.81, 7, 237.96),
    PublishedSize("GEM", 128, 30, 34.20, 20, 241.31),
    PublishedSize("GEM", 128, 50, 34.67, 34, 238.7),
    PublishedSize("GEM", 256, 10, 31.88, 28, 210.03),
    PublishedSize("GEM", 256, 30, 34.17, 83, 208.19),
    PublishedSize("GEM", 256, 50, 34.61, 138, 201.70),
    PublishedSize("GEM", 512, 10, 32.23, 113, 130.46),
    PublishedSize("GEM", 512, 30, 34.84, 333, 112.73),
    PublishedSize("GEM", 512, 50, 35.45, 553, 117.45),
    PublishedSize("CNN", 128, None, 33.97, 82, 47.70),
    PublishedSize("CNN", 256, None, 34.99, 109, 35.77),
    PublishedSize("CNN", 512, None, 35.02, 178, 26.31),
    PublishedSize("Animatable Gaussians", 128, None, 33.77, 487, 18.93),
    PublishedSize("Animatable Gaussians", 256, None, 34.40, 529, 16.51),
    PublishedSize("Animatable Gaussians", 512, None, 35.15, 636, 13.08),
)
"""Table 4 (components and map sizes)."""
