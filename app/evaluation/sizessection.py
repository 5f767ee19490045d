"""The page's section on components and map sizes: Table 4 and Figure 8 of the paper."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from ...models.metrics.tables import DIGITS, LARGER_IS_BETTER
from .curves import curve_svg
from .pictures import Gallery
from .pieces import row, table

FORMS = ("int8", "fp16", "fp32")


def sizes_section(figures: Mapping[str, Any], gallery: Gallery) -> str:
    """HTML of ``figures``, which report.json holds, and the pictures."""
    parts = ["<h2>Components and map size</h2>", f"<p>{escape(_about(figures))}</p>"]
    parts += [f"<p class='note'>{escape(note)}</p>" for note in figures["notes"]]
    parts.append(_table(figures))
    parts.append(f"<p class='small'>* {escape(figures['published_of'])}</p>")
    parts.append(f"<div class='curves'>{_over_components(figures)}{_over_time(figures)}</div>")
    parts.append(_compared(figures, gallery))
    strips = "".join(
        f"<tr><th>{escape(who) or 'taken'}</th><td><img alt='{escape(who) or 'taken'}' src='{url}'></td></tr>"
        for who, url in gallery.strips.items()
    )
    parts.append(f"<h3>Film strip</h3><table class='strip'>{strips}</table>")
    return "".join(parts)


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
    for told in figures["rows"]:
        cells = [escape(told["avatar"]), str(told["maps"]), _count(told["components"])]
        cells += [_number(told["means"].get(metric), digits) for metric, digits in DIGITS.items()]
        cells += [_number(told["megabytes"].get(form), 2) for form in FORMS]
        rows.append(row([*cells, _number(told["frame_ms"], 2), _number(told["fps"], 1)]))
    for told in figures["published"]:
        cells = [f"paper: {escape(told['method'])} *", str(told["maps"]), _count(told["components"])]
        cells += [_number(told["psnr"], 2), *("-" for _ in list(DIGITS)[1:])]
        cells += ["-", "-", f"{told['megabytes']:g}", "-", _number(told["fps"], 1)]
        rows.append(row([f"<em>{cell}</em>" for cell in cells]))
    return table(heads, rows)


def _over_components(figures: Mapping[str, Any]) -> str:
    """PSNR of each avatar by how many of its components are used."""
    rows = [told for told in figures["rows"] if told["components"] is not None]
    counts = sorted({told["components"] for told in rows})
    series: dict[str, list[float | None]] = {}
    for told in rows:
        line = series.setdefault(f"{told['avatar']}, {told['maps']} maps", [None] * len(counts))
        line[counts.index(told["components"])] = told["means"]["PSNR"]
    return curve_svg("PSNR by components", series, [f"{count} components" for count in counts], DIGITS["PSNR"])


def _over_time(figures: Mapping[str, Any]) -> str:
    pictures = figures["pictures"]
    labels = [f"moment {picture['timestep']}, camera {picture['camera']}" for picture in pictures]
    names = [told["label"] for told in figures["rows"]]
    series = {name: [picture["values"][name]["PSNR"] for picture in pictures] for name in names}
    return curve_svg("PSNR over the pictures", series, labels, DIGITS["PSNR"])


def _compared(figures: Mapping[str, Any], gallery: Gallery) -> str:
    """Figure 8: what was taken, and what each drew with its difference."""
    names = [told["label"] for told in figures["rows"]]
    parts = ["<h3>Where fewer components differ</h3><p class='small'>drawn | difference: black is none,"]
    parts.append(" <span class='heat'></span> white is 0.1 of full scale or more. Worst, median and best by PSNR of")
    parts.append(f" {escape(names[0])}.</p>")
    for word, place in gallery.choice.compared.items():
        picture = figures["pictures"][place]
        parts.append(f"<h4>{word}: moment {picture['timestep']}, camera {picture['camera']}</h4><div class='sized'>")
        parts.append(_figure(["taken"], [gallery.drawn["", place]], "taken"))
        for name in names:
            psnr = _number(picture["values"][name]["PSNR"], DIGITS["PSNR"])
            images = [gallery.drawn[name, place], gallery.errors[name, place]]
            parts.append(_figure(["drawn", "difference"], images, f"{name}, {psnr} dB"))
        parts.append("</div>")
    return "".join(parts)


def _figure(words: Sequence[str], images: Sequence[str], caption: str) -> str:
    shown = "".join(f"<img alt='{word}' src='{url}'>" for word, url in zip(words, images, strict=True))
    return f"<figure>{shown}<figcaption>{escape(caption)}</figcaption></figure>"


def _count(components: int | None) -> str:
    return "-" if components is None else str(components)


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
