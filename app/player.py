"""A plain window that plays a video over and over."""

import time
from pathlib import Path
from typing import Any

from .video import VideoFile

_VERTEX = """#version 330 core
out vec2 at;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    at = vec2(corner.x, 1.0 - corner.y);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
"""
_FRAGMENT = """#version 330 core
uniform sampler2D picture;
in vec2 at;
out vec4 colour;
void main() { colour = texture(picture, at); }
"""


def play(path: Path) -> None:
    """Play until the window is closed, or Esc or Ctrl+Q is pressed. Returns, saying so, where no window opens."""
    import glfw
    import moderngl

    video = VideoFile(path)
    if not glfw.init():
        print("No window can be opened here; the video is complete all the same.")
        return
    try:
        glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, 3)
        glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, 3)
        glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
        glfw.window_hint(glfw.OPENGL_FORWARD_COMPAT, True)
        window = glfw.create_window(*video.size, "gemheads demo (Esc closes)", None, None)
        if not window:
            print("No window can be opened here; the video is complete all the same.")
            return
        glfw.make_context_current(window)
        glfw.swap_interval(1)
        glfw.set_key_callback(window, _close_on_key)
        context = moderngl.create_context()
        program = context.program(vertex_shader=_VERTEX, fragment_shader=_FRAGMENT)
        texture = context.texture(video.size, 3, alignment=1)
        quad = context.vertex_array(program, [])
        while not glfw.window_should_close(window):
            _play_once(video, window, context, texture, quad)
    finally:
        glfw.terminate()


def _play_once(video: VideoFile, window: Any, context: Any, texture: Any, quad: Any) -> None:
    import glfw
    import moderngl

    start = time.perf_counter()
    for frame in video.frames():
        while (wait := frame.seconds - (time.perf_counter() - start)) > 0:
            time.sleep(min(wait, 0.02))
        glfw.poll_events()
        if glfw.window_should_close(window):
            return
        texture.write(frame.rgb)
        context.viewport = (0, 0, *glfw.get_framebuffer_size(window))
        texture.use()
        quad.render(moderngl.TRIANGLE_STRIP, vertices=4)
        glfw.swap_buffers(window)


def _close_on_key(window: Any, key: int, scancode: int, action: int, modifiers: int) -> None:
    import glfw

    if action == glfw.PRESS and (key == glfw.KEY_ESCAPE or (key == glfw.KEY_Q and modifiers & glfw.MOD_CONTROL)):
        glfw.set_window_should_close(window, True)
