"""Pictures of a learned avatar as the cameras of its capture see it."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from ....render.diff.rasterize import rasterize
from ....render.diff.tensors import GaussianTensors, RawTensors, activate
from ...captures.headmotion import posed
from ...captures.layout import Shot, Tracked
from ...captures.reader import Capture
from ...captures.texels import Texels
from ..losses import psnr
from ..synthesis.torchgem import pose_head
from ..synthesis.views import View, view_of
from .avatar import Avatar
from .moments import Moments
from .residuals import Residuals


class Scene:
    """An avatar, its capture, and what of the two is needed for a picture; all on one device."""

    def __init__(self, capture: Capture, texels: Texels, avatar: Avatar, device: torch.device) -> None:
        self.capture, self.texels, self.avatar, self.device = capture, texels, avatar, device
        self.moments = Moments(capture, texels, device)
        weights = texels.spread(capture.template.neck_weights)
        self._neck = weights, capture.template.neck_pivot
        self._neck_weights = torch.from_numpy(weights).float().to(device)
        self._pivot = torch.from_numpy(np.array(capture.template.neck_pivot, np.float32)).to(device)

    def splats(self, timestep: int, bare: bool = False) -> tuple[RawTensors, Residuals]:
        """The avatar at one moment, with the head's pose, and how far it is from the ``bare`` surface."""
        moment = self.moments[timestep]
        raw, residuals = self.avatar(moment, bare)
        return pose_head(raw, self._neck_weights, self._pivot, moment.rotation, moment.translation), residuals

    def surface(self, mesh: Tracked) -> NDArray[np.floating]:
        """[N, 3] where the texels of a tracked mesh are, metres, in the world."""
        return posed(self.texels.spread(mesh.vertices), *self._neck, mesh.rotation, mesh.translation)

    def view(self, shot: Shot, background: Sequence[float] | None = None) -> View:
        """A shot over a background, on the scene's device; see ``view_of``."""
        return view_of(self.capture, shot, background, self.device)

    def draw(self, splats: GaussianTensors, view: View) -> Tensor:
        """[H, W, 3] what the view's camera sees, over its background."""
        return rasterize(splats, view.camera, view.background)

    def seen(self, shot: Shot, bare: bool = False) -> tuple[Tensor, Tensor]:
        """The picture that was taken and the avatar's, both [H, W, 3] in [0, 1] without gradients."""
        with torch.no_grad():
            view = self.view(shot)
            image = self.draw(activate(self.splats(shot.timestep, bare)[0]), view)
            return view.picture, image.clamp(0, 1)

    def quality(self, shots: Sequence[Shot], bare: bool = False) -> float:
        """Mean PSNR over shots, decibels; NaN for none."""
        values = []
        for shot in shots:
            truth, image = self.seen(shot, bare)
            values.append(psnr(image, truth))
        return float(np.mean(values)) if values else float("nan")
