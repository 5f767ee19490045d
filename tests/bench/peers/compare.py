"""The same PLY drawn by our engines and by two viewers of the web, frame about frame, as ratios:

    python tests/bench/peers/compare.py [--avatar mara] [--sizes 512x512,550x802] [--rounds 12] [--write]

README.md beside this file says what is measured and what it needs.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

os.environ.setdefault("OMP_WAIT_POLICY", "passive")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import cv2
import numpy as np
import platformdirs
from chromium import Chromium, program_of
from gemheads.app.errors import CommandError
from gemheads.app.library import find_avatar
from gemheads.app.performing.casting import open_avatar
from gemheads.app.performing.portrait import portrait
from gemheads.app.words import NAMED, read_size
from gemheads.models.gem import Gem
from gemheads.models.ply import load_ply, save_ply
from gemheads.render.camera import Camera
from gemheads.render.contexts import NoOpenGLError
from gemheads.render.engines import open_engine
from gemheads.render.gaussians import RawGaussians, activate
from gemheads.render.reference import render_reference
from numpy.typing import NDArray
from packages import installed
from pagecamera import settings_of
from report import Comparison, Row, machine, printed, written
from server import PageServer
from trouble import Trouble
from viewers import OurViewer, PageViewer, Times, Viewer

HERE = Path(__file__).resolve().parent
DOCUMENT = HERE.parents[2] / "docs" / "peers.md"
PEERS = ("gaussian-splats-3d", "spark")
BACKGROUND = NAMED["grey"]
FRAMES = 3
"""Counted in a turn of a viewer; one more goes before them, in which it wakes up."""
YAW_DEG, PITCH_DEG = 12.0, 5.0
"""The camera jumps by up to this to either side, so that no order serves twice; pictures are compared there."""


def main() -> int:
    """The command; see ``--help``."""
    options = _options()
    try:
        if options.rounds < 1:
            raise Trouble(f"--rounds {options.rounds}: nothing would be measured; give 1 or more")
        sizes = [read_size(word) for word in options.sizes.split(",")]
        gem = open_avatar(find_avatar(options.avatar)).gem
        comparison = compare(gem, sizes, options.rounds, options.cache, options.chromium, options.pictures)
    except (Trouble, CommandError, NoOpenGLError) as trouble:
        print(trouble, file=sys.stderr)
        return 1
    print(printed(comparison))
    if options.write:
        DOCUMENT.write_text(written(comparison), "utf-8")
        print(f"written to {DOCUMENT.relative_to(DOCUMENT.parents[1])}")
    return 0


def compare(
    gem: Gem, sizes: list[tuple[int, int]], rounds: int, cache: Path, chromium: str | None, pictures: Path | None
) -> Comparison:
    """Measure an avatar's neutral. ``pictures``: a folder that gets what each viewer drew. Raises Trouble."""
    with ExitStack() as stack:
        file = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "neutral.ply"
        save_ply(gem.compose(gem.rest_coefficients), file)
        splats = load_ply(file)  # what the others read, not what it was made of
        viewers, browser = stack.enter_context(_opened(file, splats, cache, chromium))
        rows = []
        for width, height in sizes:
            turned = portrait(gem.viewing, width, height, YAW_DEG, PITCH_DEG)
            exact = _over(render_reference(activate(splats), turned))
            quality = {}
            for viewer in viewers:
                picture = viewer.picture(turned)
                quality[viewer.name] = psnr(picture, exact)
                if pictures is not None:
                    _keep(picture, pictures / f"{width}x{height}-{viewer.name}.png")
            times = interleaved(viewers, list(turns(gem, width, height, rounds)))
            rows += [Row(width, height, viewer.name, times[viewer.name], quality[viewer.name]) for viewer in viewers]
        front = portrait(gem.viewing, *sizes[0])
        renderers = {viewer.name: viewer.renderer(front) for viewer in viewers}
        return Comparison(gem.name, len(splats), rounds * FRAMES, machine(), browser, renderers, rows)


def turns(gem: Gem, width: int, height: int, rounds: int) -> Iterator[list[Camera]]:
    """The cameras of each round: every viewer draws from the same ones."""
    rng = np.random.default_rng(0)
    for _ in range(rounds):
        angles = rng.uniform(-1, 1, (FRAMES + 1, 2)) * (YAW_DEG, PITCH_DEG)
        yield [portrait(gem.viewing, width, height, yaw, pitch) for yaw, pitch in angles.tolist()]


def interleaved(viewers: list[Viewer], rounds: list[list[Camera]]) -> dict[str, list[Times]]:
    """Viewer -> times of all frames that count, in the order of the cameras. Another viewer begins in each round."""
    times: dict[str, list[Times]] = {viewer.name: [] for viewer in viewers}
    for number, cameras in enumerate(rounds):
        first = number % len(viewers)
        for viewer in (*viewers[first:], *viewers[:first]):
            times[viewer.name] += viewer.frames(cameras)[1:]
    return times


def psnr(picture: NDArray[np.uint8], exact: NDArray[np.float64]) -> float:
    """Decibels between a picture in bytes and one in [0, 1], of the same shape."""
    return float(-10 * np.log10(np.mean((picture / 255 - exact) ** 2)))


@contextmanager
def _opened(file: Path, splats: RawGaussians, cache: Path, chromium: str | None) -> Iterator[tuple[list[Viewer], str]]:
    """The viewers, ours first, and what the browser calls itself."""
    with ExitStack() as stack:
        program = program_of(chromium)  # before anything is fetched
        server = PageServer(HERE / "page", installed(cache), file, settings_of(BACKGROUND))
        stack.callback(server.close)
        browser = Chromium(server.address, program)
        stack.callback(browser.close)
        ours = []
        for engine in (open_engine("software"), open_engine("quads")):
            stack.callback(engine.close)
            ours.append(OurViewer(engine, splats, BACKGROUND))
        yield [*ours, *(PageViewer(name, server, browser) for name in PEERS)], browser.version


def _over(image: NDArray[np.float64]) -> NDArray[np.float64]:
    return image[..., :3] + (1 - image[..., 3:]) * BACKGROUND


def _keep(picture: NDArray[np.uint8], file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(file), np.ascontiguousarray(picture[..., ::-1]))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Our engines beside viewers of the web, on the same splats.")
    parser.add_argument("--avatar", default="mara", help="name or file")
    parser.add_argument("--sizes", default="512x512,550x802", help="width x height, separated by commas")
    parser.add_argument("--rounds", type=int, default=12, help=f"turns of each viewer, {FRAMES} frames each")
    parser.add_argument("--write", action="store_true", help="docs/peers.md too")
    parser.add_argument("--pictures", type=Path, help="folder for what each viewer drew")
    parser.add_argument("--chromium", help="which browser; otherwise the first that is found")
    cache = Path(platformdirs.user_cache_dir("gemheads")) / "peers"
    parser.add_argument("--cache", type=Path, default=cache, help="where the npm packages are kept")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
