"""The picture by OpenGL 3.3: instanced quads, far to near, after a projection pass on the GPU."""

import time
from typing import Any, Literal

import moderngl
import numba
import numpy as np
from numpy.typing import NDArray

from . import shaders
from .camera import Camera
from .compiling import FLAT, WIDE, compile_ahead
from .culling import view_depths
from .gaussians import RawGaussians, packed
from .projection import ALPHA_MAX, ALPHA_MIN, DILATION, NEAR, VIEW_MARGIN
from .sorting import front_to_back

ROW = 1024
"""Splats in one row of the textures that hold them."""
SPLATS_PER_INSTANCE = 128
_RAW_CHANNELS = {"positions": 3, "rotations": 4, "log_scales": 3, "logits": 1, "colors": 3}


class SplatRenderer:
    """Draws splats by OpenGL, in the thread of its context. Buffers grow with the splats and follow the size."""

    name = "quads"
    bound = True

    def __init__(
        self, context: moderngl.Context, precision: Literal["half", "single"] = "half", owns_context: bool = False
    ) -> None:
        """
        Args:
            context: OpenGL 3.3 core or later.
            precision: of the target that splats are blended in: ``half`` is RGBA16F and differs by some 1/255
                from the exact picture of a head, and by 10 of them and more where hundreds of faint splats lie behind
                each other; ``single`` is RGBA32F.
            owns_context: whether ``close`` releases the context too.
        """
        self.description = str(context.info["GL_RENDERER"])
        self.measures_stages = False
        """Wait for the GPU after each stage, so that ``timings`` are true of each; slower on the whole."""
        self.timings: dict[str, float] = {}
        """Stage -> seconds of the last frame: sort, upload, project, draw, read."""
        self._context = context
        self._owns_context = owns_context
        self._target_type = {"half": "f2", "single": "f4"}[precision]
        with context:
            limits = {"ALPHA_MIN": float(ALPHA_MIN), "ALPHA_MAX": float(ALPHA_MAX), "NEAR": float(NEAR)}
            project = shaders.load("project", DILATION=float(DILATION), VIEW_MARGIN=float(VIEW_MARGIN), **limits)
            self._projector = context.program(shaders.load("fullscreen"), project)
            quad = shaders.load("quad", ROW=ROW, SPLATS_PER_INSTANCE=SPLATS_PER_INSTANCE)
            self._drawer = context.program(quad, shaders.load("blend", **limits))
            corners = np.arange(SPLATS_PER_INSTANCE, dtype=np.uint32)[:, None] * 4 + np.array(
                [0, 1, 2, 2, 1, 3], np.uint32
            )
            self._corners = context.buffer(corners.tobytes())
            self._everywhere = context.vertex_array(self._projector, [])
            self._quads = context.vertex_array(self._drawer, [], index_buffer=self._corners)
        self._splat_resources: list[moderngl.Texture | moderngl.Framebuffer] = []
        self._picture_resources: list[moderngl.Texture | moderngl.Framebuffer] = []
        self._rows = 0
        self._depths = np.empty(0)
        self._orders = np.empty((2, 0), np.int32)
        self._image = np.empty((0, 0, 4), np.float32)

    def draw(self, raw: RawGaussians, camera: Camera) -> NDArray[np.float32]:
        """The picture [H, W, 4], premultiplied sRGB-encoded RGBA in [0, 1] on transparent ground.

        The array belongs to the renderer and is overwritten by the next frame. Splats that are not finite or absurdly
        large never reach the GPU's rasteriser, nor do those nearer than ``projection.NEAR``.
        """
        times = [time.perf_counter()]
        raw = packed(raw)
        order = self._far_to_near(raw, camera)
        times.append(time.perf_counter())
        with self._context:
            self._fit(len(raw), camera)
            arrays = (raw.positions, raw.wxyz, raw.log_scales, raw.opacity_logits, raw.colors)
            for texture, array in zip(self._raw.values(), arrays, strict=True):
                _upload(texture, array)
            _upload(self._order, order)
            self._reached(times)
            self._project(camera)
            self._reached(times)
            self._blend(len(order), camera)
            self._reached(times)
            self._target.read_into(self._image, components=4, dtype="f4")
            self._reached(times)
        stages = ("sort", "upload", "project", "draw", "read")
        self.timings = dict(zip(stages, np.diff(times).tolist(), strict=True))
        return self._image

    @staticmethod
    def warm() -> None:
        """Compile what sorts splats, or load it from disk, without running it: safe in a thread while others draw."""
        doubles, ints = numba.types.Array(numba.float64, 1, "C"), numba.types.Array(numba.int32, 2, "C")
        kernels: tuple[tuple[Any, tuple[Any, ...]], ...] = (
            (view_depths, (WIDE, WIDE, WIDE, FLAT, WIDE, doubles, doubles)),
            (front_to_back, (doubles, ints)),
        )
        for kernel, types in kernels:
            compile_ahead(kernel, *types)

    def close(self) -> None:
        """Release everything on the GPU, and the context if it is the renderer's own."""
        with self._context:
            self._let_go(self._splat_resources + self._picture_resources)
            for resource in (self._everywhere, self._quads, self._corners, self._projector, self._drawer):
                resource.release()
        self._splat_resources, self._picture_resources = [], []
        if self._owns_context:
            self._context.release()

    def _far_to_near(self, raw: RawGaussians, camera: Camera) -> NDArray[np.uint32]:
        if len(self._depths) != len(raw):
            self._depths = np.empty(len(raw))
            self._orders = np.empty((2, len(raw)), np.int32)
        splats = (raw.positions, raw.wxyz, raw.log_scales, raw.opacity_logits, raw.colors)
        view_depths(*splats, np.ascontiguousarray(camera.world_to_camera[2]), self._depths)
        visible = front_to_back(self._depths, self._orders)
        return np.ascontiguousarray(self._orders[0, :visible][::-1]).view(np.uint32)

    def _project(self, camera: Camera) -> None:
        for unit, name in enumerate(("positions", "rotations", "log_scales", "logits")):
            self._raw[name].use(unit)
            self._projector[name].value = unit
        self._projector["world_to_camera"].write(camera.world_to_camera.T.astype(np.float32).tobytes())
        self._projector["lens"].value = (camera.fx, camera.fy, camera.cx, camera.cy)
        self._projector["size"].value = (camera.width, camera.height)
        self._context.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._projected.use()
        self._everywhere.render(moderngl.TRIANGLES, vertices=3)

    def _blend(self, visible: int, camera: Camera) -> None:
        textures = (self._order, self._placed, self._axes, self._raw["colors"])
        for unit, (name, texture) in enumerate(zip(("order", "placed", "axes", "colors"), textures, strict=True)):
            texture.use(unit)
            self._drawer[name].value = unit
        self._drawer["visible"].value = visible
        self._drawer["size"].value = (camera.width, camera.height)
        self._target.use()
        self._target.clear()
        self._context.enable(moderngl.BLEND)
        self._context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        if visible:
            self._quads.render(moderngl.TRIANGLES, instances=-(-visible // SPLATS_PER_INSTANCE))

    def _reached(self, times: list[float]) -> None:
        if self.measures_stages:
            self._context.finish()
        times.append(time.perf_counter())

    def _let_go(self, resources: list[moderngl.Texture | moderngl.Framebuffer]) -> None:
        """Release textures and framebuffers; one that stayed bound would be an error in whatever is drawn next."""
        if resources:
            self._context.detect_framebuffer(0).use()
        for resource in resources:
            resource.release()

    def _fit(self, splats: int, camera: Camera) -> None:
        context, rows = self._context, max(1, -(-splats // ROW))
        if rows > self._rows:
            self._let_go(self._splat_resources)
            size, self._rows = (ROW, rows), rows
            self._raw = {name: context.texture(size, width, dtype="f4") for name, width in _RAW_CHANNELS.items()}
            self._order = context.texture(size, 1, dtype="u4")
            self._placed, self._axes = context.texture(size, 4, dtype="f4"), context.texture(size, 4, dtype="f4")
            self._projected = context.framebuffer([self._placed, self._axes])
            textures = [*self._raw.values(), self._order, self._placed, self._axes]
            for texture in textures:
                texture.filter = moderngl.NEAREST, moderngl.NEAREST
            self._splat_resources = [self._projected, *textures]
        if self._image.shape[:2] != (camera.height, camera.width):
            self._let_go(self._picture_resources)
            color = context.texture((camera.width, camera.height), 4, dtype=self._target_type)
            self._target = context.framebuffer([color])
            self._picture_resources = [self._target, color]
            self._image = np.empty((camera.height, camera.width, 4), np.float32)


def _upload(texture: moderngl.Texture, values: NDArray[np.float32] | NDArray[np.uint32]) -> None:
    """Write [N, ...] into the first N texels: whole rows, then what is left, so that nothing is padded or copied."""
    full = len(values) // ROW
    if full:
        texture.write(values[: full * ROW], viewport=(0, 0, ROW, full), alignment=4)
    if len(values) % ROW:
        texture.write(values[full * ROW :], viewport=(0, full, len(values) % ROW, 1), alignment=4)
