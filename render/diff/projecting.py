"""EWA projection and its gradient, splat by splat on all cores, in float64: it is a tenth of the time, and centres
rounded to single precision would alone cost the gradients a digit."""

import numba
import numpy as np

from ..projection import ALPHA_MIN, DILATION, LOG_SCALE_MAX, NEAR, POSITION_MAX, VIEW_MARGIN
from ..tiles import LOG256_E, TILE, write_reach

SHAPE = 8
"""Numbers that say what a splat looks like in the picture."""
SUMS = 9
"""What the tiles leave of each splat: with q = alpha dL/dalpha, the sums over its pixels of q, q dx, q dy, q dx^2,
q dx dy, q dy^2, then dL/d red, green, blue. Pixels where alpha is cut off at ALPHA_MAX have q 0."""
SHARES = 64
"""The camera's gradient is summed in so many shares, whatever the threads: the same input gives the same bits."""
_SCALE_MAX = np.exp(np.float64(LOG_SCALE_MAX))
_DILATION, _MARGIN, _LEAST = np.float64(DILATION), np.float64(VIEW_MARGIN), np.float64(ALPHA_MIN)


@numba.njit(cache=True, inline="always")
def _is_sane(position, wxyz, scales, opacity, color):
    return (
        abs(position[0]) <= POSITION_MAX
        and abs(position[1]) <= POSITION_MAX
        and abs(position[2]) <= POSITION_MAX
        and scales[0] >= 0
        and scales[1] >= 0
        and scales[2] >= 0
        and max(scales[0], scales[1], scales[2]) <= _SCALE_MAX
        and wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3] < np.inf
        and opacity >= ALPHA_MIN
        and opacity < np.inf
        and abs(color[0]) < np.inf
        and abs(color[1]) < np.inf
        and abs(color[2]) < np.inf
    )


@numba.njit(cache=True, inline="always")
def _place(position, matrix, out):
    for d in range(3):
        out[d] = matrix[d, 0] * position[0] + matrix[d, 1] * position[1] + matrix[d, 2] * position[2] + matrix[d, 3]


@numba.njit(cache=True, inline="always")
def _turn(wxyz, unit, rotation):
    """The unit quaternion and its matrix; returns one over the quaternion's length, 0 where it has none."""
    w, x, y, z = np.float64(wxyz[0]), np.float64(wxyz[1]), np.float64(wxyz[2]), np.float64(wxyz[3])
    length = np.sqrt(w * w + x * x + y * y + z * z)
    inverse = 0.0
    if length > 1e-12:
        inverse = 1 / length
        w, x, y, z = w * inverse, x * inverse, y * inverse, z * inverse
    else:
        w, x, y, z = 1.0, 0.0, 0.0, 0.0
    unit[0], unit[1], unit[2], unit[3] = w, x, y, z
    rotation[0, 0], rotation[0, 1], rotation[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    rotation[1, 0], rotation[1, 1], rotation[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    rotation[2, 0], rotation[2, 1], rotation[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return inverse


@numba.njit(cache=True, inline="always")
def _bounded(slope, focal, principal, size):
    """The slope of the line of sight, clamped to the picture with its margin."""
    return min(max(slope, (-_MARGIN * size - principal) / focal), ((1 + _MARGIN) * size - principal) / focal)


@numba.njit(cache=True, inline="always")
def _flatten(matrix, rotation, scales, slope_x, slope_y, jx, jy, axes, flat):
    """The scaled axes in the camera's frame [3, 3], and as the picture sees them [2, 3]."""
    for k in range(3):
        for d in range(3):
            axes[d, k] = scales[k] * (
                matrix[d, 0] * rotation[0, k] + matrix[d, 1] * rotation[1, k] + matrix[d, 2] * rotation[2, k]
            )
        flat[0, k] = jx * (axes[0, k] - slope_x * axes[2, k])
        flat[1, k] = jy * (axes[1, k] - slope_y * axes[2, k])


@numba.njit(cache=True, inline="always")
def _covariance(flat):
    """a, b, c and a c - b^2 without its cancellation: the minors of the flat axes, and what the dilation adds."""
    u0, u1, u2, v0, v1, v2 = flat[0, 0], flat[0, 1], flat[0, 2], flat[1, 0], flat[1, 1], flat[1, 2]
    a = u0 * u0 + u1 * u1 + u2 * u2 + _DILATION
    b = u0 * v0 + u1 * v1 + u2 * v2
    c = v0 * v0 + v1 * v1 + v2 * v2 + _DILATION
    minors = (u0 * v1 - u1 * v0) ** 2 + (u0 * v2 - u2 * v0) ** 2 + (u1 * v2 - u2 * v1) ** 2
    return a, b, c, minors + _DILATION * (a + c - _DILATION)


@numba.njit(cache=True, parallel=True, error_model="numpy")
def project(positions, wxyz, scales, opacities, colors, matrix, lens, centers, shapes, spans, depths, firsts):
    """Write each splat's centre (float64 [N, 2], pixels), shape (float32 [N, SHAPE]: conic in powers of 256, opacity,
    what ``tiles.reached_rows`` needs), span of tiles (int32 [N, 4]), depth (0 where it is not drawn) and number of
    tiles, one place late (``firsts`` int64 [N + 1]). ``matrix`` float64 [4, 4]; ``lens`` float64: fx, fy, cx, cy,
    width, height."""
    fx, fy, cx, cy, width, height = lens[0], lens[1], lens[2], lens[3], lens[4], lens[5]
    firsts[0] = 0
    for share in numba.prange(SHARES):
        seen, unit = np.empty(3), np.empty(4)
        rotation, axes, flat = np.empty((3, 3)), np.empty((3, 3)), np.empty((2, 3))
        for i in range(share * len(positions) // SHARES, (share + 1) * len(positions) // SHARES):
            depths[i], firsts[i + 1] = 0, 0
            opacity = np.float64(opacities[i])
            if not _is_sane(positions[i], wxyz[i], scales[i], opacities[i], colors[i]):
                continue
            _place(positions[i], matrix, seen)
            z = seen[2]
            if not z >= NEAR:
                continue
            _turn(wxyz[i], unit, rotation)
            slope_x, slope_y = seen[0] / z, seen[1] / z
            bounded_x, bounded_y = _bounded(slope_x, fx, cx, width), _bounded(slope_y, fy, cy, height)
            _flatten(matrix, rotation, scales[i], bounded_x, bounded_y, fx / z, fy / z, axes, flat)
            a, b, c, determinant = _covariance(flat)
            if not (determinant > 0 and determinant < np.inf):
                continue
            x, y = fx * slope_x + cx, fy * slope_y + cy
            reach = np.sqrt(2 * np.log(opacity / _LEAST))
            half_x, half_y = reach * np.sqrt(a), reach * np.sqrt(c)
            if not (x + half_x > 0 and x - half_x < width and y + half_y > 0 and y - half_y < height):
                continue
            centers[i, 0], centers[i, 1] = x, y
            shapes[i, 0] = -0.5 * LOG256_E * c / determinant
            shapes[i, 1] = LOG256_E * b / determinant
            shapes[i, 2] = -0.5 * LOG256_E * a / determinant
            shapes[i, 3] = opacity
            write_reach(reach, a, b, c, determinant, shapes[i, 4:])
            left, right = int(max(x - half_x, 0.0) / TILE), int(min(x + half_x, width - 1) / TILE)
            top, bottom = int(max(y - half_y, 0.0) / TILE), int(min(y + half_y, height - 1) / TILE)
            spans[i, 0], spans[i, 1], spans[i, 2], spans[i, 3] = left, right, top, bottom
            firsts[i + 1] = (right - left + 1) * (bottom - top + 1)
            depths[i] = z


@numba.njit(cache=True, parallel=True, error_model="numpy")
def project_back(
    positions,
    wxyz,
    scales,
    opacities,
    matrix,
    lens,
    firsts,
    sums,
    d_positions,
    d_wxyz,
    d_scales,
    d_opacities,
    d_colors,
    d_matrix,
):
    """The gradients of ``project``'s inputs from the tiles' sums, one row of SUMS for every tile that a splat touches
    (``sums`` float32 [P, SUMS], those of splat i from firsts[i] to firsts[i + 1]).

    All of ``d_*`` is overwritten; ``d_matrix`` float64 [SHARES, 3, 4] is to be summed over its shares.
    """
    fx, fy, cx, cy, width, height = lens[0], lens[1], lens[2], lens[3], lens[4], lens[5]
    for share in numba.prange(SHARES):
        seen, unit, total = np.empty(3), np.empty(4), np.empty(SUMS)
        rotation, axes, flat = np.empty((3, 3)), np.empty((3, 3)), np.empty((2, 3))
        d_axes, d_seen, d_rotation = np.empty((3, 3)), np.empty(3), np.empty((3, 3))
        d_matrix[share] = 0
        for i in range(share * len(positions) // SHARES, (share + 1) * len(positions) // SHARES):
            d_opacities[i] = 0
            d_positions[i], d_wxyz[i], d_scales[i], d_colors[i] = 0, 0, 0, 0
            if firsts[i] == firsts[i + 1]:
                continue
            total[:] = 0
            for p in range(firsts[i], firsts[i + 1]):
                for k in range(SUMS):
                    total[k] += sums[p, k]
            _place(positions[i], matrix, seen)
            inverse = _turn(wxyz[i], unit, rotation)
            inv = 1 / seen[2]
            slope_x, slope_y = seen[0] * inv, seen[1] * inv
            bounded_x, bounded_y = _bounded(slope_x, fx, cx, width), _bounded(slope_y, fy, cy, height)
            jx, jy = fx * inv, fy * inv
            _flatten(matrix, rotation, scales[i], bounded_x, bounded_y, jx, jy, axes, flat)
            a, b, c, determinant = _covariance(flat)
            ca, cb, cc = c / determinant, -b / determinant, a / determinant

            opacity = np.float64(opacities[i])
            d_opacities[i] = total[0] / opacity
            for k in range(3):
                d_colors[i, k] = total[6 + k]
            # alpha = opacity e^power, power = -(ca dx^2 + 2 cb dx dy + cc dy^2) / 2: dL/dpower is q
            d_x = ca * total[1] + cb * total[2]
            d_y = cb * total[1] + cc * total[2]
            g00, g01, g11 = -0.5 * total[3], -0.5 * total[4], -0.5 * total[5]
            # of the inverse of a symmetric matrix X = S^-1: dS = -X G X
            h00, h01 = ca * g00 + cb * g01, ca * g01 + cb * g11
            h10, h11 = cb * g00 + cc * g01, cb * g01 + cc * g11
            d_a, d_b, d_c = -(h00 * ca + h01 * cb), -2 * (h00 * cb + h01 * cc), -(h10 * cb + h11 * cc)

            d_jx, d_jy, d_slope_x, d_slope_y = 0.0, 0.0, 0.0, 0.0
            for k in range(3):
                d_u = 2 * d_a * flat[0, k] + d_b * flat[1, k]
                d_v = 2 * d_c * flat[1, k] + d_b * flat[0, k]
                d_jx += d_u * (axes[0, k] - bounded_x * axes[2, k])
                d_jy += d_v * (axes[1, k] - bounded_y * axes[2, k])
                d_slope_x -= jx * d_u * axes[2, k]
                d_slope_y -= jy * d_v * axes[2, k]
                d_axes[0, k], d_axes[1, k] = jx * d_u, jy * d_v
                d_axes[2, k] = -(jx * bounded_x * d_u + jy * bounded_y * d_v)
            # where a slope is clamped, it no longer depends on where the splat is
            d_slope_x = fx * d_x + (d_slope_x if bounded_x == slope_x else 0.0)
            d_slope_y = fy * d_y + (d_slope_y if bounded_y == slope_y else 0.0)
            d_inv = fx * d_jx + fy * d_jy + d_slope_x * seen[0] + d_slope_y * seen[1]
            d_seen[0], d_seen[1], d_seen[2] = d_slope_x * inv, d_slope_y * inv, -inv * inv * d_inv

            for e in range(3):
                d_positions[i, e] = matrix[0, e] * d_seen[0] + matrix[1, e] * d_seen[1] + matrix[2, e] * d_seen[2]
            for k in range(3):
                d_scale = 0.0
                for e in range(3):
                    back = matrix[0, e] * d_axes[0, k] + matrix[1, e] * d_axes[1, k] + matrix[2, e] * d_axes[2, k]
                    d_scale += back * rotation[e, k]
                    d_rotation[e, k] = back * scales[i, k]
                d_scales[i, k] = d_scale
            for d in range(3):
                d_matrix[share, d, 3] += d_seen[d]
                for e in range(3):
                    d_matrix[share, d, e] += d_seen[d] * positions[i, e] + (
                        d_axes[d, 0] * rotation[e, 0] * scales[i, 0]
                        + d_axes[d, 1] * rotation[e, 1] * scales[i, 1]
                        + d_axes[d, 2] * rotation[e, 2] * scales[i, 2]
                    )
            _turn_back(unit, inverse, d_rotation, d_wxyz[i])


@numba.njit(cache=True, inline="always")
def _turn_back(unit, inverse, g, out):
    """The gradient of a quaternion from that of its matrix, through the normalisation."""
    w, x, y, z = unit[0], unit[1], unit[2], unit[3]
    d_w = 2 * (x * (g[2, 1] - g[1, 2]) + y * (g[0, 2] - g[2, 0]) + z * (g[1, 0] - g[0, 1]))
    d_x = 2 * (
        -2 * x * (g[1, 1] + g[2, 2]) + y * (g[0, 1] + g[1, 0]) + z * (g[0, 2] + g[2, 0]) + w * (g[2, 1] - g[1, 2])
    )
    d_y = 2 * (
        x * (g[0, 1] + g[1, 0]) - 2 * y * (g[0, 0] + g[2, 2]) + z * (g[1, 2] + g[2, 1]) + w * (g[0, 2] - g[2, 0])
    )
    d_z = 2 * (
        x * (g[0, 2] + g[2, 0]) + y * (g[1, 2] + g[2, 1]) - 2 * z * (g[0, 0] + g[1, 1]) + w * (g[1, 0] - g[0, 1])
    )
    along = d_w * w + d_x * x + d_y * y + d_z * z
    out[0], out[1] = (d_w - along * w) * inverse, (d_x - along * x) * inverse
    out[2], out[3] = (d_y - along * y) * inverse, (d_z - along * z) * inverse
