"""One report of ``gemheads evaluate`` as Markdown: Tables 1 to 4 of the paper, and how steady avatars are."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

Report = Mapping[str, Any]
DIGITS = {"PSNR": 2, "SSIM": 4, "LPIPS": 4, "L1": 4, "FLIP": 4}
NUMBERS = {"val": "Table 1", "test": "Table 2"}
ENOUGH = 12
"""Pictures; means of fewer are called a first look."""
EMBEDDING = {"cosine": 4, "l1": 4, "frechet": 3}
WORDS = {"cosine": "cosine ↑", "l1": "L1 ↓", "frechet": "Fréchet distance ↓", "fps": "frames/s ↑"}


class UnknownReport(ValueError):
    """A report that another version wrote."""


def section(report: Report) -> str:
    """Everything that one report holds.

    Raises UnknownReport where it lacks what this version of the program writes.
    """
    try:
        return "\n\n".join(_parts(report)) + "\n"
    except (KeyError, TypeError) as error:
        raise UnknownReport(f"lacks {error}; make it again with this version of gemheads evaluate") from error


def _parts(report: Report) -> Iterator[str]:
    names = ", ".join(_plain(column["name"]) for column in report["avatars"])
    capture = report["capture"]
    yield f"## {names}" + ("" if capture is None else f" on {_plain(capture['name'])}")
    yield f"    {report['command']}"
    yield _made(report)
    yield _avatars(report["avatars"])
    for split, found in report["tables"].items():
        yield _pictures(NUMBERS[split], found)
    if "sizes" in report:
        yield _sizes(report["sizes"])
    if "crossing" in report:
        yield from _crossing(report["crossing"])


def _made(report: Report) -> str:
    machine, versions, capture = report["machine"], report["versions"], report["capture"]
    told = [f"{report['made']}; {machine['processor']}, {machine['cores']} cores"]
    if capture is not None:
        told.append(f"pictures of {_plain(capture['subject'])}, {capture['size']}")
    told.append(", ".join(f"{name} {version}" for name, version in versions.items()))
    return "; ".join(told) + "." + "".join(f" {_plain(note)}" for note in report["notes"])


def _avatars(columns: Sequence[Mapping[str, Any]]) -> str:
    rows = [
        [
            _plain(told["name"]),
            told["kind"],
            f"{told['splats']:,}",
            "" if told["components"] is None else str(told["components"]),
            f"{told['megabytes']:.2f}",
            _plain(told["driven_by"]),
            _plain(told["source"]),
        ]
        for told in columns
    ]
    return table(["", "kind", "splats", "components", "file, MB", "driven by", "made of"], rows)


def _pictures(number: str, found: Mapping[str, Any]) -> str:
    """Tables 1 and 2: a row for each metric."""
    published = found["published"]
    rows = [
        [
            metric,
            *(_number(means[metric], digits) for means in found["means"].values()),
            *(_cited(values.get(metric), digits) for values in published.values()),
        ]
        for metric, digits in DIGITS.items()
    ]
    heads = ["", *map(_plain, found["means"]), *(f"*paper: {name}*" for name in published)]
    about = f"**{number}, {found['title'].lower()}**: {found['about'].split('(')[0].strip()},"
    count = len(found["pictures"])
    told = f"{count} pictures" + (", too few for more than a first look" if count < ENOUGH else "")
    return f"{about} {told}. *Paper: {found['published_of']}.*\n\n{table(heads, rows)}"


def _sizes(found: Mapping[str, Any]) -> str:
    """Table 4: a row for each avatar and count, then the paper's."""
    rows = []
    for told in found["rows"]:
        cited = [
            row
            for row in found["published"]
            if row["maps"] == told["maps"] and row["components"] == told["components"] and row["method"] == told["kind"]
        ]
        rows.append(
            [
                _plain(told["avatar"]),
                f"{told['maps']}",
                "" if told["components"] is None else f"{told['components']}",
                *(_number(told["means"].get(metric), DIGITS[metric]) for metric in ("PSNR", "SSIM", "LPIPS")),
                *(_number(told["megabytes"].get(form), 2) for form in ("int8", "fp16", "fp32")),
                f"{told['frame_ms']:.1f}",
                f"{told['fps']:.1f}",
                *(_cited(cited[0][key], digits) if cited else "" for key, digits in PUBLISHED.items()),
            ]
        )
    heads = ["", "maps", "components", "PSNR", "SSIM", "LPIPS", "MB int8", "MB fp16", "MB fp32", "ms a frame"]
    heads += ["frames/s", "*paper: PSNR*", "*paper: MB*", "*paper: frames/s*"]
    speed = f"compose, sort and draw at {found['size']} by {found['engine']} ({_plain(found['renderer'])}), in turns"
    about = (
        f"**Table 4, components and map size**: fitted with so many components on {len(found['pictures'])} pictures of"
        f" {found['about'].split('(')[0].strip()}; MB of the file without a regressor, of a run the weights; {speed},"
        f" medians of {found['rounds']}. *Paper: {found['published_of']}.*"
    )
    notes = "".join(f" {_plain(note)}" for note in found["notes"])
    return f"{about}{notes}\n\n{table(heads, rows)}"


PUBLISHED = {"psnr": 2, "megabytes": 0, "fps": 1}


def _crossing(found: Mapping[str, Any]) -> Iterator[str]:
    """Table 3, the channels, and robustness."""
    who = [_plain(f"{row['avatar']}, {row['driving']}") for row in found["rows"]]
    people = ", ".join(_plain(driver["name"]) for driver in found["drivers"])
    rows = []
    for key, word in WORDS.items():
        ours = [row["fps"] if key == "fps" else (row["embedding"] or {}).get(key) for row in found["rows"]]
        digits = EMBEDDING.get(key, 0)
        cited = [_cited(values.get(key), digits) for values in found["published"].values()]
        rows.append([word, *(_number(value, digits) for value in ours), *cited])
    heads = ["", *who, *(f"*paper: {name}*" for name in found["published"])]
    taken = f"one frame in {found['every']} of at most their first {found['seconds']:g} s"
    notes = "".join(f" {_plain(note)}" for note in found["notes"])
    yield (
        f"**Table 3, driven by people never seen**: {people}; {taken}."
        " The embedding is the face tracker's own; frames/s of express, compose and draw at"
        f" {found['size']}x{found['size']}. *Paper: {found['published_by']}.*{notes}\n\n{table(heads, rows)}"
    )
    rows = [
        [channel["name"], f"{channel['goal']:g}"] + [_number(of["median"][channel["name"]], 3) for of in found["rows"]]
        for channel in found["channels"]
        if not channel["second_opinion"]
    ]
    about = "correlation over time of avatar and driver, median over the drivers who move the channel."
    yield f"**The closed loop**: {about}\n\n{table(['', 'goal', *who], rows)}"
    yield _robustness(found, who)


def _robustness(found: Mapping[str, Any], who: Sequence[str]) -> str:
    steady = [row["robustness"] for row in found["rows"]]
    leak = found["pose_leak"]
    leaks = [
        "; ".join(f"{_pair(of['yaw_ratio'])} ({_plain(head)})" for head, of in told["pose_leak"].items())
        for told in steady
    ]
    rows = [
        ["RMS of expression", "", *(_pair(told["expression"]) for told in steady)],
        ["jitter on a still face", "", *(_pair(told["jitter"]["raw"], 3) for told in steady)],
        ["the same, smoothed", "", *(_pair(told["jitter"]["smoothed"], 3) for told in steady)],
        [f"pose leak at {leak['yaw_deg']:g} degrees of yaw, of expression", f"{leak['goal']:g}", *leaks],
        ["other neutrals, of expression", "", *(_pair(told["neutrals"]["mean_ratio"]) for told in steady)],
    ]
    about = "coefficients in sigma / millimetres that splats are moved; who turned the head stands in brackets."
    return f"**Robustness**: {about}\n\n{table(['', 'goal at most', *who], rows)}"


def _pair(found: Mapping[str, float | None], digits: int = 2) -> str:
    return f"{_number(found['sigma'], digits)} / {_number(found['mm'], digits)}"


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Markdown."""
    lines = ["| " + " | ".join(cells) + " |" for cells in ([*heads], ["---"] * len(heads), *rows)]
    return "\n".join(lines)


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def _cited(value: float | None, digits: int) -> str:
    return "" if value is None else f"*{value:.{digits}f}*"


def _plain(text: str) -> str:
    """Names of strangers' files are no Markdown."""
    return "".join(f"\\{letter}" if letter in "|*_`<>[]\\" else letter for letter in " ".join(str(text).split()))
