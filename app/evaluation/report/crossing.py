"""The page's section on people never seen: Table 3, robustness, and driver above avatar."""

from collections.abc import Mapping, Sequence
from html import escape
from statistics import median
from typing import Any

from ....models.crossing.compare import Worst
from .crossingpictures import CrossingPictures, Scene
from .curves import COLORS, curve_svg
from .pieces import row, table

Figures = Mapping[str, Any]
DRIVER_COLOR = COLORS[-1]
"""Of the driver's curves; avatars have the others."""


def crossing_section(figures: Figures, pictures: CrossingPictures) -> str:
    """HTML of ``figures``, which report.json holds as "crossing", and the pictures."""
    parts = ["<h2>Driving people never seen</h2>", _lead(figures)]
    parts += [f"<p class='note'>{escape(note)}</p>" for note in figures["notes"]]
    parts += [_correlations(figures), _embeddings(figures), _robustness(figures), _neutrals(figures)]
    for driver in figures["drivers"]:
        parts.append(_scene(driver, figures["rows"], pictures.scenes[driver["name"]]))
    for told in figures["rows"]:
        parts.append(_every_channel(told, figures))
    return "".join(parts)


def _lead(figures: Figures) -> str:
    count = len(figures["drivers"])
    text = (
        f"{count} {'person drives' if count == 1 else 'people drive'} the avatars: each {_nth(figures['every'])}frame"
        f" of at most the first {figures['seconds']:g} s, without smoothing. The face tracker then reads the avatar's"
        f" own pictures ({figures['size']}x{figures['size']}), and both are compared, each relative to its own neutral."
        " The baseline has learned nothing: the tracker's scores as ARKit weights. The tracker that judges is the one"
        " that drives, so look at the strips, too. What is drawn is synthetic."
    )
    return f"<p>{escape(text)}</p>"


def _correlations(figures: Figures) -> str:
    """Medians over the drivers, by channel."""
    channels = [channel for channel in figures["channels"] if not channel["second_opinion"]]
    rows = [row(["<em>goal</em>", *(f"<em>{channel['goal']:g}</em>" for channel in channels)])]
    for told in figures["rows"]:
        cells = [_who(told)]
        for channel in channels:
            value, met = told["median"][channel["name"]], told["met"][channel["name"]]
            cells.append(_marked(_number(value, 3), met))
        rows.append(row(cells))
    heads = ["", *(channel["name"] for channel in channels)]
    text = "Correlation over time of avatar and driver, median over the drivers who move the channel at all."
    legend = "<span class='met'>reached</span>, <span class='missed'>missed</span>."
    told = f"<p class='small'>{text} {legend}</p><div class='tight'>{table(heads, rows)}</div>"
    return f"<h3>Does it do what the driver does?</h3>{told}"


def _embeddings(figures: Figures) -> str:
    """Table 3 of the paper."""
    rows = []
    for told in figures["rows"]:
        found = told["embedding"] or {}
        cells = [_number(found.get(name), digits) for name, digits in _EMBEDDING.items()]
        rows.append(row([_who(told), *cells, _number(told["fps"], 0), _number(told["fps_with_tracking"], 0)]))
    for name, values in figures["published"].items():
        cells = [
            f"{values['cosine']:.4f}",
            "",
            f"{values['l1']:.4f}",
            f"{values['frechet']:.4f}",
            f"{values['fps']:.0f}",
        ]
        rows.append(row([f"<em>paper: {escape(name)} *</em>", *(f"<em>{cell}</em>" for cell in cells), ""]))
    heads = ["", "cosine ↑", "by chance", "L1 ↓", "Fréchet ↓", "fps", "fps with tracking"]
    text = (
        "All drivers together. The embedding is the face tracker's own [512], driver and avatar each relative to their"
        " neutral; it is not the paper's network, so only rows of one kind can be compared. By chance: the cosine when"
        " frames are paired at random. A driver's own neutral frame has none and is left out. fps:"
        " one step of express, compose and draw by the software engine, median; the rows of one avatar were measured by"
        " turns."
    )
    note = f"<p class='small'>* {escape(figures['published_by'])}.</p>"
    return f"<h3>Expression embedding and speed</h3><p class='small'>{escape(text)}</p>{table(heads, rows)}{note}"


_EMBEDDING = {"cosine": 4, "chance": 4, "l1": 4, "frechet": 3}


def _robustness(figures: Figures) -> str:
    rows = []
    for told in figures["rows"]:
        found = told["robustness"]
        leaks = [
            f"{_marked(_number(leak['yaw_ratio']['sigma'], 2), leak['met'])} / {_number(leak['yaw_ratio']['mm'], 2)}"
            f" &ensp;{escape(head)}"
            for head, leak in found["pose_leak"].items()
        ]
        cells = [
            _pair(found["expression"], 2, 2),
            _pair(found["jitter"]["raw"], 3, 3),
            _pair(found["jitter"]["smoothed"], 3, 3),
            "<br>".join(leaks) or "not seen",
            _pair(found["neutrals"]["mean_ratio"], 2, 2),
        ]
        rows.append(row([_who(told), *cells]))
    leak = figures["pose_leak"]
    heads = ["", "expression", "jitter", "smoothed", f"pose leak, goal {leak['goal']:g}", "other neutrals"]
    text = (
        "RMS of coefficients in sigma / millimetres that splats are moved. Expression: over all clips, away from what"
        " the neutral gives. Jitter: the driver stands still at his neutral before a webcam's noise, without and with"
        f" the smoothing of the live window. Pose leak: an avatar that keeps its expression turns its head by"
        f" {leak['yaw_deg']:g} degrees to either side; as part of expression. Other neutrals: how far mean coefficients"
        " move between neutrals that might have been chosen as well; as part of expression."
    )
    return f"<h3>Is it steady?</h3><p class='small'>{escape(text)}</p><div class='steady'>{table(heads, rows)}</div>"


def _neutrals(figures: Figures) -> str:
    channels = [channel["name"] for channel in figures["channels"] if not channel["second_opinion"]]
    rows = []
    for told in figures["rows"]:
        spread = told["robustness"]["neutrals"]["correlation_spread"]
        rows.append(row([_who(told), *(_number(spread[name], 3) for name in channels)]))
    counts = sorted({driver["other_neutrals"] for driver in figures["drivers"]})
    many = f"{counts[0]}" if len(counts) == 1 else f"{counts[0]} to {counts[-1]}"
    text = f"Standard deviation of the correlations over the chosen neutral and {many} others, median over drivers."
    told = f"<p class='small'>{text}</p><div class='tight'>{table(['', *channels], rows)}</div>"
    return f"<details><summary>Under other neutrals</summary>{told}</details>"


def _scene(driver: Figures, rows: Sequence[Figures], scene: Scene) -> str:
    """One driver: film strips, worst frames, curves."""
    name = driver["name"]
    lost = f", {driver['without_face']} without a face" if driver["without_face"] else ""
    told = f"{driver['frames']} frames in {driver['seconds']:.1f} s{lost}. Neutral: {driver['neutral']}."
    strips = "".join(
        f"<tr><th>{escape(who)}</th><td><img alt='{escape(who)}' src='{url}'></td></tr>"
        for who, url in scene.strips.items()
    )
    parts = [f"<h3>{escape(name)}</h3><p class='small'>{escape(told)}</p><table class='strip scene'>{strips}</table>"]
    parts.append("<h4>Where they agree least</h4>")
    for who, frames in scene.worst.items():
        unseen = sum(r["drivers"][name]["unseen"] for r in rows if f"{r['avatar']}, {r['driving']}" == who)
        lost = f"; no face seen on it in {unseen} frames" if unseen else ""
        shown = "".join(_worst(worst, url) for worst, url in frames) or "<p>nothing moves</p>"
        parts.append(f"<p class='small'>{escape(who)}{lost}</p><div class='worst'>{shown}</div>")
    colors = [DRIVER_COLOR, *COLORS]
    key = "".join(
        f"<td><i style='background:{color}'></i>{escape(who)}</td>"
        for who, color in zip(next(iter(scene.curves.values())), colors, strict=False)
    )
    drawn = "".join(
        curve_svg(channel, series, scene.labels, 2, colors=colors, dots=False)
        for channel, series in scene.curves.items()
    )
    parts.append(f"<h4>Over time</h4><table class='key'><tr>{key}</tr></table><div class='curves'>{drawn}</div>")
    return "".join(parts)


def _worst(worst: Worst, url: str) -> str:
    what = f"{worst.seconds:.1f} s"
    if worst.channel is None:
        text = f"{what}: no face is seen on the avatar"
    else:
        text = f"{what}, {worst.channel}: driver {worst.driver:+.1f}, avatar {worst.avatar:+.1f} sd"
    return f"<figure><img alt='driver above avatar' src='{url}'><figcaption>{escape(text)}</figcaption></figure>"


def _every_channel(told: Figures, figures: Figures) -> str:
    """Correlations of one row by channel and driver, with amplitude and unrest."""
    drivers = [driver["name"] for driver in figures["drivers"]]
    rows = []
    for channel in figures["channels"]:
        name = channel["name"]
        cells = [f"<em>{escape(name)}</em>" if channel["second_opinion"] else escape(name)]
        moved = [told["drivers"][driver] for driver in drivers]
        cells += [_followed(of, channel) for of in moved]
        moved = [of for of in moved if of["correlation"][name] is not None]
        for kind in ("amplitude", "unrest"):
            known = [of[kind][name] for of in moved if of[kind][name] is not None]
            cells.append(_number(median(known) if known else None, 2))
        rows.append(row(cells))
    for kind, title in (("off_mm", "lips off, mm"), ("shut", "lips shut")):
        found = [told["drivers"][driver]["lips"][kind] for driver in drivers]
        rows.append(row([f"<em>{title}</em>", *(_number(value, 2) for value in found), "", ""]))
    heads = ["correlation", *drivers, "amplitude", "unrest"]
    text = (
        "Correlation over time; in grey, where the driver stands still, how far the avatar moves (from 1 on it is"
        " movement). Amplitude and unrest: avatar over driver, median. Grey rows: landmark distances, which do not go"
        " through the scores; then how far lips are from standing apart as the driver's do (RMS), and the share of"
        f" frames with the driver's lips parted by {figures['lips']['parted_mm']:g} mm or more in which the avatar's"
        f" are shut (below {figures['lips']['shut_mm']:g} mm)."
    )
    name = escape(f"{told['avatar']}, {told['driving']}")
    return f"<details><summary>Every channel: {name}</summary><p class='small'>{text}</p>{table(heads, rows)}</details>"


def _pair(found: Figures, digits: int, of_mm: int) -> str:
    return f"{_number(found['sigma'], digits)} / {_number(found['mm'], of_mm)}"


def _followed(of: Figures, channel: Figures) -> str:
    name = channel["name"]
    value = of["correlation"][name]
    return _number(value, 2) if value is not None else f"<em>{of['avatar_std'][name] / channel['floor']:.1f}</em>"


def _who(told: Figures) -> str:
    return escape(f"{told['avatar']}, {told['driving']}")


def _marked(text: str, met: bool | None) -> str:
    return text if met is None else f"<span class='{'met' if met else 'missed'}'>{text}</span>"


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _nth(number: int) -> str:
    """The word before "frame"."""
    return "" if number == 1 else {2: "second ", 3: "third "}.get(number, f"{number}th ")
