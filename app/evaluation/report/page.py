"""report.html: one file with tables, curves and pictures, that asks nothing of any network and runs nothing."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from ....models.metrics.tables import DIGITS, LARGER_IS_BETTER
from .compared import compared, film_strip
from .crossing import crossing_section
from .crossingpictures import CrossingPictures
from .curves import color_of, curve_svg
from .pictures import Gallery
from .pieces import row as _row
from .pieces import table as _table
from .sizessection import sizes_section
from .style import STYLE

POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"


def page(
    report: Mapping[str, Any],
    galleries: Mapping[str, Gallery],
    sized: Gallery | None = None,
    driven: CrossingPictures | None = None,
) -> str:
    """The whole file.

    Args:
        report: what report.json holds.
        galleries: split -> its pictures.
        sized: pictures of GEMs with fewer components, where these were judged.
        driven: pictures of drivers and avatars, where drivers were given.
    """
    capture = report["capture"]
    names = ", ".join(column["name"] for column in report["avatars"])
    title = f"{names} driven by people never seen" if capture is None else f"{names} on {capture['name']}"
    body = [f"<h1>{escape(title)}</h1>", _lead(report)]
    body.append("".join(f"<p class='note'>{escape(note)}</p>" for note in report["notes"]))
    body.append(_avatars(report["avatars"], report["tables"]))
    for split, table in report["tables"].items():
        body.append(_split(table, galleries[split]))
    if sized is not None:
        body.append(sizes_section(report["sizes"], sized, [column["name"] for column in report["avatars"]]))
    if driven is not None:
        body.append(crossing_section(report["crossing"], driven))
    body.append(_made(report))
    head = f'<meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="{POLICY}">'
    return (
        f'<!doctype html><html lang="en"><head>{head}<meta name="viewport" content="width=device-width">'
        f"<title>{escape(title)}</title><style>{STYLE}</style></head><body>{''.join(body)}</body></html>\n"
    )


def _lead(report: Mapping[str, Any]) -> str:
    capture = report["capture"]
    if capture is None:
        return ""
    counts = {table["title"].lower(): len(table["pictures"]) for table in report["tables"].values()}
    counted = " and ".join(f"{count} picture{'s' * (count > 1)} of a {title}" for title, count in counts.items())
    text = (
        f"{capture['subject']}, {capture['size']}. Judged on {counted}, the same pictures for all, the capture's"
        " background included. GEMs are fitted to pictures of the same moment from other cameras than the"
        " judged one's; runs are driven by what the capture tracked at the judged moment. The paper's figures are of"
        " another data set."
    )
    return f"<p>{escape(text)}</p>"


def _avatars(avatars: Sequence[Mapping[str, Any]], tables: Mapping[str, Any]) -> str:
    rows = []
    for index, avatar in enumerate(avatars):
        times = [table["seconds_to_find"][avatar["name"]] for table in tables.values()]
        known = [time for time in times if time is not None]
        cells = [
            f"<i style='background:{color_of(index)}'></i>{escape(avatar['name'])}",
            avatar["kind"],
            f"{avatar['splats']:,}",
            "-" if avatar["components"] is None else str(avatar["components"]),
            f"{avatar['megabytes']:.2f}",
            escape(avatar["driven_by"]),
            f"{max(known):.2f}" if known else "-",
            "-" if avatar["steps"] is None else f"{avatar['steps']:,}",
            "-" if avatar["seconds"] is None else f"{avatar['seconds']:,.0f}",
            escape(avatar["source"]),
        ]
        rows.append(_row(cells))
    heads = ("", "kind", "splats", "components", "file, MB", "driven by", "s a fit", "steps", "s in all", "made of")
    return f"<h2>Avatars</h2><div class='avatars'>{_table(heads, rows)}</div>"


def _split(table: Mapping[str, Any], gallery: Gallery) -> str:
    names = list(table["means"])
    parts = [f"<h2>{escape(table['title'])}</h2><p>{escape(table['about'])}</p>", _means(table, names)]
    labels = [f"moment {p['timestep']}, camera {p['camera']}" for p in table["pictures"]]
    curves = [
        curve_svg(metric, {n: [p["values"][n][metric] for p in table["pictures"]] for n in names}, labels, digits)
        for metric, digits in DIGITS.items()
    ]
    parts.append(f"<h3>Over the pictures</h3><div class='curves'>{''.join(curves)}</div>")
    if len(table["cameras"]) > 1:
        parts.append(_cameras(table, names))
    parts.append(f"<h3>Where they differ</h3>{compared(gallery, table['pictures'], names)}{film_strip(gallery)}")
    parts.append(f"<details><summary>Every picture</summary>{_pictures(table, names)}</details>")
    return "".join(parts)


def _means(table: Mapping[str, Any], names: Sequence[str]) -> str:
    rows = []
    for metric in DIGITS:
        best = _best(metric, [table["means"][name][metric] for name in names])
        cells = [f"{metric} {'&uarr;' if metric in LARGER_IS_BETTER else '&darr;'}"]
        for name in names:
            text = _number(metric, table["means"][name][metric])
            cells.append(f"<b>{text}</b>" if text == best and len(names) > 1 else text)
        cells += [f"<em>{_number(metric, told.get(metric))}</em>" for told in table["published"].values()]
        rows.append(_row(cells))
    heads = ["", *names, *(f"paper: {name} *" for name in table["published"])]
    return f"{_table(heads, rows)}<p class='small'>* {escape(table['published_of'])}</p>"


def _cameras(table: Mapping[str, Any], names: Sequence[str]) -> str:
    heads = ["camera", *(f"{metric}, {name}" for metric in DIGITS for name in names)]
    rows = [
        _row([camera, *(_number(metric, of[name][metric]) for metric in DIGITS for name in names)])
        for camera, of in table["cameras"].items()
    ]
    return f"<h3>By camera</h3>{_table(heads, rows)}"


def _pictures(table: Mapping[str, Any], names: Sequence[str]) -> str:
    heads = ["picture", *(f"{metric}, {name}" for metric in DIGITS for name in names)]
    rows = [
        _row([escape(p["picture"]), *(_number(m, p["values"][name][m]) for m in DIGITS for name in names)])
        for p in table["pictures"]
    ]
    return _table(heads, rows)


def _made(report: Mapping[str, Any]) -> str:
    machine = ", ".join(f"{name} {value}" for name, value in report["machine"].items())
    versions = ", ".join(f"{name} {value}" for name, value in report["versions"].items())
    command = f"<p><code>{escape(report['command'])}</code></p>"
    return f"<footer>{command}<p>{escape(report['made'])}. {escape(machine)}. {escape(versions)}.</p></footer>"


def _number(metric: str, value: float | None) -> str:
    return "-" if value is None else f"{value:.{DIGITS[metric]}f}"


def _best(metric: str, values: Sequence[float | None]) -> str:
    known = [value for value in values if value is not None]
    if not known:
        return ""
    return _number(metric, max(known) if metric in LARGER_IS_BETTER else min(known))
