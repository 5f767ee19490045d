"""What was drawn a moment ago, kept beside the screen, so that not everything is drawn again in every frame."""

import math

import moderngl

from .picture import Area

_VERTEX = """#version 330 core
void main() {
    gl_Position = vec4(2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0, 0.0, 1.0);
}
"""
_FRAGMENT = """#version 330 core
uniform sampler2D kept;
out vec4 colour;
void main() {
    colour = texelFetch(kept, ivec2(gl_FragCoord.xy), 0);
}
"""
Box = tuple[int, int, int, int]
"""Left, bottom, width and height in pixels from the bottom left corner."""


class Canvas:
    """A framebuffer of the screen's size, and its way to the screen.

    By a shader: glBlitFramebuffer takes llvmpipe 9 ms for 1280x800 where the screen's bytes are in another order, this
    6 ms, and 3 ms for what lies around the picture.
    """

    def __init__(self, context: moderngl.Context) -> None:
        """In the thread where ``context`` is current."""
        self._context = context
        self._program = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        self._quad = context.vertex_array(self._program, [])
        self._kept, self._frame = self._made((1, 1))

    def fit(self, size: tuple[int, int]) -> bool:
        """Take this size in pixels; True when it is another one, and nothing is kept any more."""
        if self._frame.size == size:
            return False
        self._released()
        self._kept, self._frame = self._made(size)
        return True

    def use(self) -> None:
        """Draw into it from now on."""
        self._frame.use()

    def copy(self, target: moderngl.Framebuffer, around: Area | None) -> None:
        """Copy all to ``target`` of the same size, or all but the pixels of ``around``; ``target`` is in use then."""
        width, height = self._frame.size
        target.use()
        self._context.viewport = (0, 0, width, height)
        self._context.disable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self._kept.use(0)
        for box in [(0, 0, width, height)] if around is None else boxes_around(around, width, height):
            target.scissor = box
            self._quad.render(moderngl.TRIANGLE_STRIP, vertices=4)
        target.scissor = None

    def close(self) -> None:
        """Release what it holds."""
        self._released()
        self._quad.release()
        self._program.release()

    def _made(self, size: tuple[int, int]) -> tuple[moderngl.Texture, moderngl.Framebuffer]:
        texture = self._context.texture(size, 4)
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return texture, self._context.framebuffer([texture])

    def _released(self) -> None:
        self._context.detect_framebuffer(0).use()  # one that stayed bound would be an error in the next call
        self._frame.release()
        self._kept.release()


def box_of(area: Area, width: int, height: int) -> Box:
    """The pixels of a screen whose centres lie in ``area``."""
    left, right = (min(width, max(0, math.ceil(edge - 0.5))) for edge in (area.left, area.left + area.width))
    top, bottom = (min(height, max(0, math.ceil(edge - 0.5))) for edge in (area.top, area.top + area.height))
    return left, height - bottom, right - left, bottom - top


def boxes_around(area: Area, width: int, height: int) -> list[Box]:
    """All other pixels of a screen, as boxes beside, below and above it."""
    left, bottom, across, up = box_of(area, width, height)
    right, top = left + across, bottom + up
    boxes = [
        (0, 0, left, height),
        (right, 0, width - right, height),
        (left, 0, across, bottom),
        (left, top, across, height - top),
    ]
    return [box for box in boxes if box[2] > 0 and box[3] > 0]
