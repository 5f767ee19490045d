"""The one JSON text in an avatar's file: who it is, where it comes from, how it is looked at, and its seals."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from .gem import Viewing
from .gemheader import GemFormatError, read_json, whole

KEY = "gemheads"
"""The text's key in the safetensors metadata."""
VERSION = 1
UNITS = {"position": "m", "rotation": "wxyz", "scale": "ln m", "opacity": "logit", "color": "sRGB 0..1"}
"""What the numbers of each modality mean; a file that says otherwise is refused."""
BASIS_TYPES = {"int8": "I8", "fp16": "F16"}
"""How the components may be stored -> their safetensors type."""
MAX_UV_SIZE = 2**16
_FIELDS = {"version", "name", "about", "units", "viewing", "uv_size", "basis", "payload_sha256", "regressor"}
_UPDATE = "update gemheads"


@dataclass(frozen=True)
class Seal:
    """What a regressor was trained for: it is refused beside other bases."""

    sha256: str
    """Of the ONNX graph."""
    bases_sha256: str
    """Of the bases whose coefficients it gives."""


@dataclass(frozen=True)
class Card:
    """The JSON text, understood."""

    name: str
    about: Mapping[str, str]
    """author, licence, consent, source; any of them may be missing."""
    viewing: Viewing
    uv_size: int
    basis: str
    """A key of BASIS_TYPES."""
    payload_sha256: str
    """Of all tensors in the order of the file."""
    regressor: Seal | None


def card_text(card: Card) -> str:
    """The JSON text of a card."""
    view = card.viewing
    viewing = {
        "target": [float(x) for x in view.target],
        "head_height": float(view.head_height),
        "yaw_limit_deg": float(view.yaw_limit_deg),
        "pitch_limit_deg": float(view.pitch_limit_deg),
    }
    tree = {
        "version": VERSION,
        "name": card.name,
        "about": dict(card.about),
        "units": UNITS,
        "viewing": viewing,
        "uv_size": int(card.uv_size),
        "basis": card.basis,
        "payload_sha256": card.payload_sha256,
        "regressor": None if card.regressor is None else asdict(card.regressor),
    }
    return json.dumps(tree, sort_keys=True, separators=(",", ":"), allow_nan=False)


def read_card(metadata: Mapping[str, str]) -> Card:
    """The card among a file's metadata. Raises GemFormatError."""
    if KEY not in metadata:
        raise GemFormatError("this is a safetensors file, but no avatar", "give a .gem file")
    tree = read_json(metadata[KEY], "the avatar's description")
    version = tree.get("version")
    if version != VERSION or isinstance(version, bool):
        raise GemFormatError(f"its format has the version {str(version)[:20]}, this program reads {VERSION}", _UPDATE)
    if set(tree) != _FIELDS or set(metadata) != {KEY}:
        strange = sorted((set(tree) ^ _FIELDS) | (set(metadata) ^ {KEY}))
        raise GemFormatError(f"its description lacks, or should not have, {', '.join(map(repr, strange))[:200]}")
    if tree["units"] != UNITS:
        raise GemFormatError(f"its units are {str(tree['units'])[:120]}, not {UNITS}")
    if not isinstance(tree["name"], str) or not _is_text_table(tree["about"]):
        raise GemFormatError("its name or origin is not text")
    if not isinstance(tree["basis"], str) or tree["basis"] not in BASIS_TYPES:
        raise GemFormatError(f"its basis is stored as {str(tree['basis'])[:20]!r}, known are {list(BASIS_TYPES)}")
    if not whole(tree["uv_size"], 1, MAX_UV_SIZE):
        raise GemFormatError(f"its UV map cannot have {str(tree['uv_size'])[:20]} texels a side")
    return Card(
        name=tree["name"],
        about=tree["about"],
        viewing=_viewing(tree["viewing"]),
        uv_size=tree["uv_size"],
        basis=tree["basis"],
        payload_sha256=_sha256(tree["payload_sha256"]),
        regressor=_seal(tree["regressor"]),
    )


def _viewing(value: object) -> Viewing:
    fields = ("target", "head_height", "yaw_limit_deg", "pitch_limit_deg")
    table: dict[str, Any] = value if isinstance(value, dict) else {}
    target = table.get("target")
    if set(table) != set(fields) or not isinstance(target, list) or len(target) != 3:
        raise GemFormatError(f"its viewing must have {', '.join(fields)}")
    if not all(_number(x, -1e3, 1e3) for x in target) or not _number(table["head_height"], 1e-3, 1e3):
        raise GemFormatError("its viewing aims at no place within a kilometre")
    if not (_number(table["yaw_limit_deg"], 0, 180) and _number(table["pitch_limit_deg"], 0, 90)):
        raise GemFormatError("its camera limits are no angles: yaw 0 to 180, pitch 0 to 90 degrees")
    x, y, z = (float(v) for v in target)
    return Viewing((x, y, z), *(float(table[name]) for name in fields[1:]))


def _seal(value: object) -> Seal | None:
    if value is None:
        return None
    if not isinstance(value, dict) or set(value) != {"sha256", "bases_sha256"}:
        raise GemFormatError("its regressor has no seal")
    return Seal(_sha256(value["sha256"]), _sha256(value["bases_sha256"]))


def _sha256(value: object) -> str:
    if not isinstance(value, str) or len(value) != 64 or not set(value) <= set("0123456789abcdef"):
        raise GemFormatError("a checksum in it is no SHA-256")
    return value


def _number(value: object, low: float, high: float) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and low <= value <= high


def _is_text_table(value: object) -> bool:
    return isinstance(value, dict) and all(isinstance(text, str) for text in value.values())
