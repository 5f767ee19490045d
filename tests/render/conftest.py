"""OpenGL for tests: skipped with a reason where there is none, and no test may leave an error behind."""

from collections.abc import Iterator

import moderngl
import pytest
from gemheads.render.contexts import NoOpenGLError, offscreen_context


@pytest.fixture
def context() -> Iterator[moderngl.Context]:
    try:
        context = offscreen_context()
    except NoOpenGLError as error:
        pytest.skip(str(error))
    with context:
        yield context
        assert context.error == "GL_NO_ERROR"
    context.release()
