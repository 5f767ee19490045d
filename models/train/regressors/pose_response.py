"""What an avatar adds to the turn of its head as the tracker reads it, learned of portraits.

Raised brows tip a head that stays still, a smile lifts it. An avatar shall turn so that its turn is read as its
driver's is, whatever its face does. How much of a turn is read on a face at rest differs between heads, too. Of yaw and
roll that is made up for; of pitch it is left as it is: an avatar that nods further than its driver, to be read alike,
looks elsewhere and moves its brows.
"""

import numpy as np
import torch
from torch import Tensor, nn

from ..threads import one_torch_thread
from .response import TYPICAL, Responses

HIDDEN = 48
"""Width of the two bent layers: a shape tips a head by degrees, and hardly otherwise when the head is turned."""
FARTHEST = np.radians([30.0, 45.0, 20.0])
"""Pitch, yaw and roll up to which pictures were seen, about; beyond, an expression adds what it adds there."""
MOST = float(np.radians(12.0))
"""Nothing adds more; one face in a thousand of those learned from adds 9 degrees."""
LEFT = np.array([1.0, 0.0, 0.0])
"""Of pitch, yaw and roll: the share of what is read beyond the turn of a face at rest that is left as it is."""
LOST = 0.3
"""Radians; what is misread so far is another face, or none."""
TIMES = 3
"""What is added depends on the turn that is asked for, which is what is looked for: begun with the driver's, so many
times, it is found to a tenth of a degree in ninety-nine of a hundred faces."""
UNIT = float(np.radians(1.0))
"""In which a miss is counted: half as large as what is misread."""


class PoseResponse(nn.Module):
    """Control weights [B, E] and the rotation that is asked for [B, 3] (radians) to what is read beyond it [B, 3],
    radians."""

    farthest: Tensor
    left: Tensor

    def __init__(self, controls: int) -> None:
        super().__init__()
        self.register_buffer("farthest", torch.tensor(FARTHEST, dtype=torch.float32))
        self.register_buffer("left", torch.tensor(LEFT, dtype=torch.float32))
        self.expression = nn.Linear(controls, HIDDEN, bias=False)
        self.rotation = nn.Linear(3, HIDDEN)
        self.bend = nn.Sequential(nn.SiLU(), nn.Linear(HIDDEN, HIDDEN), nn.SiLU(), nn.Linear(HIDDEN, 3))
        self.linear = nn.Linear(controls, 3, bias=False)

    def misread(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """[B, 3] all that is read beyond the rotation, which is what pictures tell, in UNIT."""
        turned = self._turned(rotation)
        return self.linear(weights) + self.bend(turned + self.expression(weights))

    def forward(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """What is to be taken off: nothing of a face at rest that looks straight ahead."""
        turned, ahead = self._turned(rotation), self._turned(torch.zeros(1, 3))
        left = self.left * self.bend(turned) + (1 - self.left) * self.bend(ahead)
        bent = self.bend(turned + self.expression(weights)) - left
        return (UNIT * (self.linear(weights) + bent)).clamp(-MOST, MOST)

    def turn(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """[B, 3] what to ask for of a head with the expression ``weights``, so that ``rotation`` is read on it: its
        pitch as if the face were at rest."""
        asked = rotation
        for _ in range(TIMES):
            asked = rotation - self(weights, asked)
        return asked

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
