"""What works on this machine, each failure with its cure."""

import os
import platform
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from .errors import CommandError, ExitCode
from .finding import Finding
from .library import DEMO_CLIP, avatars
from .reenacting.reports import versions

FRAMES = 5
"""Pictures drawn to time an engine."""


def run_doctor() -> ExitCode:
    """Print every finding; OK when reenactment works, UNEXPECTED when something that it needs does not."""
    healthy = True
    for finding in examine():
        mark = "ok  " if finding.works else ("FAIL" if finding.needed else "none")
        print(f"{mark} {finding.what}: {finding.detail}", flush=True)
        if not finding.works and finding.cure:
            print(f"     cure: {finding.cure}")
        healthy &= finding.works or not finding.needed
    print("Everything that reenactment needs works." if healthy else "Reenactment does not work here yet: see FAIL.")
    return ExitCode.OK if healthy else ExitCode.UNEXPECTED


def examine() -> Iterator[Finding]:
    """All checks, one after the other; a check that fails does not stop the next."""
    new_enough = sys.version_info >= (3, 11)
    cores = os.cpu_count() or 1
    yield Finding("Python", new_enough, f"{platform.python_version()} on {platform.platform()}, {cores} cores")
    for package, version in versions().items():
        if package not in ("python", "system"):
            yield Finding(package, version != "not installed", version, f"pip install {package}")
    yield _tried("OpenGL", _opengl, _OPENGL_CURE, needed=False)
    for engine in ("software", "quads"):
        yield _tried(f"engine {engine}", lambda name=engine: _speed(name), _OPENGL_CURE, needed=engine == "software")
    yield _tried("onnxruntime", _providers, "pip install onnxruntime")
    yield _tried("face networks", _networks, "restore assets/networks: git checkout assets/networks")
    yield from _codecs()
    yield _tried("content credentials", _credentials, "pip install 'gemheads[credentials]'", needed=False)
    yield from _avatars()
    found = DEMO_CLIP.is_file()
    yield Finding("demo clip", found, str(DEMO_CLIP), "git checkout assets/demo", needed=False)
    from .doctor_live import examine_live

    yield from examine_live()


_OPENGL_CURE = "install OpenGL (Debian, Ubuntu: apt-get install libegl1 libgl1 libgl1-mesa-dri)"


def _tried(what: str, check: Callable[[], str], cure: str, needed: bool = True) -> Finding:
    try:
        return Finding(what, True, check(), needed=needed)
    except CommandError as error:  # which says how to mend it
        detail, _, own = str(error).rpartition("; ")
        return Finding(what, False, detail or own, own if detail else cure, needed)
    except Exception as error:  # whatever it is, the person wants to read it here
        return Finding(what, False, f"{type(error).__name__}: {error}", cure, needed)


def _opengl() -> str:
    from ..render.contexts import offscreen_context

    context = offscreen_context()
    try:
        return f"{context.info['GL_RENDERER']}, {context.info['GL_VERSION']}"
    finally:
        context.release()


def _speed(name: str) -> str:
    import time

    from ..render.engines import open_engine
    from .library import find_avatar
    from .live import NO_SHIFT, Stage, draw
    from .performing.casting import open_avatar
    from .performing.performance import Pose
    from .performing.portrait import portrait
    from .performing.timing import Stopwatch
    from .words import NAMED

    gem = open_avatar(find_avatar()).gem
    engine = open_engine(name)  # pyright: ignore[reportArgumentType]
    try:
        stage = Stage(gem, engine, portrait(gem.viewing, 512, 512), NAMED["grey"], Stopwatch())
        pose = Pose(gem.rest_coefficients, NO_SHIFT)
        draw(stage, pose)
        started = time.perf_counter()
        for _ in range(FRAMES):
            draw(stage, pose)
        milliseconds = (time.perf_counter() - started) / FRAMES * 1e3
        return f"{engine.description}; {milliseconds:.1f} ms for {len(gem)} splats at 512x512"
    finally:
        engine.close()


def _providers() -> str:
    import onnxruntime

    return f"available: {', '.join(onnxruntime.get_available_providers())}"


def _networks() -> str:
    from ..models.driver.face import FaceTracker

    FaceTracker()  # compares every file with its hash
    return "as shipped"


def _codecs() -> Iterator[Finding]:
    from .files.sinks import has_encoder

    cure = "reinstall PyAV from its wheel: pip install --force-reinstall av"
    mp4 = [codec for codec in ("libx264", "libopenh264", "mpeg4") if has_encoder(codec)]
    yield Finding("video to .mp4", bool(mp4), mp4[0] if mp4 else "no encoder", cure)
    for suffix, codec in ((".webm", "libvpx-vp9"), ("transparent .mov", "prores_ks")):
        works = has_encoder(codec)
        yield Finding(f"video to {suffix}", works, codec if works else "no encoder", cure, needed=False)


def _credentials() -> str:
    from .credentials.localkey import existing_key, key_file
    from .credentials.signing import c2pa_module

    library = f"c2pa {c2pa_module().sdk_version()}"
    return f"{library}, key in {key_file()}" if existing_key(key_file()) else f"{library}, a key is made at first use"


def _avatars() -> Iterator[Finding]:
    from .performing.casting import open_avatar

    entries = avatars()
    if not entries:
        yield Finding("avatars", False, "none", "git checkout assets/avatars, or make avatars")
    for entry in entries:

        def opened(path: Path = entry.path) -> str:
            avatar = open_avatar(path)
            learned = "regressor" if avatar.gem.regressor else "no regressor (use --driver baseline)"
            size = path.stat().st_size / 2**20
            return f"{len(avatar.gem)} splats, {size:.1f} MB, {learned}, sha256 {avatar.sha256[:16]}"

        yield _tried(f"avatar {entry.name}", opened, "restore the file, or make avatars", needed=entry.shipped)
