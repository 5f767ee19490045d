"""How good each way to an avatar is where nothing was learned from: a camera held out, and expressions held out.

    python tests/bench/learning_table.py CAPTURE --mesh mesh.gem --run RUN --distilled D.gem --refined R.gem
        [--moments R.track] [--shots 24] [--network vgg] [--json F] [--picture F.png] [--docs docs/learning.md]

The mesh's avatar, the CNN and the distilled avatar are driven by the tracked mesh; so is the refined one on expressions
held out, by way of the CNN, while on moments it was refined on it knows its coefficients. "fitted" is the refined
avatar with expression and head pose found by analysis by synthesis: in the pictures of the same moment from other
cameras, never in the one that is judged.
"""

import argparse
import json
import platform
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import date
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import cv2
import numpy as np
import torch
from gemheads.app.performing.tracks import load_track
from gemheads.models.captures.layout import Shot
from gemheads.models.captures.reader import Capture, open_capture
from gemheads.models.captures.standin import StandIn
from gemheads.models.captures.texels import texels_of
from gemheads.models.gemfile import load_gem
from gemheads.models.metrics.tables import DIGITS, METRICS
from gemheads.models.train.avatars.runs import open_run
from gemheads.models.train.deck import spaced
from gemheads.models.train.judging.contestants import GemContestant, neck_of
from gemheads.models.train.judging.judge import Judge
from gemheads.models.train.perceptual import Perceptual, WeightsMissing
from gemheads.models.train.synthesis.fit import error_map
from gemheads.render.arrays import Floats32
from gemheads.render.gaussians import RawGaussians
from numpy.typing import NDArray
from results.pages import DOCS_HELP, put_table

Pose = tuple[Floats32, Floats32]
SPLITS = {"val": "held-out view", "test": "held-out expression"}


@dataclass(frozen=True)
class Method:
    """One way to an avatar."""

    name: str
    answer: Callable[[Shot, str], tuple[RawGaussians, Pose | None]]
    """Shot and split to canonical splats and the head's pose; None: as tracked."""
    neck_weights: Floats32
    neck_pivot: Floats32


def main() -> int:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description="Compare ways to an avatar on pictures held out.")
    parser.add_argument("capture", type=Path)
    parser.add_argument("--mesh", type=Path, required=True, help="the .gem of the bare mesh")
    parser.add_argument("--run", type=Path, required=True, help="the CNN's run")
    parser.add_argument("--distilled", type=Path, required=True)
    parser.add_argument("--refined", type=Path, required=True)
    parser.add_argument("--moments", type=Path, help="the track of refine --moments")
    parser.add_argument("--shots", type=int, default=24, help="pictures that are judged, half of them of each split")
    parser.add_argument("--network", choices=["vgg", "alex", "none"], default="vgg", help="LPIPS by which network")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--docs", type=Path, help=DOCS_HELP)
    options = parser.parse_args()
    capture = open_capture(options.capture)
    shots = judged_shots(capture, options.shots)
    if not shots:
        parser.error(f"{options.capture} holds out no pictures (val, test), so nothing can be judged")
    methods = _methods(capture, shots, options)
    figures, rows = measure(capture, shots, methods, Judge(_network(options.network)))
    text = table(figures, capture, shots)
    print(text)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")
    if options.picture:
        cv2.imwrite(str(options.picture), np.concatenate([_titles(methods, rows[0]), *rows])[..., ::-1])
    if options.docs:
        put_table(options.docs, text)
    return 0


def judged_shots(capture: Capture, count: int) -> dict[str, list[Shot]]:
    """Split -> pictures: the held-out camera, in both; a split without pictures is left out."""
    cameras = {shot.camera_index for shot in capture.val}
    test = [shot for shot in capture.test if shot.camera_index in cameras] or list(capture.test)
    shots = {"val": spaced(capture.val, count // 2), "test": spaced(test, count - count // 2)}
    return {split: taken for split, taken in shots.items() if taken}


def measure(
    capture: Capture, shots: Mapping[str, list[Shot]], methods: list[Method], judge: Judge
) -> tuple[dict[str, dict[str, dict[str, float]]], list[NDArray[np.uint8]]]:
    """Split -> method -> metric -> mean; and for the middle picture of each split, and the last, a row of pictures."""
    standin, rows = StandIn(capture), []
    figures: dict[str, dict[str, dict[str, float]]] = {}
    for split, taken in shots.items():
        values: dict[str, list[dict[str, float | None]]] = {method.name: [] for method in methods}
        shown = {taken[len(taken) // 2].picture, taken[-1].picture}
        for shot in taken:
            truth = standin.truth(shot)
            cells = [np.concatenate([_bytes(truth), np.full(truth.shape, 255, np.uint8)])]
            for method in methods:
                raw, pose = method.answer(shot, split)
                image = standin.draw(raw, method.neck_weights, method.neck_pivot, shot, pose)
                values[method.name].append(judge.measured(image, truth))
                cells.append(np.concatenate([_bytes(image), error_map(image, truth)]))
            if shot.picture in shown:
                rows.append(np.concatenate(cells, 1))
        figures[split] = {
            name: {metric: float(np.mean([_number(of[metric]) for of in measured])) for metric in METRICS}
            for name, measured in values.items()
        }
    return figures, rows


def table(figures: Mapping[str, Mapping[str, Mapping[str, float]]], capture: Capture, shots: Mapping[str, list]) -> str:
    """Markdown: one row a method, its metrics on each split."""
    heads = [f"{metric}, {SPLITS[split]}" for split in figures for metric in METRICS]
    lines = ["| | " + " | ".join(heads) + " |", "|---|" + "---|" * len(heads)]
    for name in next(iter(figures.values())):
        cells = [f"{figures[split][name][m]:.{DIGITS[m]}f}".replace("nan", "-") for split in figures for m in METRICS]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    size = f"{capture.train[0].camera.width}x{capture.train[0].camera.height}"
    counted = ", ".join(f"{len(taken)} pictures of a {SPLITS[split]}" for split, taken in shots.items())
    machine = f"{platform.machine()}, {torch.get_num_threads()} threads, torch {torch.__version__}"
    return "\n".join([*lines, "", f"{capture.subject}, {size}: {counted}. {machine}, {date.today()}."])


def _methods(capture: Capture, shots: Mapping[str, list[Shot]], options: argparse.Namespace) -> list[Method]:
    run = open_run(options.run, options.capture)
    mesh, distilled, refined = (load_gem(path) for path in (options.mesh, options.distilled, options.refined))
    texels = texels_of(capture.template, mesh.uv_size)
    rest = texels.splats(mesh.colors)
    known = {}
    if options.moments:
        track = load_track(options.moments)
        known = dict(zip(track.pts.tolist(), track.poses, strict=True))

    def by_mesh(shot: Shot, _: str) -> tuple[RawGaussians, None]:
        carried = texels.carried(rest, capture.tracked(shot.timestep).vertices)
        return mesh.compose(mesh.project(carried)), None

    def by_cnn(shot: Shot, _: str) -> tuple[RawGaussians, None]:
        return run.splats(capture.tracked(shot.timestep)), None

    def by_distilled(shot: Shot, split: str) -> tuple[RawGaussians, None]:
        return distilled.compose(distilled.project(by_cnn(shot, split)[0])), None

    def by_refined(shot: Shot, split: str) -> tuple[RawGaussians, Pose | None]:
        if split == "val" and shot.timestep in known:
            pose = known[shot.timestep]
            return refined.compose(pose.coefficients), (pose.turn, pose.translation)
        return refined.compose(refined.project(by_cnn(shot, split)[0])), None

    fitter = GemContestant(refined, capture)

    def by_fit(shot: Shot, split: str) -> tuple[RawGaussians, Pose]:
        act = fitter.act(shot, split)
        return refined.compose(act.coefficients), (act.turn, act.move)

    return [
        Method("bare mesh GEM", by_mesh, mesh.neck_weights, mesh.neck_pivot),
        Method("CNN", by_cnn, *neck_of(run)),
        Method("GEM distilled", by_distilled, distilled.neck_weights, distilled.neck_pivot),
        Method("GEM refined", by_refined, refined.neck_weights, refined.neck_pivot),
        Method("GEM fitted", by_fit, refined.neck_weights, refined.neck_pivot),
    ]


def _network(name: str) -> Perceptual | None:
    if name == "none":
        return None
    try:
        return Perceptual(name)
    except WeightsMissing as error:
        print(f"without LPIPS: {error}")
        return None


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _bytes(image: Floats32) -> NDArray[np.uint8]:
    return np.round(255 * np.clip(image, 0, 1)).astype(np.uint8)


def _titles(methods: list[Method], row: NDArray[np.uint8]) -> NDArray[np.uint8]:
    bar = np.full((22, row.shape[1], 3), 255, np.uint8)
    width = row.shape[1] // (len(methods) + 1)
    for index, name in enumerate(["taken", *(method.name for method in methods)]):
        cv2.putText(bar, name, (index * width + 6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
    return bar


if __name__ == "__main__":
    raise SystemExit(main())
