"""A picture on the screen: as large as it fits, its sides never distorted, mirrored when wished."""

from dataclasses import dataclass

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

_VERTEX = """#version 330 core
uniform vec4 place;   // left, bottom, width, height in clip space
uniform float mirrored;
out vec2 at;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    at = vec2(mix(corner.x, 1.0 - corner.x, mirrored), 1.0 - corner.y);
    gl_Position = vec4(place.xy + corner * place.zw, 0.0, 1.0);
}
"""
_OPAQUE = """#version 330 core
uniform sampler2D picture;
in vec2 at;
out vec4 colour;
void main() { colour = vec4(texture(picture, at).rgb, 1.0); }
"""
_TRANSPARENT = """#version 330 core
uniform sampler2D picture;
uniform vec2 corner_px;
uniform float square_px;
in vec2 at;
out vec4 colour;
void main() {
    // a chequerboard shows through what is transparent
    vec2 square = floor((gl_FragCoord.xy - corner_px) / square_px);
    vec3 ground = mix(vec3(0.29), vec3(0.36), mod(square.x + square.y, 2.0));
    vec4 over = texture(picture, at);  // premultiplied, or what is between pixels takes colour from transparent ones
    colour = vec4(over.rgb + ground * (1.0 - over.a), 1.0);
}
"""
SQUARE_PX = 12.0


@dataclass(frozen=True)
class Area:
    """A rectangle of the window, from its top left corner; in the screen's units, of which a pixel may be a part."""

    left: float
    top: float
    width: float
    height: float

    def fitted(self, width: int, height: int) -> "Area":
        """The largest rectangle of these proportions in the middle of this one."""
        scale = min(self.width / width, self.height / height)
        inner = (width * scale, height * scale)
        return Area(self.left + (self.width - inner[0]) / 2, self.top + (self.height - inner[1]) / 2, *inner)

    def scaled(self, factor: float) -> "Area":
        """The same in units that are so much smaller."""
        return Area(self.left * factor, self.top * factor, self.width * factor, self.height * factor)

    def holds(self, x: float, y: float) -> bool:
        """Whether a point is in it."""
        return self.left <= x < self.left + self.width and self.top <= y < self.top + self.height


class PictureOnScreen:
    """One texture and the quad it is drawn on, in the window's context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        # two programs: on a software renderer every line of a shader counts
        self._programs = {
            channels: context.program(vertex_shader=_VERTEX, fragment_shader=shader)
            for channels, shader in ((3, _OPAQUE), (4, _TRANSPARENT))
        }
        self._quads = {channels: context.vertex_array(program, []) for channels, program in self._programs.items()}
        self._texture: moderngl.Texture | None = None
        self._channels = 3

    def put(self, picture: NDArray[np.uint8]) -> None:
        """Upload a picture [H, W, 3], or [H, W, 4] with straight alpha."""
        height, width, self._channels = picture.shape
        texture = self._texture
        if texture is None or texture.size != (width, height):
            if texture is not None:
                texture.release()
            texture = self._texture = self._context.texture((width, height), 4)
            texture.repeat_x = texture.repeat_y = False
        # four bytes a pixel, as textures are kept: a driver takes many times as long to fill up three
        texture.write(cv2.cvtColor(picture, cv2.COLOR_RGBA2mRGBA if self._channels == 4 else cv2.COLOR_RGB2RGBA))

    def draw(self, place: Area, screen: tuple[int, int], mirrored: bool) -> None:
        """Draw what was put last into a part of the bound framebuffer of ``screen`` pixels; nothing before that."""
        if self._texture is None:
            return
        self._context.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._context.viewport = (0, 0, *screen)
        width, height = screen
        bottom = height - place.top - place.height
        program = self._programs[self._channels]
        program["place"].value = (
            2 * place.left / width - 1,
            2 * bottom / height - 1,
            2 * place.width / width,
            2 * place.height / height,
        )
        program["mirrored"].value = float(mirrored)
        if self._channels == 4:
            program["corner_px"].value = (place.left, bottom)
            program["square_px"].value = SQUARE_PX
        self._texture.use(0)
        self._quads[self._channels].render(moderngl.TRIANGLE_STRIP, vertices=4)

    def close(self) -> None:
        """Release what it holds on the GPU."""
        for resource in (self._texture, *self._quads.values(), *self._programs.values()):
            if resource is not None:
                resource.release()
        self._texture = None
