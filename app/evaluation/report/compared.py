"""Taken, drawn, and where they differ: the comparisons of Figures 5, 6, 8 and 10 of the paper, and film strips."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from ....models.metrics.tables import DIGITS
from .pictures import Gallery


def compared(gallery: Gallery, pictures: Sequence[Mapping[str, Any]], names: Sequence[str]) -> str:
    """HTML of the worst, the median and the best picture: as it was taken, and for each row drawn and error.

    Args:
        gallery: packed pictures.
        pictures: timestep, camera and values of each, as report.json holds them.
        names: rows of the gallery; the first decided which pictures it holds.
    """
    parts = ["<p class='small'>Drawn, and below the difference: black is none,"]
    parts.append(" <span class='heat'></span> white is 0.1 of full scale or more. Worst, median and best by PSNR of")
    parts.append(f" {escape(names[0])}. What is drawn is synthetic.</p>")
    for word, place in gallery.choice.compared.items():
        picture = pictures[place]
        parts.append(f"<h4>{word}: moment {picture['timestep']}, camera {picture['camera']}</h4><div class='compared'>")
        parts.append(_figure({"taken": gallery.drawn["", place]}, "taken"))
        for name in names:
            quality = picture["values"][name]["PSNR"]
            images = {"drawn": gallery.drawn[name, place], "difference": gallery.errors[name, place]}
            parts.append(_figure(images, f"{name}, {quality:.{DIGITS['PSNR']}f} dB"))
        parts.append("</div>")
    return "".join(parts)


def film_strip(gallery: Gallery) -> str:
    """HTML of pictures spread over all, a row for each avatar below what was taken."""
    rows = "".join(
        f"<tr><th>{escape(who) or 'taken'}</th><td><img alt='{escape(who) or 'taken'}' src='{url}'></td></tr>"
        for who, url in gallery.strips.items()
    )
    return f"<h3>Film strip</h3><table class='strip'>{rows}</table>"


def _figure(images: Mapping[str, str], caption: str) -> str:
    shown = "".join(f"<img alt='{what}' src='{url}'>" for what, url in images.items())
    return f"<figure>{shown}<figcaption>{escape(caption)}</figcaption></figure>"
