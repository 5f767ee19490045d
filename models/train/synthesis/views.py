"""A picture with the camera that took it and the ground behind: what a fit is measured by."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from ....render.camera import Camera


@dataclass(frozen=True)
class View:
    """One picture."""

    picture: Tensor
    """[H, W, 3] float32 in [0, 1]."""
    camera: Camera
    background: Tensor
    """[3] RGB in [0, 1]."""

    def shrunk(self, side: int | None) -> "View":
        """The same view by whole pixels smaller, so that the longer side has about ``side`` of them; None: as it is."""
        factor = 1 if side is None else max(1, round(max(self.camera.width, self.camera.height) / side))
        if factor == 1:
            return self
        small = functional.avg_pool2d(self.picture.permute(2, 0, 1), factor).permute(1, 2, 0).contiguous()
        height, width = small.shape[:2]
        old = self.camera
        camera = Camera(
            old.fx / factor, old.fy / factor, old.cx / factor, old.cy / factor, width, height, old.world_to_camera
        )
        return replace(self, picture=small, camera=camera)


def views_of(
    pictures: Sequence[NDArray[np.generic]], cameras: Sequence[Camera], background: Sequence[float]
) -> list[View]:
    """Views of RGB or straight RGBA pictures (uint8 or floats in [0, 1]); ValueError says which does not fit."""
    if not pictures or len(pictures) != len(cameras):
        raise ValueError(f"every picture needs its camera: {len(pictures)} pictures, {len(cameras)} cameras")
    ground = torch.tensor(background, dtype=torch.float32)
    if ground.shape != (3,):
        raise ValueError(f"a background is one RGB colour, got {background}")
    views = []
    for index, (picture, camera) in enumerate(zip(pictures, cameras, strict=True)):
        if picture.ndim != 3 or picture.shape[2] not in (3, 4):
            raise ValueError(f"picture {index} must be [H, W, 3] or [H, W, 4], got {picture.shape}")
        if picture.shape[:2] != (camera.height, camera.width):
            size = f"{picture.shape[1]}x{picture.shape[0]}"
            raise ValueError(f"picture {index} is {size}, its camera {camera.width}x{camera.height}")
        values = torch.from_numpy(np.ascontiguousarray(picture)).float() / (255 if picture.dtype == np.uint8 else 1)
        if not torch.isfinite(values).all():
            raise ValueError(f"picture {index} holds values that are not finite")
        if values.shape[2] == 4:
            values = values[..., :3] * values[..., 3:] + ground * (1 - values[..., 3:])
        views.append(View(values.contiguous(), camera, ground))
    return views
