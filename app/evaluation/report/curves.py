"""Figures over the judged pictures, as a drawing that a page can hold."""

from collections.abc import Mapping, Sequence
from html import escape
from math import ceil, floor, log10

WIDTH, HEIGHT = 560, 190
_LEFT, _RIGHT, _TOP, _BOTTOM = 54, 12, 26, 28
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#444444")
"""Okabe and Ito: told apart by everybody."""
TICKS = 4
"""About so many numbers at the side."""


def color_of(index: int) -> str:
    """Of the avatar in this place."""
    return COLORS[index % len(COLORS)]


def curve_svg(
    title: str,
    series: Mapping[str, Sequence[float | None]],
    labels: Sequence[str],
    digits: int,
    colors: Sequence[str] = COLORS,
    dots: bool = True,
) -> str:
    """An SVG of one metric: a line for each name, a dot for each picture with its label and value under the pointer.

    Pictures that were not measured are left out of their line. Empty text where nothing was. Without ``dots`` there are
    lines alone, which hundreds of pictures need. ``colors`` of the lines come in turn.
    """
    known = [value for values in series.values() for value in values if value is not None]
    if not known:
        return ""
    low, high = min(known), max(known)
    room = (high - low) * 0.08 or abs(high) * 0.05 or 1.0
    low, high = low - room, high + room
    count = max(len(labels), 2)

    def across(index: int) -> float:
        return _LEFT + (WIDTH - _LEFT - _RIGHT) * index / (count - 1)

    def down(value: float) -> float:
        return _TOP + (HEIGHT - _TOP - _BOTTOM) * (high - value) / (high - low)

    parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(title)} over the pictures">']
    parts.append(f'<text x="{_LEFT}" y="16" class="name">{escape(title)}</text>')
    for value in _round_numbers(low, high):
        y = down(value)
        parts.append(f'<line x1="{_LEFT}" x2="{WIDTH - _RIGHT}" y1="{y:.1f}" y2="{y:.1f}" class="grid"/>')
        parts.append(f'<text x="{_LEFT - 6}" y="{y + 4:.1f}" class="tick">{value:.{digits}f}</text>')
    for index, name in enumerate(series):
        points = [(i, v) for i, v in enumerate(series[name]) if v is not None]
        path = " ".join(f"{across(i):.1f},{down(v):.1f}" for i, v in points)
        color = colors[index % len(colors)]
        parts.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="1.5" opacity=".75"/>')
        for i, v in points if dots else ():
            told = f"{escape(name)}, {escape(labels[i])}: {v:.{digits}f}"
            where = f'cx="{across(i):.1f}" cy="{down(v):.1f}"'
            parts.append(f'<circle {where} r="3" fill="{color}"><title>{told}</title></circle>')
    for index, anchor in ((0, "start"), (len(labels) - 1, "end"))[: len(labels)]:
        where = f'x="{across(index):.1f}" y="{HEIGHT - 9}" text-anchor="{anchor}"'
        parts.append(f'<text {where} class="label">{escape(labels[index])}</text>')
    return "".join([*parts, "</svg>"])


def _round_numbers(low: float, high: float) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten between the two, about TICKS of them."""
    wanted = (high - low) / TICKS
    power = 10 ** floor(log10(wanted))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= wanted)
    return [number * step for number in range(ceil(low / step), floor(high / step) + 1)]
