"""Closed loop: drive an avatar with clips, track the avatar's own pictures, compare what driver and avatar do.

    python tests/bench/closed_loop.py --avatar assets/avatars/NAME.gem [CLIP ...] [--json F] [--strip F.png]

For each clip and channel it prints the correlation over frames of the avatar with its driver: the unlearned baseline
(relative scores as ARKit weights) first, then the avatar's regressor. "-" marks a channel in which the driver hardly
moves. Below them, second opinions by landmark distances that do not go through the scores.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from channels import CHANNELS, SCORE_CHANNELS, Array, Reading, amplitudes, correlations, jitters, table
from clips import SHOT_SIDE, Clip, load_clip
from gemheads.models.driver.baseline import baseline_weights
from gemheads.models.driver.features import relative_rotation
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from mirror import Mirror, small
from numpy.typing import NDArray

DRIVERS = Path(__file__).resolve().parents[3] / "shared" / "data" / "drivers"
Driving = Callable[[NDArray[np.float32], Array], NDArray[np.float32]]
"""Relative features [D] and relative head rotation [3] to coefficients."""


def main() -> int:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description="Compare drivers with the avatar that repeats them.")
    parser.add_argument("clips", nargs="*", type=Path, help=f"videos of faces (default: those of {DRIVERS.name}/)")
    parser.add_argument("--avatar", type=Path, required=True, help=".gem file")
    parser.add_argument("--regressor", type=Path, help="an ONNX graph to try instead of the avatar's own")
    parser.add_argument("--components", type=int, nargs="+", default=[50, 30], help="components drawn by the regressor")
    parser.add_argument("--every", type=int, default=3, help="take each N-th frame")
    parser.add_argument("--seconds", type=float, default=30.0, help="of each clip")
    parser.add_argument("--size", type=int, default=384, help="side of the avatar's picture")
    parser.add_argument("--cache", type=Path, default=Path(tempfile.gettempdir()) / "gemheads-closed-loop")
    parser.add_argument("--json", type=Path, help="write every figure there")
    parser.add_argument("--strip", type=Path, help="write a film strip of driver above avatar there (PNG)")
    options = parser.parse_args()
    gem = load_gem(options.avatar)
    paths = options.clips or sorted(DRIVERS.glob("*.mp4"))
    clips = [load_clip(path, options.every, options.seconds, options.cache) for path in paths]
    mirror = Mirror(gem, options.size)
    runs: dict[str, tuple[Driving, int | None]] = {}
    if gem.arkit_weights is not None:
        runs["baseline"] = (_baseline(gem), None)
    graph = options.regressor.read_bytes() if options.regressor else gem.regressor
    if graph is not None:
        regressor = Regressor(graph, gem.coefficient_count)
        runs |= {f"regressor, {m} components": (regressor, m) for m in options.components}
    if not runs:
        parser.error(f"{options.avatar} has neither ARKit weights nor a regressor: nothing drives it")
    figures: dict[str, dict[str, dict[str, list[float]]]] = {}
    strips: list[NDArray[np.uint8]] = []
    for name, (driving, components) in runs.items():
        neutral = mirror.neutral(components)
        for clip in clips:
            began = time.perf_counter()
            shown, pictures = _driven(clip, driving, mirror, components)
            print(f"{clip.name}, {name}: {time.perf_counter() - began:.0f} s", file=sys.stderr)
            figures.setdefault(clip.name, {})[name] = _compared(clip, shown, neutral)
            if name == next((n for n in runs if n != "baseline"), "baseline"):
                strips += [np.concatenate(list(clip.shots), 1), np.concatenate(pictures, 1)]
    print(report(gem.name, clips, figures, list(runs)))
    if options.json:
        options.json.write_text(json.dumps(_document(gem, clips, figures), indent=1) + "\n")
    if options.strip:
        cv2.imwrite(str(options.strip), cv2.cvtColor(np.concatenate(strips), cv2.COLOR_RGB2BGR))
    return 0


def _baseline(gem: Gem) -> Driving:
    return lambda relative, _: gem.arkit_coefficients(baseline_weights(relative))


def _driven(
    clip: Clip, driving: Driving, mirror: Mirror, components: int | None
) -> tuple[list[Reading | None], list[NDArray[np.uint8]]]:
    """What the tracker reads off the avatar for each frame of a clip, and the pictures beside the clip's shots."""
    readings: list[Reading | None] = []
    pictures: list[NDArray[np.uint8]] = []
    mirror.restart()
    for i, reading in enumerate(clip.readings):
        rotation = relative_rotation(reading.rotation, clip.neutral.rotation)
        coefficients = driving(reading.features - clip.neutral.features, rotation)
        picture = mirror.draw(coefficients, rotation, components)
        readings.append(mirror.read(picture))
        pictures += [small(picture, SHOT_SIDE)] * clip.shot_frames.count(i)
    return readings, pictures


def _compared(clip: Clip, shown: list[Reading | None], neutral: Reading) -> dict[str, list[float]]:
    """Figures by channel of one clip, over the frames in which the avatar was seen too."""
    pairs = [(mine, its) for mine, its in zip(clip.readings, shown, strict=True) if its is not None]
    driver = table([mine for mine, _ in pairs], clip.neutral)
    avatar = table([its for _, its in pairs], neutral)
    return {
        "correlation": correlations(driver, avatar).tolist(),
        "amplitude": amplitudes(driver, avatar).tolist(),
        "jitter": jitters(driver, avatar).tolist(),
        "driver_std": driver.std(0).tolist(),
        "avatar_unseen": [float(len(shown) - len(pairs))],
    }


def report(
    avatar: str, clips: list[Clip], figures: dict[str, dict[str, dict[str, list[float]]]], runs: list[str]
) -> str:
    """The markdown table: one row a channel; in each cell one figure per run, in the order of ``runs``."""
    names = [clip.name for clip in clips]

    def column(kind: str, run: str) -> Array:
        return np.array([figures[name][run][kind] for name in names], np.float64)

    correlation = {run: column("correlation", run) for run in runs}
    moving = ~np.isnan(correlation[runs[0]])
    lines = [
        f"Avatar {avatar}. In each cell: {'; '.join(runs)}. Amplitude and jitter are avatar over driver.",
        "",
        "| channel | goal | " + " | ".join([*names, "median", "amplitude", "jitter"]) + " |",
        "|---|---|" + "---|" * (len(names) + 3),
    ]
    for i, channel in enumerate(CHANNELS):
        cells = [" ".join(_figure(correlation[run][c, i]) for run in runs) for c in range(len(names))]
        for kind in ("correlation", "amplitude", "jitter"):
            kept = [column(kind, run)[moving[:, i], i] for run in runs]
            cells.append(" ".join(_figure(float(np.median(k))) if len(k) else "-" for k in kept))
        goal = "" if channel.goal is None else f"{channel.goal:g}"
        name = channel.name if channel in SCORE_CHANNELS else f"*{channel.name}*"
        lines.append(f"| {name} | {goal} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _figure(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.2f}".replace("0.", ".", 1) if abs(value) < 1 else f"{value:.2f}"


def _document(gem: Gem, clips: list[Clip], figures: dict[str, dict[str, dict[str, list[float]]]]) -> dict[str, object]:
    """All figures as plain JSON, NaN as null."""
    tidy = json.loads(json.dumps(figures), parse_constant=lambda _: None)
    about = {clip.name: {"frames": len(clip.readings), "losses": clip.losses, "neutral": clip.reason} for clip in clips}
    return {"avatar": gem.name, "channels": [c.name for c in CHANNELS], "clips": about, "figures": tidy}


if __name__ == "__main__":
    raise SystemExit(main())
