"""What the live window can use on this machine: none of it is needed for reenactment, each failure has its cure."""

import socket
import sys
from collections.abc import Iterator

from .errors import CommandError
from .finding import Finding


def examine_live() -> Iterator[Finding]:
    """All checks, one after the other; a check that fails does not stop the next."""
    yield _window()
    yield _panels()
    yield from _cameras()
    yield _virtual_camera()
    yield _microphone()
    yield from _face_data()
    yield _provider()


def _window() -> Finding:
    from .machine import has_display

    if not has_display():
        cure = "log into a desktop, or set DISPLAY; results can be written to files without one"
        return Finding("display", False, "none", cure, needed=False)
    from ..render.contexts import NoOpenGLError, window_context

    try:
        window, context = window_context(64, 64, "gemheads doctor", visible=False)
    except (NoOpenGLError, OSError) as error:
        return Finding("display", False, str(error), "install a graphics driver with OpenGL 3.3", needed=False)
    import glfw

    try:
        return Finding("display", True, f"a window with {context.info['GL_RENDERER']}", needed=False)
    finally:
        context.release()
        glfw.destroy_window(window)
        glfw.terminate()


def _panels() -> Finding:
    try:
        import imgui_bundle
    except ImportError as error:
        return Finding("panels", False, str(error), "pip install imgui-bundle", needed=False)
    return Finding("panels", True, f"imgui-bundle {imgui_bundle.__version__}", needed=False)


def _cameras() -> Iterator[Finding]:
    from .inputs import cameras
    from .inputs.camera import CURES

    found = cameras()
    for camera in found:
        where = f" ({camera.path})" if camera.path else ""
        yield Finding("camera", True, f"{camera.name}{where}", needed=False)
    if not found:
        cure = " ".join(("Plug one in.", CURES.get(sys.platform, ""), "Videos and the demo need none."))
        yield Finding("camera", False, "none is connected, or none may be used", cure, needed=False)


def _virtual_camera() -> Finding:
    from .senders.loopback import INSTALL, MAKE_ONE, loopbacks

    if sys.platform == "linux":
        found = loopbacks()
        names = ", ".join(f"{device.name} ({device.path})" for device in found) or "no loopback device"
        return Finding("virtual camera", bool(found), names, f"{MAKE_ONE} (if it is missing, {INSTALL})", needed=False)
    try:
        import pyvirtualcam  # pyright: ignore[reportMissingImports]
    except ImportError:
        cure = "pip install gemheads[camera], and OBS Studio, started once"
        return Finding("virtual camera", False, "pyvirtualcam is not installed", cure, needed=False)
    return Finding("virtual camera", True, f"pyvirtualcam {pyvirtualcam.__version__}", needed=False)


def _microphone() -> Finding:
    from .senders.microphone import sound_devices

    try:
        device = sound_devices().query_devices(kind="input")
    except CommandError as error:
        what, _, cure = str(error).removeprefix("no microphone: ").partition("; ")
        return Finding("microphone", False, what, cure, needed=False)
    except Exception as error:  # PortAudioError: only there where the module is
        return Finding("microphone", False, str(error), "plug one in, and allow this program to use it", needed=False)
    return Finding("microphone", True, str(device["name"]), needed=False)


def _face_data() -> Iterator[Finding]:
    """The ports on which face data of other programs is listened to, on this machine only."""
    from .inputs.oscin import LOOPBACK, PORTS

    for port in sorted(set(PORTS.values())):
        names = "/".join(name for name, number in PORTS.items() if number == port)
        what = f"port {port} ({names})"
        try:
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
                probe.bind((LOOPBACK, port))
        except OSError as error:
            reason = error.strerror or str(error)
            cure = f"close the program that uses it, or choose another: {names.split('/')[0]}:PORT"
            yield Finding(what, False, reason, cure, needed=False)
        else:
            yield Finding(what, True, "free", needed=False)


def _provider() -> Finding:
    """What the networks were asked to run on, and what they do run on."""
    from ..models.driver.face import FaceTracker
    from ..models.driver.networks import PROVIDERS, NetworkError

    requested = ", ".join(PROVIDERS)
    try:
        active = FaceTracker().providers
    except NetworkError as error:
        return Finding("networks run on", False, str(error), "restore assets/networks: git checkout assets/networks")
    same = tuple(active) == tuple(PROVIDERS)
    words = f"requested: {requested}; active: {', '.join(active)}"
    return Finding("networks run on", same, words, "pip install --force-reinstall onnxruntime", needed=False)
