"""How an avatar's head has to turn, learned of portraits in which it acts what its regressor answers."""

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..workers import ALONE, Advance, Workers
from .pose_response import LOST, UNIT, PoseResponse, fit_pose_response
from .response import Responses

PORTRAITS = 1.5
"""Portraits, against the random pictures of an avatar. Turns are read off portraits with half as much noise as off
pictures in all framings and lights, and portraits are what people see."""
JUDGING = 10
"""One in so many portraits is held back to say how well turns are known."""
POSES = 4
"""So many models of what is read beyond the turn ship: in their mean, what each learned of noise by heart is a
quarter."""


@dataclass(frozen=True)
class Turns:
    """What was learned."""

    poses: list[PoseResponse]
    portraits: int
    """Learned from."""
    missed_deg: NDArray[np.float64]
    """[3] by how much pitch, yaw and roll are misread in portraits held back (RMS), degrees ..."""
    left_deg: NDArray[np.float64]
    """... and by how much otherwise than is known."""


def learned_turns(seen: Responses, steps: int, seed: int, workers: Workers = ALONE) -> Turns:
    """Learns from portraits of an avatar, in ``steps`` for each model. Raises WorkerLost."""
    held = np.arange(len(seen)) % JUDGING == JUDGING - 1
    learned, judged = seen.only(~held), seen.only(held)
    poses = workers.each(_learned, [(learned, steps, seed + one) for one in range(POSES)])
    beyond = judged.seen_rotations - judged.rotations
    inputs = torch.from_numpy(judged.weights), torch.from_numpy(judged.rotations)
    known = UNIT * torch.stack([pose.misread(*inputs) for pose in poses]).mean(0).numpy()
    found = np.abs(beyond).max(1) < LOST
    missed, left = (_rms_deg(one[found]) for one in (beyond, beyond - known))
    return Turns(poses, len(learned), missed, left)


def _learned(advance: Advance, seen: Responses, steps: int, seed: int) -> PoseResponse:
    pose = fit_pose_response(seen, steps, seed)
    advance()
    return pose


def _rms_deg(errors: NDArray[np.floating]) -> NDArray[np.float64]:
    """[3] of [S, 3] radians; 0 of none."""
    return np.degrees(np.sqrt(np.square(errors.astype(float)).sum(0) / max(1, len(errors))))
