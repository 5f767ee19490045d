"""What ``gemheads info`` says about an avatar's file: who it is, whose it is, what is in it, and how it may be seen."""

from pathlib import Path

from ..models.gem import CHANNELS, MODALITIES, Gem
from ..models.gemfile import GemFormatError, GemInfo, load_gem, read_info
from .credentials.origin import NO_CONSENT, plain
from .errors import InputError

ORIGIN = ("author", "licence", "consent", "source")
"""What every avatar should say about itself, in the order it is shown."""
UNKNOWN = "not stated"
MISSING = {"consent": NO_CONSENT}
"""What a missing text means, where it means something."""


def describe(path: Path) -> str:
    """The text of ``gemheads info FILE``. The whole file is read, so that a damaged one is not called sound.

    Raises InputError, with the reason, for anything that is no sound avatar.
    """
    try:
        return "\n".join(f"{label:12} {text}" for label, text in lines(read_info(path), load_gem(path), path))
    except GemFormatError as error:
        raise InputError(str(error)) from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path and its permissions") from error


def lines(info: GemInfo, gem: Gem, path: Path) -> list[tuple[str, str]]:
    """(label, text) of each line, licence and consent always among them."""
    card, layout, view = info.card, info.layout, info.card.viewing
    others = sorted(set(card.about) - set(ORIGIN))
    return [
        ("Name", plain(card.name)),
        *((key.capitalize(), plain(card.about.get(key, "").strip() or MISSING.get(key, UNKNOWN))) for key in ORIGIN),
        *((plain(key), plain(card.about[key])) for key in others),
        ("File", f"{path}, {info.bytes / 1e6:.2f} MB, basis as {card.basis}"),
        ("Splats", f"{layout.splats}, UV map of {card.uv_size} x {card.uv_size} texels"),
        *((name.capitalize(), _basis(info, name)) for name in MODALITIES),
        ("In memory", f"{sum(basis.nbytes for basis in gem.bases.values()) / 1e6:.0f} MB"),
        ("Driven by", _drivers(gem)),
        ("Seen from", f"up to {view.yaw_limit_deg:g} degrees aside, {view.pitch_limit_deg:g} up and down"),
        ("Head", f"{100 * view.head_height:.0f} cm from chin to crown"),
        ("SHA-256", f"{card.payload_sha256} (of all numbers; it fits)"),
    ]


def _basis(info: GemInfo, modality: str) -> str:
    count, kept, splats = info.layout.components[modality], info.layout.kept[modality], info.layout.splats
    if not count:
        return "does not move"
    return f"{count} components, {kept} splats move ({kept / splats:.0%}), {CHANNELS[modality]} numbers each"


def _drivers(gem: Gem) -> str:
    ways = ["its regressor"] * (gem.regressor is not None) + ["52 ARKit weights"] * (gem.arkit_weights is not None)
    return " and ".join([*ways, f"{gem.coefficient_count} coefficients"])
