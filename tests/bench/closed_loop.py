"""Closed loop: drive an avatar with clips, track the avatar's own pictures, compare what driver and avatar do.

    python tests/bench/closed_loop.py --avatar assets/avatars/NAME.gem [CLIP ...] [--json F] [--strip F.png]

For each clip and channel it prints the correlation over frames of the avatar with its driver: the unlearned baseline
(relative scores as ARKit weights) first, then the avatar's regressor. "-" marks a channel in which the driver hardly
moves. Below them, second opinions by landmark distances that do not go through the scores, and by how many millimetres
lips are off and how often they stay shut while the driver's are parted; at the end the medians again, to the third
digit, and one mean. `gemheads evaluate` with --drivers says more, of several avatars, on a page;
this one also tries regressors that are in no avatar yet.
"""

import argparse
import json
import sys
import tempfile
import textwrap
import time
from pathlib import Path

import cv2
import numpy as np
from gemheads.app.evaluation.drivers import opened_drivers
from gemheads.models.crossing.channels import CHANNELS, SCORE_CHANNELS
from gemheads.models.crossing.clip import Clip
from gemheads.models.crossing.compare import Compared, compare
from gemheads.models.crossing.kept import Kept
from gemheads.models.crossing.lips import PARTED_MM
from gemheads.models.crossing.loop import Echo, echo
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.driver.answer import Express, by_scores
from gemheads.models.driver.nodding import nodding_of
from gemheads.models.driver.regressor import Regressor
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from numpy.typing import NDArray

DRIVERS = Path(__file__).resolve().parents[3] / "shared" / "data" / "drivers"
WIDTH = 120
"""Letters a line of what is printed below the table."""
SHOTS = 10
"""Pictures of each clip in the film strip."""
OVERALL = [place for place, channel in enumerate(SCORE_CHANNELS) if channel.name not in ("yaw", "roll")]
"""Channels that the one mean is taken over: those of the head are followed by all."""
Figures = dict[str, dict[str, Compared]]
"""Clip -> run -> how well the avatar followed."""


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
    clips = options.clips or sorted(DRIVERS.glob("*.mp4"))
    if not clips:
        parser.error("no clips: name videos of faces")
    gem = load_gem(options.avatar)
    drivers = opened_drivers([str(path) for path in clips])
    kept = Kept(options.cache)
    clips = {driver.name: driver.tracked(options.every, options.seconds, kept).clip for driver in drivers}
    mirror = Mirror(gem, options.size)
    runs: dict[str, tuple[Express, int | None]] = {}
    if gem.arkit_weights is not None:
        runs["baseline"] = by_scores(gem), None
    graph = options.regressor.read_bytes() if options.regressor else gem.regressor
    if graph is not None:
        regressor = Regressor(graph, gem.coefficient_count, nodding_of(gem))
        runs |= {f"regressor, {m} components": (regressor, m) for m in options.components}
    if not runs:
        parser.error(f"{options.avatar} has neither ARKit weights nor a regressor: nothing drives it")
    figures: Figures = {}
    strips: list[NDArray[np.uint8]] = []
    for name, (express, components) in runs.items():
        for clip_name, clip in clips.items():
            began = time.perf_counter()
            shown = echo(clip, express, mirror, components)
            print(f"{clip_name}, {name}: {time.perf_counter() - began:.0f} s", file=sys.stderr)
            compared = compare(clip, shown)
            figures.setdefault(clip_name, {})[name] = compared
            if name == next((n for n in runs if n != "baseline"), "baseline"):
                strips += _strip(clip, shown)
    print(report(gem.name, figures, list(runs)))
    if options.json:
        options.json.write_text(json.dumps(_document(gem, clips, figures), indent=1) + "\n")
    if options.strip:
        cv2.imwrite(str(options.strip), cv2.cvtColor(np.concatenate(strips), cv2.COLOR_RGB2BGR))
    return 0


def _strip(clip: Clip, shown: Echo) -> list[NDArray[np.uint8]]:
    """SHOTS pictures of the driver in a row, and those of the avatar."""
    places = np.linspace(0, len(clip.readings) - 1, SHOTS + 2).round().astype(int)[1:-1]
    return [np.concatenate([album[int(i)] for i in places], 1) for album in (clip.pictures, shown.pictures)]


def report(avatar: str, figures: Figures, runs: list[str]) -> str:
    """The markdown table: one row a channel; in each cell one figure per run, in the order of ``runs``."""
    names = list(figures)

    def column(kind: str, run: str) -> NDArray[np.float64]:
        return np.array([getattr(figures[name][run].likeness, kind) for name in names], np.float64)

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
        for kind in ("correlation", "amplitude", "unrest"):
            kept = [column(kind, run)[moving[:, i], i] for run in runs]
            cells.append(" ".join(_figure(float(np.median(k))) if len(k) else "-" for k in kept))
        goal = "" if channel.goal is None else f"{channel.goal:g}"
        name = channel.name if channel in SCORE_CHANNELS else f"*{channel.name}*"
        lines.append(f"| {name} | {goal} | " + " | ".join(cells) + " |")
    for kind, name in (("off_mm", "lips off, mm"), ("shut", f"shut, of frames parted by {PARTED_MM:g} mm")):
        of_lips = {run: np.array([getattr(figures[name][run].lips, kind) for name in names]) for run in runs}
        cells = [" ".join(_figure(of_lips[run][c]) for run in runs) for c in range(len(names))]
        cells.append(" ".join(_figure(_median(each)) for each in of_lips.values()))
        lines.append(f"| *{name}* |  | " + " | ".join([*cells, "", ""]) + " |")
    medians = [np.nanmedian(of_clips[:, moving.any(0)], 0) for of_clips in correlation.values()]
    names = [channel.name for channel, moves in zip(CHANNELS, moving.any(0), strict=True) if moves]
    told = (f"{name} {' '.join(f'{one:.3f}' for one in each)}" for name, *each in zip(names, *medians, strict=True))
    means = (f"{run} {_overall(of_clips):.3f}" for run, of_clips in correlation.items())
    for line in (
        f"Medians ({'; '.join(runs)}): {'; '.join(told)}.",
        f"Mean of {len(OVERALL)} channels (not yaw and roll) of the means over all clips: {'; '.join(means)}.",
    ):
        lines += ["", textwrap.fill(line, WIDTH)]
    return "\n".join(lines)


def _overall(correlation: NDArray[np.float64]) -> float:
    """One figure of correlations [clips, channels]; NaN where a driver does not move."""
    moving = [place for place in OVERALL if not np.isnan(correlation[:, place]).all()]
    return float(np.nanmean(correlation[:, moving], 0).mean())


def _median(values: NDArray[np.float64]) -> float:
    known = values[~np.isnan(values)]
    return float(np.median(known)) if len(known) else float("nan")


def _figure(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.2f}".replace("0.", ".", 1) if abs(value) < 1 else f"{value:.2f}"


def _document(gem: Gem, clips: dict[str, Clip], figures: Figures) -> dict[str, object]:
    """All figures as plain JSON, NaN as null."""
    told = {
        clip: {
            run: {
                "correlation": one.likeness.correlation.tolist(),
                "amplitude": one.likeness.amplitude.tolist(),
                "jitter": one.likeness.unrest.tolist(),
                "driver_std": one.likeness.driver_std.tolist(),
                "avatar_unseen": [float(one.unseen)],
                "lips": [one.lips.off_mm, one.lips.shut],
            }
            for run, one in runs.items()
        }
        for clip, runs in figures.items()
    }
    tidy = json.loads(json.dumps(told), parse_constant=lambda _: None)
    about = {
        name: {"frames": len(clip.readings), "losses": clip.lost, "neutral": clip.reason}
        for name, clip in clips.items()
    }
    return {"avatar": gem.name, "channels": [c.name for c in CHANNELS], "clips": about, "figures": tidy}


if __name__ == "__main__":
    raise SystemExit(main())
