"""The head's pose with gradients, on all cores: ``models.posing.pose_head`` and its backward pass, derived by hand.

A splat with the share s of the pose turns by h = s |r| / 2, halved as quaternions are: u = (cos h, v) with
v = s / 2 sinc(h) r. Its arm a becomes a + 2 (u0 v x a + v x (v x a)), its quaternion q becomes u q.
"""

from typing import Any

import numba
import numpy as np
import torch
from numpy.typing import NDArray

from ....render.arrays import Floats32
from ...posing import pose_splats

_BLOCK = 1024
"""Splats whose shares of the pose's gradient are summed together."""
_SMALL = 0.03
"""Half angles below which series take the place of quotients of small numbers, radians."""


class Turning(torch.autograd.Function):
    """positions [N, 3], wxyz [N, 4], shares [N], pivot [3], turn [3] radians, move [3] -> positions, wxyz.

    All float32 on the CPU. The shares and the pivot get no gradient.
    """

    @staticmethod
    def forward(ctx: Any, *inputs: Any) -> Any:
        """The splats in the pose."""
        plain = [tensor.detach().contiguous() for tensor in inputs]
        moved, turned = torch.empty_like(plain[0]), torch.empty_like(plain[1])
        positions, wxyz, shares, pivot, turn, move = (tensor.numpy() for tensor in plain)
        pose_splats(positions, wxyz, shares, pivot, turn, move, moved.numpy(), turned.numpy())
        ctx.save_for_backward(*plain[:5])
        return moved, turned

    @staticmethod
    def backward(ctx: Any, *grad_outputs: Any) -> Any:
        """Of positions, wxyz, turn and move."""
        positions, wxyz, shares, pivot, turn = (tensor.numpy() for tensor in ctx.saved_tensors)
        d_moved, d_turned = (slope.contiguous().numpy() for slope in grad_outputs)
        d_positions, d_wxyz = np.empty_like(positions), np.empty_like(wxyz)
        sums = np.zeros((-(-len(positions) // _BLOCK), 6))
        _back(positions, wxyz, shares, pivot, turn, d_moved, d_turned, d_positions, d_wxyz, sums)
        pose = torch.from_numpy(sums.sum(0)).float()
        return torch.from_numpy(d_positions), torch.from_numpy(d_wxyz), None, None, pose[:3], pose[3:]


@numba.njit(cache=True, parallel=True, fastmath=True)
def _back(
    positions: Floats32,
    wxyz: Floats32,
    shares: Floats32,
    pivot: Floats32,
    turn: Floats32,
    d_moved: Floats32,
    d_turned: Floats32,
    d_positions: Floats32,
    d_wxyz: Floats32,
    sums: NDArray[np.float64],
) -> None:
    rx, ry, rz = turn
    angle = np.sqrt(rx * rx + ry * ry + rz * rz)
    for block in numba.prange(len(sums)):
        for i in range(block * _BLOCK, min(len(positions), (block + 1) * _BLOCK)):
            share = shares[i]
            half = np.float32(0.5) * share * angle
            w = np.cos(half)
            if half < _SMALL:
                sinc = np.float32(1) - half * half / np.float32(6)
                bend = np.float32(-1 / 3) + half * half / np.float32(30)
            else:
                sinc = np.sin(half) / half
                bend = (w - sinc) / (half * half)
            scale = np.float32(0.5) * share * sinc
            x, y, z = scale * rx, scale * ry, scale * rz
            ax, ay, az = positions[i, 0] - pivot[0], positions[i, 1] - pivot[1], positions[i, 2] - pivot[2]
            gx, gy, gz = d_moved[i, 0], d_moved[i, 1], d_moved[i, 2]
            # turned back: g + 2 (v x (v x g) - w v x g)
            tx, ty, tz = y * gz - z * gy, z * gx - x * gz, x * gy - y * gx
            d_positions[i, 0] = gx + 2 * (y * tz - z * ty - w * tx)
            d_positions[i, 1] = gy + 2 * (z * tx - x * tz - w * ty)
            d_positions[i, 2] = gz + 2 * (x * ty - y * tx - w * tz)
            a, b, c, d = wxyz[i, 0], wxyz[i, 1], wxyz[i, 2], wxyz[i, 3]
            e, f, g, h = d_turned[i, 0], d_turned[i, 1], d_turned[i, 2], d_turned[i, 3]
            d_wxyz[i, 0] = w * e + x * f + y * g + z * h
            d_wxyz[i, 1] = w * f - x * e - y * h + z * g
            d_wxyz[i, 2] = w * g + x * h - y * e - z * f
            d_wxyz[i, 3] = w * h - x * g + y * f - z * e
            # of u: by the quaternion (slope times q's conjugate), by the arm
            va, ga = x * ax + y * ay + z * az, gx * ax + gy * ay + gz * az
            vg = x * gx + y * gy + z * gz
            cx, cy, cz = ay * gz - az * gy, az * gx - ax * gz, ax * gy - ay * gx
            d_w = e * a + f * b + g * c + h * d + 2 * (x * cx + y * cy + z * cz)
            d_x = f * a - e * b - g * d + h * c + 2 * (w * cx + gx * va + ax * vg - 2 * x * ga)
            d_y = g * a - e * c - h * b + f * d + 2 * (w * cy + gy * va + ay * vg - 2 * y * ga)
            d_z = h * a - e * d - f * c + g * b + 2 * (w * cz + gz * va + az * vg - 2 * z * ga)
            bent = np.float32(0.5) * share * bend * (rx * d_x + ry * d_y + rz * d_z)
            along = np.float32(0.25) * share * share * (bent - sinc * d_w)
            sums[block, 0] += scale * d_x + along * rx
            sums[block, 1] += scale * d_y + along * ry
            sums[block, 2] += scale * d_z + along * rz
            sums[block, 3] += share * gx
            sums[block, 4] += share * gy
            sums[block, 5] += share * gz
