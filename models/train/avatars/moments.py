"""Tracked meshes of a capture as the network needs them, some kept in memory."""

from collections import OrderedDict

import torch

from ...captures.reader import Capture
from ...captures.texels import Texels
from .deform import Moment, moment_of

KEPT_BYTES = 2 << 30
"""Of memory, on the device: at 128 x 128 texels 2,000 moments, at 256 x 256 some 500."""


class Moments:
    """The moments of a capture by timestep; memory does not grow with the capture."""

    def __init__(self, capture: Capture, texels: Texels, device: torch.device | str) -> None:
        self._capture, self._texels, self._device = capture, texels, device
        self._kept: OrderedDict[int, Moment] = OrderedDict()
        self._bytes = 0

    def __getitem__(self, timestep: int) -> Moment:
        """Raises CaptureError where the capture changed since it was opened."""
        if timestep not in self._kept:
            moment = moment_of(self._texels, self._capture.tracked(timestep), self._device)
            self._kept[timestep] = moment
            self._bytes += moment.bytes()
            while self._bytes > KEPT_BYTES and len(self._kept) > 1:
                self._bytes -= self._kept.popitem(last=False)[1].bytes()
        self._kept.move_to_end(timestep)
        return self._kept[timestep]
