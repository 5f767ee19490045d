"""A picture with the camera that took it and the ground behind: what a fit is measured by."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from ....render.camera import Camera
from ...captures.layout import Shot
from ...captures.reader import Capture


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


def view_of(
    capture: Capture,
    shot: Shot,
    background: Sequence[float] | None = None,
    device: torch.device | str = "cpu",
) -> View:
    """A shot over a background; without a mask, or with None, over the one it was taken against.

    Raises CaptureError where the capture changed since it was opened.
    """
    rgba = capture.read(shot)
    # without a mask, what is behind belongs to the picture
    ground = capture.ground(shot) if background is None or rgba[..., 3].min() == 255 else background
    return views_of([rgba], [shot.camera], ground, device)[0]


def views_of(
    pictures: Sequence[NDArray[np.generic]],
    cameras: Sequence[Camera],
    background: Sequence[float],
    device: torch.device | str = "cpu",
) -> list[View]:
    """Views on a device of RGB or straight RGBA pictures (uint8 or floats in [0, 1]); ValueError says which does not
    fit."""
    if not pictures or len(pictures) != len(cameras):
        raise ValueError(f"every picture needs its camera: {len(pictures)} pictures, {len(cameras)} cameras")
    ground = torch.tensor(background, dtype=torch.float32, device=device)
    if ground.shape != (3,):
        raise ValueError(f"a background is one RGB colour, got {background}")
    views = []
    for index, (picture, camera) in enumerate(zip(pictures, cameras, strict=True)):
        if picture.ndim != 3 or picture.shape[2] not in (3, 4):
            raise ValueError(f"picture {index} must be [H, W, 3] or [H, W, 4], got {picture.shape}")
        if picture.shape[:2] != (camera.height, camera.width):
            size = f"{picture.shape[1]}x{picture.shape[0]}"
            raise ValueError(f"picture {index} is {size}, its camera {camera.width}x{camera.height}")
        bytes_ = picture.dtype == np.uint8
        values = torch.from_numpy(np.ascontiguousarray(picture)).to(device).float() / (255 if bytes_ else 1)
        if not (bytes_ or torch.isfinite(values).all()):
            raise ValueError(f"picture {index} holds values that are not finite")
        if values.shape[2] == 4:
            values = values[..., :3] * values[..., 3:] + ground * (1 - values[..., 3:])
        views.append(View(values.contiguous(), camera, ground))
    return views
