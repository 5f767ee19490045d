"""How the tracker reads the turn of an avatar's head, and the turn that reads as a driver's.

What is read is not what is drawn: raised brows tip a head that stays still, and one avatar's nods read as smaller than
another's. An avatar shall turn so that its turn is read as its driver's is, like all else that it does.
"""

import numpy as np
import torch
from torch import Tensor, nn

from .response import TYPICAL, Responses
from .threads import one_torch_thread

HIDDEN = 48
"""Width of the two bent layers: a shape tips a head by degrees, and hardly otherwise when the head is turned."""
FARTHEST = np.radians([30.0, 45.0, 20.0])
"""Pitch, yaw and roll up to which pictures were seen, about; beyond, what is misread stays what it is there."""
MOST = float(np.radians(12.0))
"""No turn is misread by more. Less than one in a thousand faces are, by 9 degrees."""
LOST = 0.3
"""Radians; what is misread so far is another face, or none."""
TIMES = 3
"""What is misread depends on the turn that is drawn, which is what is asked for: begun with the driver's, it is looked
for so many times, and found to a tenth of a degree."""
UNIT = float(np.radians(1.0))
"""In which a miss is counted: half as large as what is misread."""


class PoseResponse(nn.Module):
    """Control weights [B, E] and the head's rotation [B, 3] (radians) to what is read beyond it [B, 3], radians:
    nothing for the neutral expression that looks straight ahead."""

    farthest: Tensor

    def __init__(self, controls: int) -> None:
        super().__init__()
        self.register_buffer("farthest", torch.tensor(FARTHEST, dtype=torch.float32))
        self.layers = nn.Sequential(
            nn.Linear(controls + 3, HIDDEN),
            nn.SiLU(),
            nn.Linear(HIDDEN, HIDDEN),
            nn.SiLU(),
            nn.Linear(HIDDEN, 3, bias=False),
        )
        self.linear = nn.Linear(controls + 3, 3, bias=False)

    def forward(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """What is misread."""
        within = torch.minimum(torch.maximum(rotation, -self.farthest), self.farthest)
        inputs = torch.cat([weights, within / TYPICAL], 1)
        beyond = self.linear(inputs) + self.layers(inputs) - self.at_rest()
        return (UNIT * beyond).clamp(-MOST, MOST)

    def at_rest(self) -> Tensor:
        """[1, 3] what the layers say of the neutral expression, straight ahead, in UNIT."""
        return self.layers(torch.zeros(1, self.linear.in_features))

    def turn(self, weights: Tensor, rotation: Tensor) -> Tensor:
        """[B, 3] by which to turn a head with the expression ``weights`` so that ``rotation`` is read on it."""
        drawn = rotation
        for _ in range(TIMES):
            drawn = rotation - self(weights, drawn)
        return drawn


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
        loss = nn.functional.huber_loss(model(weights[batch], rotations[batch]) / UNIT, wanted[batch])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        schedule.step()
    return model.requires_grad_(False)
