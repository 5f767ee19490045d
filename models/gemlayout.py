"""Which tensors an avatar's file holds, of which type and shape; every bound is checked before memory is taken."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arkit import NAMES
from .gem import CHANNELS, CLAMP_SIGMAS, MAX_COMPONENTS, MAX_SPLATS, MODALITIES
from .gemcard import BASIS_TYPES, Card
from .gemheader import DTYPES, GemFormatError, Header

MAX_EXPANDED_BYTES = 2 * 2**30
"""Means and components as float32 in memory: 1 M splats with 45 components, 240k with 200."""
MAX_REGRESSOR_BYTES = 32 * 2**20
"""A larger one is refused unread: three networks of three layers of 256 need 1.1 MB."""
MAX_VALUE = 1e4
"""No mean, and no component at three sigma, is larger than this in metres, logarithms or logits."""
MAX_COEFFICIENT = 1e6
"""No coefficient at rest, and none that an ARKit weight adds, is larger: sums of them stay numbers."""
BASIS_PARTS = ("mean", "components", "scale", "sigma", "kept")
"""The tensors of one modality, named MODALITY.PART."""
OPTIONAL = ("arkit_weights", "rest", "regressor")


@dataclass(frozen=True)
class Layout:
    """The sizes that all shapes follow from."""

    splats: int
    components: dict[str, int]
    """Modality -> K."""
    kept: dict[str, int]
    """Modality -> M, the splats that it moves."""


def check_layout(header: Header, card: Card) -> Layout:
    """The sizes of a file whose tensors are the right ones, typed and shaped rightly. Raises GemFormatError."""
    entries = header.entries
    required = {"colors", "neck_weights", "neck_pivot", "uv_index"}
    required |= {f"{modality}.{part}" for modality in MODALITIES for part in BASIS_PARTS}
    if missing := sorted(required - set(entries)):
        raise GemFormatError(f"it lacks the tensor {missing[0]!r}")
    if extra := sorted(set(entries) - required - set(OPTIONAL)):
        raise GemFormatError(f"it holds the tensor {extra[0][:40]!r}, which no avatar has")
    if ("regressor" in entries) != (card.regressor is not None):
        raise GemFormatError("its regressor and its description of it do not belong together")
    layout = Layout(
        splats=_length(header, "colors", 1, MAX_SPLATS),
        components={m: _length(header, f"{m}.sigma", 0, MAX_COMPONENTS) for m in MODALITIES},
        kept={m: _length(header, f"{m}.kept", 0, MAX_SPLATS) for m in MODALITIES},
    )
    wanted = _wanted(layout, card)
    for name, entry in entries.items():
        dtype, shape = wanted[name]
        if name == "regressor":
            if entry.dtype != dtype or len(entry.shape) != 1 or not 0 < entry.shape[0] <= MAX_REGRESSOR_BYTES:
                raise GemFormatError(
                    f"its regressor is {entry.dtype} {entry.shape}, not 1 to {MAX_REGRESSOR_BYTES} bytes"
                )
        elif entry.dtype != dtype or entry.shape != shape:
            raise GemFormatError(f"tensor {name!r} is {entry.dtype} {entry.shape} instead of {dtype} {shape}")
    expanded = sum(4 * layout.splats * CHANNELS[m] * (layout.components[m] + 1) for m in MODALITIES)
    if expanded > MAX_EXPANDED_BYTES:
        raise GemFormatError(
            f"it would take {expanded / 2**30:.1f} GiB of memory, the limit is 2", "use a smaller avatar"
        )
    return layout


def check_values(name: str, values: NDArray[Any], splats: int) -> None:
    """Raises GemFormatError where a tensor holds what it never may: NaN, sigma <= 0, an index of no splat."""
    if values.dtype.kind == "f" and not np.isfinite(values).all():
        raise GemFormatError(f"tensor {name!r} has values that are not finite")
    part = name.rpartition(".")[2]
    if part in ("sigma", "scale") and not (values > 0).all():
        raise GemFormatError(f"tensor {name!r} has values that are not above 0")
    if part in ("colors", "neck_weights") and not ((values >= 0) & (values <= 1)).all():
        raise GemFormatError(f"tensor {name!r} has values outside 0 to 1")
    if part in ("mean", "neck_pivot") and np.abs(values).max(initial=0) > MAX_VALUE:
        raise GemFormatError(f"tensor {name!r} has values beyond {MAX_VALUE:g}")
    if part in ("rest", "arkit_weights") and np.abs(values).max(initial=0) > MAX_COEFFICIENT:
        raise GemFormatError(f"tensor {name!r} has values beyond {MAX_COEFFICIENT:,.0f}")
    if part == "kept" and len(values) and (values[-1] >= splats or (values[1:] <= values[:-1]).any()):
        raise GemFormatError(f"tensor {name!r} does not rise through the numbers of its {splats} splats")


def check_motion(modality: str, values: NDArray[Any], scale: NDArray[np.float32], sigma: NDArray[np.float32]) -> None:
    """Raises GemFormatError where a component carries a splat beyond all bounds within three sigma."""
    flat = values.reshape(len(values), values.shape[1] * values.shape[2])
    largest = np.maximum(flat.max(1, initial=0).astype(np.float64), -flat.min(1, initial=0).astype(np.float64))
    if (CLAMP_SIGMAS * largest * scale * sigma > MAX_VALUE).any():
        raise GemFormatError(f"the {modality} basis moves splats by more than {MAX_VALUE:g}")


def _length(header: Header, name: str, low: int, high: int) -> int:
    shape = header.entries[name].shape
    if not shape or not low <= shape[0] <= high:
        raise GemFormatError(f"tensor {name!r} has the shape {shape}, its length must be {low} to {high}")
    return shape[0]


def _wanted(layout: Layout, card: Card) -> dict[str, tuple[np.dtype[Any], tuple[int, ...]]]:
    count, total = layout.splats, sum(layout.components.values())
    shapes: dict[str, tuple[str, tuple[int, ...]]] = {
        "colors": ("F16", (count, 3)),
        "neck_weights": ("F16", (count,)),
        "neck_pivot": ("F32", (3,)),
        "uv_index": ("U16", (count, 2)),
        "arkit_weights": ("F32", (len(NAMES), total)),
        "rest": ("F32", (total,)),
        "regressor": ("U8", ()),
    }
    for m in MODALITIES:
        k, kept = layout.components[m], layout.kept[m]
        shapes[f"{m}.mean"] = ("F32", (count, CHANNELS[m]))
        shapes[f"{m}.components"] = (BASIS_TYPES[card.basis], (k, kept, CHANNELS[m]))
        shapes[f"{m}.scale"] = shapes[f"{m}.sigma"] = ("F32", (k,))
        shapes[f"{m}.kept"] = ("U32", (kept,))
    return {name: (DTYPES[dtype], shape) for name, (dtype, shape) in shapes.items()}
