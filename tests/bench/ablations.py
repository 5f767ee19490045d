"""Choices that the paper leaves open, each tried the other way on a run's splats: docs/ablations.md.

    python tests/bench/ablations.py CAPTURE RUN [--quick] [--components 10 30] [--shots 8] [--iterations 600]
        [--docs docs/ablations.md] [--picture F.png]

Every variant is made of the run's splats at the training moments and answers those of held-out expressions, which are
then drawn as the capture's cameras saw them.
"""

import argparse
import platform
import sys
import tempfile
from collections.abc import Sequence
from datetime import date
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import cv2
import numpy as np
import torch
from ablating.lines import Ablation, Effort, Line
from gemheads.models.captures.reader import open_capture
from gemheads.models.train.avatars.runs import open_run
from gemheads.models.train.synthesis.fit import error_map
from results.pages import DOCS_HELP, put_table

HEADS = (
    *("", "to the run, moving", "to taken", "to taken, moving", "fitted", "fitted, moving"),
    *("coefficients", "numbers, M", "cut, %", "file, MB", "off orthonormal"),
)
QUICK = Effort(components=4, shots=2, iterations=10, evaluations=4)
ERROR_SCALE = 0.03
"""A difference to the run's own picture that is white in the sheet: what variants lose is faint."""


def main() -> int:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description="Try open choices the other way.")
    parser.add_argument("capture", type=Path)
    parser.add_argument("run", type=Path, help="of gemheads train")
    parser.add_argument("--quick", action="store_true", help="whether it runs, not what it says")
    parser.add_argument(
        "--components", type=int, nargs="+", default=[10, 30], help="a table for each; fits by the last"
    )
    parser.add_argument("--shots", type=int, default=Effort.shots, help="held-out pictures")
    parser.add_argument("--iterations", type=int, default=Effort.iterations, help="steps of refinement")
    parser.add_argument("--docs", type=Path, help=DOCS_HELP)
    parser.add_argument("--picture", type=Path, help="a sheet of the first held-out pictures, of the last table")
    options = parser.parse_args()
    capture = open_capture(options.capture)
    run = open_run(options.run, options.capture)
    tables: list[str] = []
    for effort in efforts(options):
        ablation, lines = Ablation(capture, run, effort), list[Line]()
        with tempfile.TemporaryDirectory() as folder:
            for line in ablation.lines(Path(folder)):
                lines.append(line)
                print(row(line), flush=True)
        tables.append("\n".join([f"{effort.components} components:", "", *table(lines), "", said(ablation)]))
        if options.picture:
            cv2.imwrite(str(options.picture), sheet(ablation, lines)[..., ::-1])
    text = "\n\n".join(tables)
    if options.docs:
        put_table(options.docs, text)
    return 0


def efforts(options: argparse.Namespace) -> list[Effort]:
    """One for each number of components; only the last one is refined and fitted, which takes most of the time."""
    if options.quick:
        return [QUICK]
    *some, last = options.components
    brief = [Effort(components, options.shots, 0, 0) for components in some]
    return [*brief, Effort(last, options.shots, options.iterations)]


def table(lines: Sequence[Line]) -> list[str]:
    """Markdown: a row a variant."""
    return [f"| {' | '.join(HEADS)} |", "|---|" + "---|" * (len(HEADS) - 1), *map(row, lines)]


def row(line: Line) -> str:
    """One row of it."""
    cells = [
        line.name,
        "-" if line.to_run is None else f"{line.to_run.moving:.2f}",
        f"{line.to_taken.everywhere:.2f}",
        f"{line.to_taken.moving:.2f}",
        "-" if line.fitted is None else f"{line.fitted.everywhere:.2f}",
        "-" if line.fitted is None else f"{line.fitted.moving:.2f}",
        f"{line.coefficients or '-'}",
        f"{line.numbers / 1e6:.2f}" if line.numbers else "-",
        "-" if line.impossible is None else f"{100 * line.impossible:.1f}",
        "-" if line.megabytes is None else f"{line.megabytes:.1f}",
        "-" if line.off_orthonormal is None else f"{line.off_orthonormal:.0e}",
    ]
    return f"| {' | '.join(cells)} |"


def said(ablation: Ablation) -> str:
    """What was measured, and where."""
    capture, effort = ablation.capture, ablation.effort
    camera = capture.train[0].camera
    counted = f"{len(ablation.shots)} pictures of held-out expressions, {len(capture.timesteps('train'))} moments"
    return (
        f"{capture.subject}, {camera.width}x{camera.height}: {counted} to learn from, {len(ablation.gem)} splats,"
        f" {effort.evaluations} evaluations a fit. {platform.machine()},"
        f" torch {torch.__version__}, {date.today()}."
    )


def sheet(ablation: Ablation, lines: Sequence[Line], columns: int = 3) -> np.ndarray:
    """Rows: taken, the run's own, each variant beside its difference to the run's own; the most frontal pictures."""
    ahead = [shot.camera.center[2] / np.linalg.norm(shot.camera.center) for shot in ablation.shots]
    places = np.argsort(ahead)[::-1][:columns]
    rows = [_captioned("taken", [np.hstack([ablation.taken[p], np.ones_like(ablation.taken[p])]) for p in places])]
    rows.append(
        _captioned("the run", [np.hstack([ablation.drawn[p], np.ones_like(ablation.drawn[p])]) for p in places])
    )
    for line in lines:
        errors = [error_map(line.images[p], ablation.drawn[p], ERROR_SCALE).astype(np.float32) / 255 for p in places]
        rows.append(
            _captioned(line.name, [np.hstack([line.images[p], e]) for p, e in zip(places, errors, strict=True)])
        )
    return np.vstack(rows)


def _captioned(name: str, cells: Sequence[np.ndarray]) -> np.ndarray:
    picture = np.round(255 * np.clip(np.hstack(cells), 0, 1)).astype(np.uint8)
    bar = np.full((20, picture.shape[1], 3), 255, np.uint8)
    cv2.putText(bar, name, (4, 15), cv2.FONT_HERSHEY_SIMPLEX, 0.45, (0, 0, 0), 1, cv2.LINE_AA)
    return np.vstack([bar, picture])


if __name__ == "__main__":
    raise SystemExit(main())
