"""Neutrals that were taken, one for each camera, kept in the user's data folder: features only, never a picture."""

import hashlib
import re
from dataclasses import dataclass
from datetime import date
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import save

from ...models.brevity import brief
from ...models.driver.features import DIMENSION, FEATURE_VERSION
from ...models.driver.networks import SHA256
from ...models.driver.neutral import NeutralChoice
from ...models.wholefile import write_whole
from ..errors import InputError, OutputError
from ..files.tensorfile import Tensors, read_tensor_file
from ..library import user_folder
from .restface import Resting

FORMAT = "gemheads-neutral 1"
NETWORKS = hashlib.sha256("".join(SHA256[name] for name in sorted(SHA256)).encode()).hexdigest()[:16]
"""Stands for the face networks that this version ships."""
LARGEST = 1 << 20
"""Bytes; a profile has about 10 kB."""


@dataclass(frozen=True)
class Profile:
    """A neutral of an earlier day."""

    choice: NeutralChoice | None
    """None when the features of that day meant something else."""
    noise: NDArray[np.float32]
    """[D] the personal noise floor; empty without a choice."""
    warning: str
    """One plain sentence with the cure; empty when all is well."""


def profile_path(camera: str, folder: Path | None = None) -> Path:
    """The file of a camera's neutral; ``folder`` is the user's data folder unless given."""
    readable = re.sub(r"[^a-z0-9]+", "-", camera.lower()).strip("-")[:40] or "camera"
    unique = hashlib.sha256(camera.encode()).hexdigest()[:8]
    return (folder or user_folder().parent / "neutrals") / f"{readable}-{unique}.safetensors"


def save_profile(camera: str, resting: Resting, today: date, folder: Path | None = None) -> Path:
    """Keep a neutral for this camera, in place of the one before. Raises OutputError."""
    path = profile_path(camera, folder)
    about = {
        "format": FORMAT,
        "camera": camera,
        "taken": today.isoformat(),
        "feature_version": str(FEATURE_VERSION),
        "networks": NETWORKS,
        "residual": f"{resting.residual:.4f}",
    }
    tensors = {
        "features": resting.choice.features.astype(np.float32),
        "rotation": resting.choice.rotation.astype(np.float64),
        "noise": resting.noise.astype(np.float32),
    }
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, [save(tensors, about)])
    except OSError as error:
        raise OutputError(
            f"{path}: your neutral cannot be kept ({error.strerror}); it counts until you quit. Free some space"
        ) from error
    return path


def kept_cameras(folder: Path | None = None) -> list[str]:
    """The cameras with a neutral that can be read, by name."""
    names = []
    for path in sorted((folder or user_folder().parent / "neutrals").glob("*.safetensors")):
        try:
            metadata, _ = read_tensor_file(path, LARGEST)
            names.append(metadata.get("camera", ""))
        except (OSError, ValueError):
            continue  # told in full when it is asked for
    return sorted(name for name in names if name)


def load_profile(camera: str, folder: Path | None = None) -> Profile | None:
    """The neutral kept for this camera; None without one. Raises InputError for a file that is no such thing."""
    path = profile_path(camera, folder)
    if not path.exists():
        return None
    try:
        about, tensors = read_tensor_file(path, LARGEST)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: no readable neutral ({brief(error)}); delete the file and press N") from error
    if about.get("format") != FORMAT:
        raise InputError(f"{path}: not a neutral of this program; delete the file and press N")
    taken = brief(about.get("taken", "an unknown day"))
    if about.get("feature_version") != str(FEATURE_VERSION):
        return Profile(
            None, np.empty(0, np.float32), f"Your neutral of {taken} is from another version: press N to take it again."
        )
    return _checked(path, tensors, taken, about.get("networks") == NETWORKS)


def _checked(path: Path, tensors: Tensors, taken: str, same_networks: bool) -> Profile:
    wanted = {"features": ((DIMENSION,), "float32"), "rotation": ((3,), "float64"), "noise": ((DIMENSION,), "float32")}
    for name, (shape, dtype) in wanted.items():
        tensor = tensors.get(name)
        if tensor is None or tensor.shape != shape or tensor.dtype != dtype or not np.isfinite(tensor).all():
            raise InputError(f"{path}: the {name} are broken; delete the file and press N")
    choice = NeutralChoice(
        0, 0.0, tensors["features"].astype(np.float32), tensors["rotation"].astype(np.float64), f"taken on {taken}", ()
    )
    changed = f"The face networks changed since your neutral of {taken}: press N to take it again."
    return Profile(choice, tensors["noise"].astype(np.float32), "" if same_networks else changed)
