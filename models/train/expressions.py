"""Random faces to learn from: ARKit weights that cover single movements, speech-like mixtures and extremes."""

import numpy as np
from numpy.typing import NDArray

from ..arkit import NAMES
from .controls import Controls

SYMMETRIC_SHARE = 0.75
"""How often the right side of a face repeats its left."""
SMALL_SHARE = 0.5
"""How often a whole face is done less strongly: people do most things by half."""
PARTNERS = tuple(
    (NAMES.index(name), NAMES.index(name.replace("Left", "Right")))
    for name in NAMES
    if name.endswith("Left") and name not in ("jawLeft", "mouthLeft")
)
GAZE = tuple(NAMES.index(f"eyeLook{way}{side}") for way in ("Down", "In", "Out", "Up") for side in ("Left", "Right"))
COMPOUNDS: tuple[dict[str, float], ...] = (
    {"mouthSmile": 1, "cheekSquint": 0.6, "mouthUpperUp": 0.3},
    {"mouthSmile": 1, "jawOpen": 0.5, "mouthUpperUp": 0.5, "mouthLowerDown": 0.4, "eyeSquint": 0.4},
    {"mouthPucker": 1, "mouthFunnel": 0.4},
    {"mouthFunnel": 1, "jawOpen": 0.4},
    {"jawOpen": 1, "mouthLowerDown": 0.3},
    {"mouthFrown": 1, "mouthShrugLower": 0.6, "browInnerUp": 0.7},
    {"browDown": 1, "eyeSquint": 0.5, "noseSneer": 0.4},
    {"browInnerUp": 1, "browOuterUp": 1, "eyeWide": 0.7, "jawOpen": 0.4},
    {"browInnerUp": 1, "browOuterUp": 0.8},
    {"eyeBlink": 1},
    {"eyeBlink": 1, "eyeSquint": 0.5, "cheekSquint": 0.5},
    {"mouthPress": 1, "mouthRollLower": 0.4, "mouthRollUpper": 0.4},
    {"mouthStretch": 1, "mouthLowerDown": 0.5},
    {"mouthClose": 0.3, "jawOpen": 0.35, "mouthPucker": 0.5},
)


def random_weights(count: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """``count`` random faces as ARKit weights [count, 52] in [0, 1]; the first is neutral."""
    faces = np.zeros((count, len(NAMES)))
    for face in faces[1:]:
        for _ in range(rng.integers(0, 4)):
            _add_compound(face, COMPOUNDS[rng.integers(len(COMPOUNDS))], rng)
        singles = rng.choice(len(NAMES), rng.integers(0, 7), replace=False)
        face[singles] += rng.beta(0.8, 1.6, len(singles))
        if rng.random() < SYMMETRIC_SHARE:
            for left, right in PARTNERS:
                if left not in GAZE:
                    face[right] = face[left]
        if rng.random() < SMALL_SHARE:
            face *= rng.uniform(0.1, 1)
        if rng.random() < 0.7:
            _look(face, rng)
    return np.clip(faces, 0, 1).astype(np.float32)


def _add_compound(face: NDArray[np.float64], compound: dict[str, float], rng: np.random.Generator) -> None:
    strength = rng.beta(1.2, 1.2)
    for stem, amount in compound.items():
        for name in (stem, f"{stem}Left", f"{stem}Right"):
            if name in NAMES:
                face[NAMES.index(name)] += strength * amount * rng.uniform(0.6, 1.2)


def _look(face: NDArray[np.float64], rng: np.random.Generator) -> None:
    """Both eyes to one point: horizontal > 0 is the person's left."""
    horizontal, vertical = np.clip(rng.normal(0, 0.4, 2), -1, 1)
    amounts = {
        "eyeLookOutLeft": horizontal,
        "eyeLookInRight": horizontal,
        "eyeLookInLeft": -horizontal,
        "eyeLookOutRight": -horizontal,
        "eyeLookUpLeft": vertical,
        "eyeLookUpRight": vertical,
        "eyeLookDownLeft": -vertical,
        "eyeLookDownRight": -vertical,
    }
    for name, amount in amounts.items():
        face[NAMES.index(name)] = max(0.0, amount)


def random_coefficients(controls: Controls, count: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """``count`` random weights [count, E] of an avatar that is steered by its coefficients: normal, a third as wide as
    their bounds; the first is neutral."""
    weights = rng.normal(size=(count, len(controls.upper))) * controls.upper / 3
    weights[0] = 0
    return np.clip(weights, controls.lower, controls.upper).astype(np.float32)
