"""The comparison as a table for the terminal and as docs/peers.md."""

import os
from dataclasses import dataclass
from datetime import date
from statistics import median

from gemheads.app.machine import cpu_name
from packages import PINNED
from viewers import Times

LABELS = {
    "software": "gemheads, software",
    "quads": "gemheads, quads",
    "gaussian-splats-3d": f"GaussianSplats3D {PINNED['@mkkellogg/gaussian-splats-3d']}",
    "spark": f"Spark {PINNED['@sparkjsdev/spark']}",
}
HEADINGS = ("viewer", "sort", "frame", "frames/s", "x software", "x quads", "PSNR dB")


@dataclass(frozen=True)
class Row:
    """One viewer at one size."""

    width: int
    height: int
    viewer: str
    times: list[Times]
    """Of the frames that every viewer drew from the same cameras, in the same order."""
    psnr: float
    """Of a picture in bytes against the float64 reference, decibels."""


@dataclass(frozen=True)
class Comparison:
    """What was measured, and on what."""

    avatar: str
    splats: int
    frames: int
    """Behind each median."""
    machine: str
    browser: str
    renderers: dict[str, str]
    """Viewer -> what draws, as it names itself."""
    rows: list[Row]


def machine() -> str:
    """Processor, cores, and how busy they are with other things."""
    load = f", load {os.getloadavg()[0]:.1f} when it began" if hasattr(os, "getloadavg") else ""
    return f"{cpu_name()}, {os.cpu_count()} cores{load}"


def ratio(row: Row, to: Row) -> float:
    """Median over frames of this viewer's time over the other's for the same frame: drift of the machine drops out."""
    return median(mine.frame / other.frame for mine, other in zip(row.times, to.times, strict=True))


def tables(comparison: Comparison) -> dict[str, list[tuple[str, ...]]]:
    """Size -> rows as in HEADINGS."""
    found: dict[str, list[tuple[str, ...]]] = {}
    for width, height in dict.fromkeys((row.width, row.height) for row in comparison.rows):
        rows = {row.viewer: row for row in comparison.rows if (row.width, row.height) == (width, height)}
        found[f"{width}x{height}"] = [_cells(row, rows) for row in rows.values()]
    return found


def printed(comparison: Comparison) -> str:
    """For the terminal."""
    lines = [_what(comparison), comparison.machine, comparison.browser]
    lines += [f"{LABELS[name]}: {renderer}" for name, renderer in comparison.renderers.items()]
    for size, rows in tables(comparison).items():
        table = [(size, *HEADINGS[1:]), *rows]
        widths = [max(len(row[i]) for row in table) for i in range(len(HEADINGS))]
        lines.append("")
        for name, *figures in table:
            aligned = (figure.rjust(width) for figure, width in zip(figures, widths[1:], strict=True))
            lines.append("  ".join([name.ljust(widths[0]), *aligned]))
    return "\n".join(lines)


def written(comparison: Comparison) -> str:
    """docs/peers.md."""
    lines = [
        "# Beside other viewers",
        "",
        f"Printed by `python tests/bench/peers/compare.py --write` on {date.today()}: {_what(comparison)}.",
        "Milliseconds, medians; a frame is sorted, drawn, and done by the GPU. `x software`, `x quads`: how many times",
        "as long as that engine of ours takes for the same frame, median. PSNR: to the float64 reference, on grey.",
        "What is counted and what is not: [tests/bench/peers](../tests/bench/peers/README.md).",
        "",
        f"- {comparison.machine}",
        f"- {comparison.browser}; three.js {PINNED['three']}",
        *(f"- {LABELS[name]}: {renderer}" for name, renderer in comparison.renderers.items()),
    ]
    for size, rows in tables(comparison).items():
        head = [(size, *HEADINGS[1:]), ("---", *("---:" for _ in HEADINGS[1:]))]
        lines += ["", *(f"| {' | '.join(cells)} |" for cells in (*head, *rows))]
    return "\n".join(lines) + "\n"


def _what(comparison: Comparison) -> str:
    return f"{comparison.avatar}, {comparison.splats:,} splats, {comparison.frames} frames of each viewer in turns"


def _cells(row: Row, rows: dict[str, Row]) -> tuple[str, ...]:
    sort, frame = median(time.sort for time in row.times), median(time.frame for time in row.times)
    ratios = (f"{ratio(row, rows[name]):.2f}" for name in ("software", "quads"))
    return LABELS[row.viewer], f"{sort:.1f}", f"{frame:.1f}", f"{1e3 / frame:.1f}", *ratios, f"{row.psnr:.1f}"
