"""What an avatar's expression adds to the turn of its head as the tracker reads it.

Raised brows tip a head that stays still, a smile lifts it. An avatar shall turn so that its turn is read as its
driver's is, whatever its face does. How much of a turn is read on a face at rest differs between heads, too, and is
left as it is: an avatar that nods further than its driver, to be read alike, looks elsewhere and moves its brows.
"""

import numpy as np
import torch
from torch import Tensor, nn

from .response import TYPICAL, Responses
from .threads import one_torch_thread

HIDDEN = 48
"""Width of the two bent layers: a shape tips a head by degrees, and hardly otherwise when the head is turned."""
FARTHEST = np.radians([30.0, 45.0, 20.0])
"""Pitch, yaw and roll up to which pictures were seen, about; beyond, an expression adds what it adds there."""
MOST = float(np.radians(12.0))
"""No expression adds more; one face in a thousand of those learned from adds 9 degrees."""
LOST = 0.3
"""Radians; what is misread so far is another face, or none."""
TIMES = 2
"""What an expression adds depends on the turn that is drawn, which is what is asked for: begun with the driver's, it is
looked for so many times, and found to a tenth of a degree in ninety-nine of a hundred faces."""
UNIT = float(np.radians(1.0))
"""In which a miss is counted: half as large as what is misread."""


class PoseResponse(nn.Module):
    """Control weights [B, E] and the head's rotation [B, 3] (radians) to what the expression adds to the rotation that
    is read [B, 3], radians."""

    farthest: Tensor

    def __init__(self, controls: int) -> None:
        super().__init__()
        self.register_buffer("farthest", torch.tensor(FARTHEST, dtype=torch.float32))
        self.expression = nn.Linear(controls, HIDDEN, bias=False)
        self.rotation = nn.Linear(3, HIDDEN)
        self.bend = nn.Sequential(nn.SiLU(), nn.Linear(HIDDEN, HIDDEN), nn.SiLU(), nn.Linear(HIDDEN, 3))
        self.linear = nn.Linear(controls, 3, bias=False)

    def misread(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """[B, 3] all that is read beyond the rotation, which is what pictures tell, in UNIT."""
        turned = self._turned(rotation)
        return self.linear(weights) + self.bend(turned + self.expression(weights))

    def forward(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """What is read beyond that of a face at rest."""
        turned = self._turned(rotation)
        bent = self.bend(turned + self.expression(weights)) - self.bend(turned)
        return (UNIT * (self.linear(weights) + bent)).clamp(-MOST, MOST)

    def turn(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """[B, 3] by which to turn a head with the expression ``weights`` so that ``rotation`` is read on it as if its
        face were at rest."""
        drawn = rotation
        for _ in range(TIMES):
            drawn = rotation - self(weights, drawn)
        return drawn

    def _turned(self, rotation: Tensor) -> Tensor:
        within = torch.minimum(torch.maximum(rotation, -self.farthest), self.farthest)
        return self.rotation(within / TYPICAL)


@one_torch_thread()
def fit_pose_response(seen: Responses, steps: int, seed: int) -> PoseResponse:
    """Learns it from an avatar's pictures. Its parameters are frozen."""
    torch.manual_seed(seed)
    model = PoseResponse(seen.weights.shape[1])
    misread = seen.seen_rotations - seen.rotations
    kept = np.abs(misread).max(1) < LOST
    weights, rotations, wanted = (
        torch.from_numpy(array[kept].astype(np.float32)) for array in (seen.weights, seen.rotations, misread / UNIT)
    )
    optimizer = torch.optim.AdamW(model.parameters(), 4e-3, weight_decay=1e-3, fused=True)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    for _ in range(steps if len(weights) else 0):
        batch = torch.randint(len(weights), (256,))
        loss = nn.functional.huber_loss(model.misread(weights[batch], rotations[batch]), wanted[batch])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        schedule.step()
    return model.requires_grad_(False)
