"""Pictures of a moment by Blender's path tracer: light that enters the skin and comes out elsewhere, true shadows."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...render.camera import Camera
from .blender import blender, interruptible, quiet
from .moment import Moment, Stage
from .shading import EXPOSURE, SHOULDER, SOFT
from .surfaces import sky, surfaces

SAMPLES = 64
"""Paths a pixel; what noise they leave, the denoiser takes away."""
SENSOR_MM = 36.0
LASH = 5
"""The material of lashes; the others are numbered as parts are."""


class CyclesPainter:
    """Draws moments of one stage, as ``drawing.Painter`` does, in a scene of its own."""

    def __init__(self, stage: Stage, samples: int = SAMPLES) -> None:
        """Raises BlenderError where Blender is not installed."""
        self.stage = stage
        self._bpy = blender()
        self._shown: Moment | None = None
        with quiet():
            self._scene = self._bpy.data.scenes.new("studio")
            self._scene.world = sky(self._bpy)
            self._set_quality(samples)
            self._mesh = self._add_head()
            self._camera = self._bpy.data.objects.new("camera", self._bpy.data.cameras.new("camera"))
            self._scene.collection.objects.link(self._camera)
            self._scene.camera = self._camera

    def draw(self, moment: Moment, camera: Camera) -> NDArray[np.float32]:
        """sRGB-encoded premultiplied RGBA [H, W, 4] in 0..1."""
        if moment is not self._shown:
            self._mesh.vertices.foreach_set("co", np.ascontiguousarray(moment.vertices, np.float32).ravel())
            self._mesh.update()
            self._shown = moment
        self._look_through(camera)
        return _developed(self._rendered(camera))

    def _set_quality(self, samples: int) -> None:
        render, cycles = self._scene.render, self._scene.cycles
        render.engine = "CYCLES"
        render.film_transparent = True
        render.resolution_percentage = 100
        # linear light, so that the same curve makes the picture of it as in the studio
        render.image_settings.file_format = "OPEN_EXR"
        render.image_settings.color_mode = "RGBA"
        render.image_settings.color_depth = "32"
        cycles.device = "CPU"
        cycles.samples = samples
        cycles.use_adaptive_sampling = False
        cycles.use_denoising = True
        cycles.seed = 0
        cycles.max_bounces = 6
        cycles.transparent_max_bounces = 64  # cards of hair lie over each other

    def _add_head(self) -> Any:
        subject, stage = self.stage.subject, self.stage
        mesh = self._bpy.data.meshes.new("head")
        mesh.from_pydata(subject.puppet.vertices.tolist(), [], subject.triangles.tolist())
        mesh.uv_layers.new(name="uv").data.foreach_set("uv", np.ascontiguousarray(stage.uv, np.float32).ravel())
        for material in surfaces(self._bpy, subject):
            mesh.materials.append(material)
        numbers = stage.parts.astype(np.int32)
        numbers[len(subject.template.triangles) :][subject.card_is_lash] = LASH
        mesh.polygons.foreach_set("material_index", numbers)
        mesh.polygons.foreach_set("use_smooth", np.ones(len(numbers), np.bool_))
        self._scene.collection.objects.link(self._bpy.data.objects.new("head", mesh))
        return mesh

    def _look_through(self, camera: Camera) -> None:
        """Blender's camera looks along -z with y up; its shifts are shares of the picture's width."""
        lens, render = self._camera.data, self._scene.render
        render.resolution_x, render.resolution_y = camera.width, camera.height
        stretch = camera.fy / camera.fx
        render.pixel_aspect_x, render.pixel_aspect_y = max(stretch, 1.0), max(1 / stretch, 1.0)
        lens.sensor_fit, lens.sensor_width = "HORIZONTAL", SENSOR_MM
        lens.clip_start, lens.clip_end = 0.01, 100.0
        lens.lens = camera.fx / camera.width * SENSOR_MM
        lens.shift_x = (camera.width / 2 - camera.cx) / camera.width
        lens.shift_y = (camera.cy - camera.height / 2) / stretch / camera.width
        pose = np.linalg.inv(camera.world_to_camera) @ np.diag([1.0, -1.0, -1.0, 1.0])
        self._camera.matrix_world = pose.T.tolist()

    def _rendered(self, camera: Camera) -> NDArray[np.float32]:
        """Linear premultiplied RGBA [H, W, 4]: Blender gives a picture only as a file."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "picture.exr"
            self._scene.render.filepath = str(path)
            with interruptible(), quiet():
                ended = self._bpy.ops.render.render(write_still=True, scene=self._scene.name)
            if "FINISHED" not in ended or not path.exists():
                raise KeyboardInterrupt  # nothing else ends a picture before it is done
            image = self._bpy.data.images.load(str(path))
            image.alpha_mode = "PREMUL"
            pixels = np.empty(camera.width * camera.height * 4, np.float32)
            image.pixels.foreach_get(pixels)
            self._bpy.data.images.remove(image)
        return pixels.reshape(camera.height, camera.width, 4)[::-1]


def _developed(light: NDArray[np.float32]) -> NDArray[np.float32]:
    """Linear premultiplied RGBA to sRGB-encoded, by the exposure and the shoulder of ``shading``."""
    alpha = np.clip(light[..., 3:], 0, 1)
    rgb = np.clip(light[..., :3] / np.maximum(light[..., 3:], 1e-4), 0, None) * EXPOSURE
    rgb = np.where(rgb > SHOULDER, SHOULDER + (1 - SHOULDER) * np.tanh((rgb - SHOULDER) / SOFT), rgb)
    encoded = np.where(rgb <= 0.0031308, 12.92 * rgb, 1.055 * np.maximum(rgb, 0.0031308) ** (1 / 2.4) - 0.055)
    return np.concatenate([np.clip(encoded, 0, 1) * alpha, alpha], -1).astype(np.float32)
