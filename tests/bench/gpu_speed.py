"""Frames a second of compose, sort and draw at the paper's size, by our engines and by gsplat on the same GPU:

    python tests/bench/gpu_speed.py [AVATAR ...] [--maps 256] [--components 50] [--size 550x802] [--json F]
        [--docs docs/gpu.md]

Every way draws the same expressions in turns; a frame begins with coefficients and ends with its picture in this
program's memory (for gsplat there is a row that leaves the picture on the GPU, too). Where there is no NVIDIA GPU with
gsplat, its rows say why, and ours are measured all the same.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import numpy as np
import torch
from gemheads.app.bench.synthetic import synthetic_gem
from gemheads.app.library import find_avatar
from gemheads.app.machine import cpu_name
from gemheads.app.performing.portrait import portrait
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.train.synthesis.torchgem import TorchGem
from gemheads.render.camera import Camera
from gemheads.render.contexts import NoOpenGLError, offscreen_context
from gemheads.render.diff import cuda
from gemheads.render.diff.tensors import RawTensors, activate
from gemheads.render.engines import Engine
from gemheads.render.software import SoftwareEngine
from gemheads.render.splats import SplatRenderer
from numpy.typing import NDArray
from results.pages import DOCS_HELP, put_table

STAGES = ("compose", "sort", "upload", "project", "draw", "read")
WARM = 3
"""Frames before those that count: they compile, and touch new memory."""
Picture = NDArray[np.float32]
Way = Callable[[Picture], tuple[Picture | None, dict[str, float]]]
"""Coefficients to the picture, or None where it stays on the GPU, and the seconds of each stage."""


@dataclass(frozen=True)
class Row:
    """One avatar drawn one way; all times are medians in milliseconds."""

    avatar: str
    splats: int
    components: int
    size: str
    way: str
    ms: dict[str, float]
    """Stage -> milliseconds."""
    frame: float
    psnr: float | None
    """Of the frame most unlike the first way's, decibels; None for that one, and where nothing is read."""


def by_engine(gem: Gem, components: int, camera: Camera, engine: Engine) -> Way:
    """Equation 1 by ``Gem.compose``, drawn by one of our engines."""
    splats = gem.compose(gem.rest_coefficients, components)

    def frame(coefficients: Picture) -> tuple[Picture, dict[str, float]]:
        started = time.perf_counter()
        gem.compose(coefficients, components, out=splats)
        composed = time.perf_counter() - started
        return engine.draw(splats, camera), {"compose": composed, **engine.timings}

    return frame


def by_gsplat(gem: Gem, components: int, camera: Camera, composing: str, reading: bool) -> Way:
    """gsplat, with equation 1 by torch on the GPU or by ``Gem.compose`` and an upload."""
    avatar, view = TorchGem.of(gem, "cuda"), torch.tensor(camera.world_to_camera, dtype=torch.float32, device="cuda")
    mask = torch.zeros_like(avatar.sigma)
    for start in np.cumsum([0, *(len(basis.components) for basis in gem.bases.values())][:-1]):
        mask[start : start + components] = 1
    splats, colors = gem.compose(gem.rest_coefficients, components), avatar.colors

    @torch.no_grad()
    def frame(coefficients: Picture) -> tuple[Picture | None, dict[str, float]]:
        started = time.perf_counter()
        if composing == "GPU":
            raw = avatar.compose(torch.from_numpy(coefficients).to("cuda") * mask)
        else:
            gem.compose(coefficients, components, out=splats)
            arrays = splats.positions, splats.wxyz, splats.log_scales, splats.opacity_logits
            raw = RawTensors(*(torch.from_numpy(array).to("cuda") for array in arrays), colors)
        torch.cuda.synchronize()
        composed = time.perf_counter()
        image = cuda.render(activate(raw), camera, view)
        torch.cuda.synchronize()
        drawn = time.perf_counter()
        picture = image.cpu().numpy() if reading else None
        times = {"compose": composed - started, "draw": drawn - composed}
        return picture, {**times, "read": time.perf_counter() - drawn} if reading else times

    return frame


def measure(gem: Gem, components: int, camera: Camera, engines: list[Engine], frames: int) -> list[Row]:
    """A row for each way; all draw the same frames in turns."""
    ways: dict[str, Way] = {engine.name: by_engine(gem, components, camera, engine) for engine in engines}
    if cuda.missing() is None:
        ways["gsplat, composed on the GPU"] = by_gsplat(gem, components, camera, "GPU", True)
        ways["gsplat, composed on the GPU, not read"] = by_gsplat(gem, components, camera, "GPU", False)
        ways["gsplat, composed by us"] = by_gsplat(gem, components, camera, "CPU", True)
    rng = np.random.default_rng(1)
    taken: dict[str, list[dict[str, float]]] = {name: [] for name in ways}
    off: dict[str, float] = {}
    for turn in range(-WARM, frames):
        noise = rng.standard_normal(gem.coefficient_count)
        coefficients = gem.clamped(gem.rest_coefficients + noise * gem.sigma)
        first: Picture | None = None
        for name, frame in ways.items():
            started = time.perf_counter()
            picture, times = frame(coefficients)
            whole = time.perf_counter() - started
            if turn >= 0:
                taken[name].append({**times, "frame": whole})
            if first is None:
                first = None if picture is None else picture.copy()
            elif picture is not None:
                off[name] = max(off.get(name, 0.0), float(np.square(picture - first).mean()))
    size, rows = f"{camera.width}x{camera.height}", []
    for name, times in taken.items():
        ms = {stage: round(1e3 * float(np.median([each[stage] for each in times])), 3) for stage in times[0]}
        psnr = round(float(-10 * np.log10(off[name])), 1) if off.get(name) else None
        rows.append(Row(gem.name, len(gem), components, size, name, ms, ms.pop("frame"), psnr))
    return rows


def scenes(avatars: Sequence[str], maps: int, components: int) -> list[Gem]:
    """A made-up avatar with a splat in every texel, and those that are named."""
    named = [load_gem(find_avatar(name)) for name in avatars]
    return [synthetic_gem(maps * maps, components, np.random.default_rng(0)), *named]


def machine(engines: Sequence[Engine]) -> list[str]:
    """What it ran on, a line each."""
    lines = [f"{cpu_name()}, {os.cpu_count()} cores; {date.today()}"]
    lines += [f"{engine.name}: {engine.description}" for engine in engines]
    if reason := cuda.missing():
        return [*lines, f"no gsplat: {reason}"]
    query = ["nvidia-smi", "--query-gpu=driver_version", "--format=csv,noheader"]
    driver = subprocess.run(query, capture_output=True, text=True, check=False).stdout.strip() or "unknown"
    try:
        release = version("gsplat")
    except PackageNotFoundError:
        release = "(version unknown)"
    return [*lines, f"gsplat {release}, torch {torch.__version__}: {torch.cuda.get_device_name()}, driver {driver}"]


def table(about: Sequence[str], rows: Sequence[Row]) -> str:
    """Markdown: what it ran on, and a line a row."""
    heads = ("avatar", "splats", "K", "size", "drawn by", *STAGES, "frame, ms", "frames/s", "PSNR to the first")
    lines = [*(f"- {line}" for line in about), "", "| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for row in rows:
        stages = [f"{row.ms[stage]:.2f}" if stage in row.ms else "" for stage in STAGES]
        rates = f"{row.frame:.2f}", f"{1e3 / row.frame:.0f}", "" if row.psnr is None else f"{row.psnr:.1f}"
        cells = (row.avatar, row.splats, row.components, row.size, row.way, *stages, *rates)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def main() -> int:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description="Time the engines beside gsplat.")
    parser.add_argument("avatars", nargs="*", help="names or files of avatars to measure besides a made-up one")
    parser.add_argument("--maps", type=int, default=256, help="texels along a side of the made-up avatar's maps")
    parser.add_argument("--components", type=int, default=50)
    parser.add_argument("--size", default="550x802", help="width x height")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--docs", type=Path, help=DOCS_HELP)
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    engines: list[Engine] = [SoftwareEngine()]
    with suppress(NoOpenGLError):
        quads = SplatRenderer(offscreen_context(), owns_context=True)
        quads.measures_stages = True
        engines.append(quads)
    about, rows = machine(engines), list[Row]()
    try:
        for gem in scenes(options.avatars, options.maps, options.components):
            components = min(options.components, gem.components)
            rows += measure(gem, components, portrait(gem.viewing, width, height), engines, options.frames)
    finally:
        for engine in engines:
            engine.close()
    text = table(about, rows)
    print(text)
    if options.json:
        options.json.write_text(json.dumps({"about": about, "rows": [asdict(row) for row in rows]}, indent=1) + "\n")
    if options.docs:
        put_table(options.docs, text)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
