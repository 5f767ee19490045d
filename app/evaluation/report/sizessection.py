"""The page's section on components and map sizes: Table 4 and Figure 8 of the paper."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from ....models.metrics.tables import DIGITS, LARGER_IS_BETTER
from .compared import compared, film_strip
from .curves import color_of, curve_svg
from .pictures import Gallery
from .pieces import row, table

FORMS = ("int8", "fp16", "fp32")


def sizes_section(figures: Mapping[str, Any], gallery: Gallery, avatars: Sequence[str]) -> str:
    """HTML of ``figures``, which report.json holds, and the pictures; ``avatars`` are all columns of the report, of
    which some may have no row here."""
    parts = ["<h2>Components and map size</h2>", f"<p>{escape(_about(figures))}</p>"]
    parts += [f"<p class='note'>{escape(note)}</p>" for note in figures["notes"]]
    parts.append(_table(figures) + _published(figures))
    parts.append(f"<div class='curves'>{_over_components(figures, avatars)}{_over_time(figures)}</div>")
    names = [told["label"] for told in figures["rows"]]
    parts.append(f"<h3>Where fewer components differ</h3>{compared(gallery, figures['pictures'], names)}")
    return "".join([*parts, film_strip(gallery)])


def _about(figures: Mapping[str, Any]) -> str:
    return (
        f"Each GEM with its first components alone, on {len(figures['pictures'])} pictures of"
        f" {figures['about'].split('(')[0].strip()}: fitted anew with so many, in other cameras' pictures."
        " MB is the avatar's file without a regressor, as int8 and as fp16; of a run, the weights as fp32."
        f" Frames are composed, sorted and drawn at {figures['size']} by {figures['engine']} ({figures['renderer']}),"
        f" all rows in turns, medians of {figures['rounds']}."
    )


def _table(figures: Mapping[str, Any]) -> str:
    heads = ["", "maps", "components", *(f"{m} {'↑' if m in LARGER_IS_BETTER else '↓'}" for m in DIGITS)]
    heads += [*(f"MB {form}" for form in FORMS), "ms a frame", "frames/s"]
    rows = []
    for index, told in enumerate(figures["rows"]):
        dot = f"<i style='background:{color_of(index)}'></i>"
        cells = [dot + escape(told["avatar"]), str(told["maps"]), _count(told["components"])]
        cells += [_number(told["means"].get(metric), digits) for metric, digits in DIGITS.items()]
        cells += [_number(told["megabytes"].get(form), 2) for form in FORMS]
        rows.append(row([*cells, _number(told["frame_ms"], 2), _number(told["fps"], 1)]))
    return table(heads, rows)


def _published(figures: Mapping[str, Any]) -> str:
    """The paper's own, laid out as there: a row for each count of components, columns for each map size."""
    maps = sorted({told["maps"] for told in figures["published"]})
    lines: dict[str, dict[int, Mapping[str, Any]]] = {}
    for told in figures["published"]:
        line = told["method"] if told["components"] is None else f"{told['method']}, {told['components']} components"
        lines.setdefault(line, {})[told["maps"]] = told
    rows = []
    for line, cells in lines.items():
        shown = [_cells(cells[size]) for size in maps]
        rows.append(row([f"<em>{cell}</em>" for cell in (escape(line), *(text for part in shown for text in part))]))
    heads = ["*", *(f"{name}, {size} maps" for size in maps for name in ("PSNR", "MB", "frames/s"))]
    return f"<h3>In the paper</h3>{table(heads, rows)}<p class='small'>* {escape(figures['published_of'])}</p>"


def _cells(told: Mapping[str, Any]) -> list[str]:
    return [_number(told["psnr"], 2), f"{told['megabytes']:g}", _number(told["fps"], 1)]


def _over_components(figures: Mapping[str, Any], avatars: Sequence[str]) -> str:
    """PSNR of each avatar by how many of its components are used; who has no line keeps the colour."""
    counts = sorted({told["components"] for told in figures["rows"] if told["components"] is not None})
    series: dict[str, list[float | None]] = {}
    colors: dict[str, str] = {}
    for told in figures["rows"]:
        if told["components"] is None:
            continue
        name = f"{told['avatar']}, {told['maps']} maps"
        colors[name] = color_of(avatars.index(told["avatar"]))
        line = series.setdefault(name, [None] * len(counts))
        line[counts.index(told["components"])] = told["means"]["PSNR"]
    labels = [f"{count} components" for count in counts]
    return curve_svg("PSNR by components, colours of the avatars", series, labels, DIGITS["PSNR"], [*colors.values()])


def _over_time(figures: Mapping[str, Any]) -> str:
    pictures = figures["pictures"]
    labels = [f"moment {picture['timestep']}, camera {picture['camera']}" for picture in pictures]
    names = [told["label"] for told in figures["rows"]]
    series = {name: [picture["values"][name]["PSNR"] for picture in pictures] for name in names}
    return curve_svg("PSNR over the pictures, colours of the rows", series, labels, DIGITS["PSNR"])


def _count(components: int | None) -> str:
    return "-" if components is None else str(components)


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
