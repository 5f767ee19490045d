"""The picture without a GPU: a fused tile rasteriser on all cores, of the same picture as the other engines."""

import time

import numba
import numpy as np
from numpy.typing import NDArray

from .camera import Camera
from .compiling import DEEP, FLAT, WIDE, compile_ahead
from .culling import is_sane, view_depth
from .gaussians import RawGaussians, packed
from .projection import ALPHA_MAX, ALPHA_MIN, DILATION, NEAR, VIEW_MARGIN
from .sharing import fetch_add
from .sorting import front_to_back
from .tiles import (
    LOG256_E,
    TILE,
    aligned,
    count_pairs,
    fill_pairs,
    lit_rows,
    power_of_256,
    reached_rows,
    run_of_tiles,
    tile_of,
    write_reach,
)

_F = np.float32
_LOG256_E = _F(LOG256_E)
_RUN = 16
"""So many splats are drawn before a tile asks again through which of its rows light still gets."""
_SPLATS, _TILES = 512, 8
"""So many a thread takes at once."""
_RECORD = 10
"""Numbers that are kept of a projected splat."""
_EXACT = {"contract", "reassoc", "arcp", "nsz"}
"""fastmath that knows of NaN and infinity."""
_PAIRS = 2**24
"""So many pairs of a splat and a tile that it reaches are held at a time: 64 MiB. A picture that has more is drawn in
runs of tiles; a head in a portrait has a hundredth of it."""


class SoftwareEngine:
    """Draws splats by numba kernels, one frame at a time; its buffers grow to the largest frame and stay."""

    name = "software"
    bound = False

    def __init__(self, reason: str = "") -> None:
        """``reason``: why it was taken instead of another engine; people read it behind the description."""
        threads = numba.get_num_threads()
        self.description = f"numba tiles on {threads} thread{'s' * (threads > 1)}" + (f" ({reason})" if reason else "")
        self.timings: dict[str, float] = {}
        """Stage -> seconds of the last frame: project, sort, draw."""
        self._records = np.empty((0, _RECORD), np.float32)
        self._spans = np.empty((0, 4), np.int32)
        self._depths = np.empty(0)
        self._orders = np.empty((2, 0), np.int32)
        self._pairs = np.empty(0, np.int32)
        self._image = np.empty((0, 0, 4), np.float32)

    def draw(self, raw: RawGaussians, camera: Camera) -> NDArray[np.float32]:
        """The picture [H, W, 4], premultiplied sRGB-encoded RGBA in [0, 1] on transparent ground.

        The array belongs to the engine and is overwritten by the next frame. Splats that are not finite or absurdly
        large are left out, as are those nearer than ``projection.NEAR``.
        """
        started, threads = time.perf_counter(), numba.get_num_threads()
        self._fit(len(raw), camera)
        raw = packed(raw)
        matrix = camera.world_to_camera.astype(np.float32)
        lens = np.array([camera.fx, camera.fy, camera.cx, camera.cy, camera.width, camera.height], np.float32)
        splats = (raw.positions, raw.wxyz, raw.log_scales, raw.opacity_logits, raw.colors)
        _project(
            *splats,
            matrix,
            np.ascontiguousarray(camera.world_to_camera[2]),
            lens,
            self._records,
            self._spans,
            self._depths,
            threads,
        )
        projected = time.perf_counter()
        visible = front_to_back(self._depths, self._orders)
        sorted_ = time.perf_counter()
        columns, rows = -(-camera.width // TILE), -(-camera.height // TILE)
        ends = np.empty(columns * rows + 1, np.int64)
        count_pairs(self._depths, self._spans, columns, rows, ends)
        room = min(int(ends[-1] * 1.3), max(_PAIRS, len(raw)))
        if room > len(self._pairs):
            self._pairs = np.empty(room, np.int32)
        first = 0
        while first < columns * rows:
            last = run_of_tiles(ends, first, _PAIRS)
            fill_pairs(self._orders[0], visible, self._spans, columns, ends, first, last, self._pairs)
            _rasterise(self._pairs, ends, first, last, self._records, raw.colors, columns, self._image, threads)
            first = last
        drawn = time.perf_counter()
        self.timings = {"project": projected - started, "sort": sorted_ - projected, "draw": drawn - sorted_}
        return self._image

    def warm(self) -> None:
        """Compile every kernel, or load it from disk, without running one: safe in a thread while others draw."""
        ints, pairs = numba.types.Array(numba.int32, 2, "C"), numba.types.Array(numba.int32, 1, "C")
        ends, whole = numba.types.Array(numba.int64, 1, "C"), numba.int64
        doubles = numba.types.Array(numba.float64, 1, "C")
        signatures = (
            (_project, (WIDE, WIDE, WIDE, FLAT, WIDE, WIDE, doubles, FLAT, WIDE, ints, doubles, whole)),
            (front_to_back, (doubles, ints)),
            (count_pairs, (doubles, ints, whole, whole, ends)),
            (run_of_tiles, (ends, whole, whole)),
            (fill_pairs, (pairs, whole, ints, whole, ends, whole, whole, pairs)),
            (_rasterise, (pairs, ends, whole, whole, WIDE, WIDE, whole, DEEP, whole)),
        )
        for kernel, types in signatures:
            compile_ahead(kernel, *types)

    def close(self) -> None:
        """Nothing to give back; every engine has it."""

    def _fit(self, splats: int, camera: Camera) -> None:
        if len(self._depths) != splats:
            self._records = np.empty((splats, _RECORD), np.float32)
            self._spans = np.empty((splats, 4), np.int32)
            self._depths = np.empty(splats)
            self._orders = np.empty((2, splats), np.int32)
        if self._image.shape[:2] != (camera.height, camera.width):
            self._image = np.empty((camera.height, camera.width, 4), np.float32)


@numba.njit(cache=True, parallel=True, fastmath=_EXACT, error_model="numpy")
def _project(positions, wxyz, log_scales, logits, colors, matrix, row, lens, records, spans, depths, threads):
    """``_project_some`` for all splats."""
    counter = np.zeros(1, np.int64)
    for _ in numba.prange(threads):
        first = fetch_add(counter, _SPLATS)
        while first < len(positions):
            last = min(first + _SPLATS, len(positions))
            _project_some(
                first, last, positions, wxyz, log_scales, logits, colors, matrix, row, lens, records, spans, depths
            )
            first = fetch_add(counter, _SPLATS)


@numba.njit(cache=True, fastmath=_EXACT, error_model="numpy", inline="always")
def _project_some(first, last, positions, wxyz, log_scales, logits, colors, matrix, row, lens, records, spans, depths):
    """Activation and EWA projection of the splats from ``first`` to before ``last``.

    A record: centre x y, conic a b c in powers of 256, opacity, and what ``reached_rows`` needs. A span: first and last
    column and row of tiles. Depth 0 is out.
    """
    fx, fy, cx, cy, width, height = lens[0], lens[1], lens[2], lens[3], lens[4], lens[5]
    for i in range(first, last):
        depths[i] = 0
        px, py, pz = positions[i, 0], positions[i, 1], positions[i, 2]
        if not is_sane(positions[i], wxyz[i], log_scales[i], logits[i], colors[i]):
            continue
        l0, l1, l2 = log_scales[i, 0], log_scales[i, 1], log_scales[i, 2]
        qw, qx, qy, qz, logit = wxyz[i, 0], wxyz[i, 1], wxyz[i, 2], wxyz[i, 3], logits[i]
        length = qw * qw + qx * qx + qy * qy + qz * qz
        x = matrix[0, 0] * px + matrix[0, 1] * py + matrix[0, 2] * pz + matrix[0, 3]
        y = matrix[1, 0] * px + matrix[1, 1] * py + matrix[1, 2] * pz + matrix[1, 3]
        depth = view_depth(positions[i], row)
        if depth < NEAR:
            continue
        z = _F(depth)
        opacity = _F(1) / (_F(1) + np.exp(-logit))
        if opacity < ALPHA_MIN:
            continue
        if length < 1e-24:
            qw, qx, qy, qz = _F(1), _F(0), _F(0), _F(0)
        else:
            scale = _F(1) / np.sqrt(length)
            qw, qx, qy, qz = qw * scale, qx * scale, qy * scale, qz * scale
        s0, s1, s2 = np.exp(l0), np.exp(l1), np.exp(l2)
        # columns of R S
        m00, m10, m20 = s0 * (1 - 2 * (qy * qy + qz * qz)), s0 * 2 * (qx * qy + qw * qz), s0 * 2 * (qx * qz - qw * qy)
        m01, m11, m21 = s1 * 2 * (qx * qy - qw * qz), s1 * (1 - 2 * (qx * qx + qz * qz)), s1 * 2 * (qy * qz + qw * qx)
        m02, m12, m22 = s2 * 2 * (qx * qz + qw * qy), s2 * 2 * (qy * qz - qw * qx), s2 * (1 - 2 * (qx * qx + qy * qy))
        # rows of J W, the Jacobian of the projection times the camera's rotation
        inv = _F(1) / z
        # far outside the picture the linearisation explodes: the slope is taken at the edge of a margin around it
        slope_x = min(max(x * inv, (-VIEW_MARGIN * width - cx) / fx), ((1 + VIEW_MARGIN) * width - cx) / fx)
        slope_y = min(max(y * inv, (-VIEW_MARGIN * height - cy) / fy), ((1 + VIEW_MARGIN) * height - cy) / fy)
        jx, jy, ju, jv = fx * inv, fy * inv, -fx * slope_x * inv, -fy * slope_y * inv
        t00, t01, t02 = (
            jx * matrix[0, 0] + ju * matrix[2, 0],
            jx * matrix[0, 1] + ju * matrix[2, 1],
            jx * matrix[0, 2] + ju * matrix[2, 2],
        )
        t10, t11, t12 = (
            jy * matrix[1, 0] + jv * matrix[2, 0],
            jy * matrix[1, 1] + jv * matrix[2, 1],
            jy * matrix[1, 2] + jv * matrix[2, 2],
        )
        u0, u1, u2 = (
            t00 * m00 + t01 * m10 + t02 * m20,
            t00 * m01 + t01 * m11 + t02 * m21,
            t00 * m02 + t01 * m12 + t02 * m22,
        )
        v0, v1, v2 = (
            t10 * m00 + t11 * m10 + t12 * m20,
            t10 * m01 + t11 * m11 + t12 * m21,
            t10 * m02 + t11 * m12 + t12 * m22,
        )
        a, b, c = (
            u0 * u0 + u1 * u1 + u2 * u2 + DILATION,
            u0 * v0 + u1 * v1 + u2 * v2,
            v0 * v0 + v1 * v1 + v2 * v2 + DILATION,
        )
        # a c - b^2 without its cancellation: the minors of the projected axes, and what the dilation adds
        minors = (u0 * v1 - u1 * v0) ** 2 + (u0 * v2 - u2 * v0) ** 2 + (u1 * v2 - u2 * v1) ** 2
        det = minors + DILATION * (a + c - DILATION)
        if not (det > 0 and det < np.inf):
            continue
        centre_x, centre_y = fx * x * inv + cx, fy * y * inv + cy
        reach = np.sqrt(2 * np.log(opacity / ALPHA_MIN))
        half_x, half_y = reach * np.sqrt(a), reach * np.sqrt(c)
        if not (
            centre_x + half_x > 0 and centre_x - half_x < width and centre_y + half_y > 0 and centre_y - half_y < height
        ):
            continue
        r = records[i]
        r[0], r[1] = centre_x, centre_y
        r[2], r[3], r[4] = -_F(0.5) * _LOG256_E * c / det, _LOG256_E * b / det, -_F(0.5) * _LOG256_E * a / det
        r[5] = opacity
        write_reach(reach, a, b, c, det, r[6:])
        spans[i, 0] = int(max(centre_x - half_x, _F(0)) / TILE)
        spans[i, 1] = int(min(centre_x + half_x, width - 1) / TILE)
        spans[i, 2] = int(max(centre_y - half_y, _F(0)) / TILE)
        spans[i, 3] = int(min(centre_y + half_y, height - 1) / TILE)
        depths[i] = depth


@numba.njit(cache=True, parallel=True, fastmath=True, error_model="numpy")
def _rasterise(pairs, ends, begin, end, records, colors, columns, image, threads):
    """``_draw_tile`` for the tiles from ``begin`` to before ``end``, whose pairs ``fill_pairs`` wrote."""
    tiles = end - begin
    counter = np.zeros(1, np.int64)
    for _ in numba.prange(threads):
        first = fetch_add(counter, _TILES)
        while first < tiles:
            for turn in range(first, min(first + _TILES, tiles)):
                tile = begin + tile_of(turn, tiles)
                start, stop = ends[tile] - ends[begin], ends[tile + 1] - ends[begin]
                _draw_tile(tile, pairs, start, stop, records, colors, columns, image)
            first = fetch_add(counter, _TILES)


@numba.njit(cache=True, fastmath=True, error_model="numpy", inline="always")
def _draw_tile(tile, pairs, start, stop, records, colors, columns, image):
    """Write the pixels of one tile: its splats from front to back, until no light is left; ``pairs`` has them from
    ``start`` to before ``stop``."""
    height, width = image.shape[:2]
    x0, y0 = (tile % columns) * TILE, (tile // columns) * TILE
    # light, red, green, blue side by side: one array, so that the compiler sees that they do not overlap
    state = aligned(TILE, 4 * TILE)
    for y in range(TILE):
        for x in range(4 * TILE):
            state[y, x] = 0
        for x in range(TILE):
            state[y, x] = 1
    first, last = 0, TILE - 1
    reached = np.empty((_RUN, 2), np.int32)
    for begin in range(start, stop, _RUN):
        first, last = lit_rows(state, first, last)
        if first > last:
            break
        count = min(_RUN, stop - begin)
        # for a run at once: the rows of the next splat are known before they are needed
        for k in range(count):
            i = pairs[begin + k]
            dx0, dy0 = _F(x0) + _F(0.5) - records[i, 0], _F(y0) + _F(0.5) - records[i, 1]
            top, bottom = reached_rows(dx0, dy0, records[i, 6:])
            reached[k, 0], reached[k, 1] = max(top, first), min(bottom, last)
        for k in range(count):
            i = pairs[begin + k]
            cx, cy, a, b, c, opacity = (
                records[i, 0],
                records[i, 1],
                records[i, 2],
                records[i, 3],
                records[i, 4],
                records[i, 5],
            )
            dx0 = _F(x0) + _F(0.5) - cx
            r, g, bl = colors[i, 0], colors[i, 1], colors[i, 2]
            for y in range(reached[k, 0], reached[k, 1] + 1):
                dy = _F(y0 + y) + _F(0.5) - cy
                e0, e1 = c * dy * dy, b * dy
                for x in range(TILE):
                    dx = dx0 + _F(x)
                    peak = opacity * power_of_256(e0 + dx * (e1 + a * dx))
                    weight = (min(peak, ALPHA_MAX) if peak >= ALPHA_MIN else _F(0)) * state[y, x]
                    state[y, x] -= weight
                    state[y, TILE + x] += weight * r
                    state[y, 2 * TILE + x] += weight * g
                    state[y, 3 * TILE + x] += weight * bl
    for y in range(min(TILE, height - y0)):
        for x in range(min(TILE, width - x0)):
            image[y0 + y, x0 + x, 0] = state[y, TILE + x]
            image[y0 + y, x0 + x, 1] = state[y, 2 * TILE + x]
            image[y0 + y, x0 + x, 2] = state[y, 3 * TILE + x]
            image[y0 + y, x0 + x, 3] = _F(1) - state[y, x]
