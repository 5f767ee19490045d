"""Quality, size and speed of avatars with more or fewer components (Table 4) as plain values of report.json."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from ....models.captures.layout import Shot
from ....models.metrics.tables import SIZES, SIZES_OF
from .summary import ABOUT, TITLES, means

if TYPE_CHECKING:
    from ....models.train.judging.ledger import Record


@dataclass(frozen=True)
class Variant:
    """An avatar with some of its components; a run as it is."""

    label: str
    """What tables and pictures call it."""
    avatar: str
    """The column that it is of."""
    kind: str
    maps: int
    """Texels along a side of its UV map."""
    splats: int
    components: int | None
    """None for a run."""
    megabytes: Mapping[str, float]
    """How its numbers are stored -> size: int8 and fp16 for a GEM's file without a regressor, fp32 for a network."""


@dataclass(frozen=True)
class Pace:
    """How long frames took: compose, sort and draw, all variants in turns."""

    engine: str
    renderer: str
    """The OpenGL renderer, or threads."""
    width: int
    height: int
    rounds: int
    """Frames in a median."""
    milliseconds: Mapping[str, float]
    """Label -> median of a frame."""


def sizes_json(
    split: str,
    shots: Sequence[Shot],
    variants: Sequence[Variant],
    records: Mapping[str, Sequence["Record"]],
    pace: Pace,
    notes: Sequence[str],
) -> dict[str, Any]:
    """The part of report.json.

    Args:
        split: val or test: what was judged by.
        shots: of that split.
        variants: in the order of the table.
        records: label -> a record for each shot.
        pace: of all variants.
        notes: what was left out, and why.
    """
    rows = []
    for variant in variants:
        spent = pace.milliseconds[variant.label]
        measured = means([record.values for record in records[variant.label]])
        rows.append({**asdict(variant), "means": measured, "frame_ms": round(spent, 3), "fps": round(1000 / spent, 1)})
    pictures = [
        {
            "timestep": shot.timestep,
            "camera": shot.camera_index,
            "values": {label: dict(of[index].values) for label, of in records.items()},
        }
        for index, shot in enumerate(shots)
    ]
    return {
        "title": TITLES[split],
        "about": ABOUT[split],
        "rows": rows,
        "pictures": pictures,
        "engine": pace.engine,
        "renderer": pace.renderer,
        "size": f"{pace.width}x{pace.height}",
        "rounds": pace.rounds,
        "published": [asdict(row) for row in SIZES],
        "published_of": SIZES_OF,
        "notes": list(notes),
    }


def sizes_said(figures: Mapping[str, Any]) -> list[str]:
    """A line for each row, for the terminal."""
    lines = []
    for row in figures["rows"]:
        stored = ", ".join(f"{size:.2f} MB {form}" for form, size in row["megabytes"].items())
        psnr = row["means"]["PSNR"]
        lines.append(f"{row['label']}, {row['maps']} maps: PSNR {psnr:.2f}, {stored}, {row['fps']:.1f} frames/s")
    return [*lines, *figures["notes"]]
