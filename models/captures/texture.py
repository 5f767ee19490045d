"""The colours of a template's texels as a capture's pictures show them: one robust mean for each."""

from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from .deformation import vertex_normals
from .headmotion import posed
from .layout import CaptureError, Shot
from .meshview import see
from .reader import Capture
from .texels import Texels

SHOTS = 96
"""Pictures that are looked at: spread over moments and cameras."""
BEHIND_M = 0.004
"""A texel so far behind the nearest surface is hidden by it."""
LEAST_COSINE = 0.2
"""Between the normal and the way to the camera: what is seen more slanted has the colours of its neighbours."""
SPREAD = 0.06
"""Of colours in 0..1 that still agree; what lies farther off (a shine, a shadow, hair) counts little ..."""
ROUNDS = 4
"""... after so many rounds of weighing anew."""
CERTAIN = 250
"""Of 255, in a mask: the person alone. Soft mattes hardly ever say 255."""
_CHUNK = 512
_NOTHING_SEEN = 0.5


def texel_colors(
    capture: Capture, texels: Texels, progress: Callable[[str, int, int], None] = lambda stage, done, total: None
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """RGB [N, 3] in 0..1 of each texel, and which [N] were seen at all; the others have the nearest seen one's.

    Every texel is projected into SHOTS training pictures; where the mesh's own depth says that it is in front, its
    pixel counts by how straight it is looked at. The mean is that of Cauchy: outliers lose their weight.
    Raises CaptureError where nothing of the template is seen at all.
    """
    shots = spread_shots(capture.train, SHOTS)
    samples = np.zeros((len(shots), len(texels), 3), np.uint8)
    weights = np.zeros((len(shots), len(texels)), np.float32)
    for index, shot in enumerate(shots):
        samples[index], weights[index] = _seen(capture, texels, shot)
        progress("texture", index + 1, len(shots))
    total = weights.sum(0)
    seen = total > 0
    if not seen.any():
        raise CaptureError(
            capture.folder,
            "no training picture shows any of the template",
            "masks must be white (255) where the person is, cameras camera-to-world with OpenGL axes, and meshes in the"
            " same world as the cameras",
        )
    colors = np.full((len(texels), 3), _NOTHING_SEEN, np.float32)
    for start in range(0, len(texels), _CHUNK):
        part = np.s_[start : start + _CHUNK]
        colors[part][seen[part]] = _robust(samples[:, part] / np.float32(255), weights[:, part])[seen[part]]
    _fill(colors, seen, texels)
    return colors, seen


def spread_shots(shots: Sequence[Shot], wanted: int) -> list[Shot]:
    """At most ``wanted`` shots, evenly over the moments; the cameras take turns."""
    moments: dict[int, list[Shot]] = {}
    for shot in shots:
        moments.setdefault(shot.timestep, []).append(shot)
    times = sorted(moments)
    rounds = -(-wanted // len(times))
    chosen = [times[i] for i in np.linspace(0, len(times) - 1, min(wanted, len(times))).round().astype(int)]
    # neighbouring moments look from cameras far apart: the step is near the golden section
    spread = []
    for order, time in enumerate(chosen):
        there = sorted(moments[time], key=lambda shot: shot.camera_index)
        first = int(order * 0.618 * len(there))
        step = max(1, len(there) // rounds)
        spread += [there[(first + turn * step) % len(there)] for turn in range(min(rounds, len(there)))]
    return spread[:wanted]


def _seen(capture: Capture, texels: Texels, shot: Shot) -> tuple[NDArray[np.uint8], Floats]:
    """The colours [N, 3] under the texels, and what each counts [N]; 0 where it cannot be seen."""
    template, tracked, camera = capture.template, capture.tracked(shot.timestep), shot.camera
    moved = posed(
        tracked.vertices, template.neck_weights, template.neck_pivot, tracked.rotation, tracked.translation
    ).astype(np.float64)
    triangles = template.triangles.astype(np.int64)
    _, _, nearest = see(moved, triangles, camera)
    places = texels.spread(moved)
    normals = texels.spread(vertex_normals(moved, triangles))
    toward = camera.center - places
    cosine = (normals * toward).sum(1) / np.maximum(
        np.linalg.norm(normals, axis=1) * np.linalg.norm(toward, axis=1), 1e-12
    )
    x, y, depth = (places @ camera.world_to_camera[:3, :3].T + camera.world_to_camera[:3, 3]).T
    ahead = np.maximum(depth, 1e-6)
    column = np.floor(camera.fx * x / ahead + camera.cx).astype(np.int64)
    row = np.floor(camera.fy * y / ahead + camera.cy).astype(np.int64)
    inside = (depth > 1e-3) & (column >= 0) & (column < camera.width) & (row >= 0) & (row < camera.height)
    column, row = np.where(inside, column, 0), np.where(inside, row, 0)
    rgba = capture.read(shot)
    # the outermost pixels of the person have the background mixed in
    person = cv2.erode(rgba[..., 3], np.ones((3, 3), np.uint8)) >= CERTAIN
    visible = inside & (cosine > LEAST_COSINE) & (depth < nearest[row, column] + BEHIND_M) & person[row, column]
    return rgba[row, column, :3], np.where(visible, cosine**2, 0).astype(np.float32)


def _robust(samples: Floats, weights: Floats) -> Floats:
    """Mean over the first axis of [S, n, 3] with weights [S, n] that fall with the distance from it."""
    base = weights
    for _ in range(ROUNDS):
        mean = np.einsum("sn,snc->nc", weights, samples) / np.maximum(weights.sum(0), 1e-12)[:, None]
        weights = base / (1 + ((samples - mean) ** 2).sum(-1) / SPREAD**2)
    return np.einsum("sn,snc->nc", weights, samples) / np.maximum(weights.sum(0), 1e-12)[:, None]


def _fill(colors: NDArray[np.float32], seen: NDArray[np.bool_], texels: Texels) -> None:
    """Texels that no picture shows take the colour of the nearest one of their part, in place."""
    places = texels.spread(texels.template.vertices).astype(np.float32)
    for part in np.unique(texels.part):
        known, unknown = (np.flatnonzero((texels.part == part) & which) for which in (seen, ~seen))
        if not len(known):
            continue
        for start in range(0, len(unknown), _CHUNK):
            some = unknown[start : start + _CHUNK]
            gaps = (places[known] ** 2).sum(1) - 2 * places[some] @ places[known].T
            colors[some] = colors[known[gaps.argmin(1)]]
