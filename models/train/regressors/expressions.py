"""Random faces to learn from: ARKit weights that cover speech, bared teeth, single movements, mixtures and extremes."""

import numpy as np
from numpy.typing import NDArray

from ...arkit import NAMES, PARTNERS
from ...heads.expressions import weights_of
from ...heads.performance import mixture, plausible
from .controls import Controls

SYMMETRIC_SHARE = 0.75
"""How often the right side of a face repeats its left."""
SMALL_SHARE = 0.5
"""How often a whole face is done less strongly: people do most things by half."""
OTHER_HALF = (0.3, 1.0)
"""Where it does not, the right side of a mixture does so much of what the left does."""
SPOKEN_SHARE = 0.35
"""How many faces speak and feel something, which is what people do before a camera."""
BARED_SHARE = 0.5
"""How many of these show teeth, most of them with the jaw all but closed, as grins and hissed sounds do. How an avatar
is read there does not follow from how it is read with its jaw open."""
AROUND_TEETH = ("mouthStretch", "mouthSmile", "mouthFunnel", "mouthFrown", "noseSneer", "mouthDimple", "mouthPucker",
                "mouthShrugUpper", "mouthPress", "browDown", "browInnerUp")  # fmt: skip
"""What a face that bares its teeth may do besides."""
MIXED_SHARE = 0.3
"""How many faces are mixtures of any movements at once: what people do together nobody has listed."""
GRINNING_SHARE = 0.12
"""How many grin or laugh, and not by halves. It is what people do most before a camera, and where the tracker's score
has all but ended, so that only many examples tell half a smile from a whole one."""
MOST_OF_MOUTH, MOST_OF_REST = 7, 4
"""Movements of the mouth, and of all else but the gaze, in one mixture."""
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


_HALVES = {place for pair in PARTNERS for place in pair}
MOVEMENTS: tuple[tuple[int, ...], ...] = tuple(
    sorted(
        PARTNERS
        + tuple(
            (place,)
            for place, name in enumerate(NAMES)
            if place not in _HALVES and name != "tongueOut" and not name.startswith("eyeLook")
        )
    )
)
"""Places of the shapes of each movement but the gaze: one for the whole face, or one for each half."""
OF_MOUTH = tuple(places for places in MOVEMENTS if NAMES[places[0]].startswith(("jaw", "mouth")))
OF_REST = tuple(places for places in MOVEMENTS if places not in OF_MOUTH)


def random_weights(count: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """``count`` random faces as ARKit weights [count, 52] in [0, 1]; the first is neutral."""
    faces = np.zeros((count, len(NAMES)))
    for face in faces[1:]:
        kind, small = rng.random(), rng.random() < SMALL_SHARE
        grins = kind < GRINNING_SHARE
        if grins:
            face += _grin(rng)
        elif kind < GRINNING_SHARE + SPOKEN_SHARE:
            face += _speak(rng)
        elif kind < GRINNING_SHARE + SPOKEN_SHARE + MIXED_SHARE:
            _mix(face, rng)
        else:
            _compose(face, rng)
        if small and not grins:
            face *= rng.uniform(0.1, 1)
        if rng.random() < 0.7:
            _look(face, rng)
    return np.clip(faces, 0, 1).astype(np.float32)


def _speak(rng: np.random.Generator) -> NDArray[np.float32]:
    """Speech and feeling, and teeth."""
    face = mixture(rng)
    if rng.random() < BARED_SHARE:
        bared = weights_of(mouthUpperUp=rng.beta(1.5, 0.8), mouthLowerDown=rng.beta(1, 1.2), jawOpen=rng.beta(0.6, 3))
        for name in rng.choice(AROUND_TEETH, rng.integers(0, 4), replace=False):
            bared += weights_of(**{name: rng.beta(1, 1.2)})
        face = rng.choice([0, 0.5, 1]) * face + rng.uniform(0.3, 1.1) * bared
    return plausible(face[None])[0]


def _grin(rng: np.random.Generator) -> NDArray[np.float32]:
    """A smile from half to whole, with or without teeth, laughing or not; what else the mouth does stays small."""
    smile = rng.uniform(0.4, 1)
    face = weights_of(mouthSmile=smile)
    if rng.random() < 0.7:
        face += smile * weights_of(mouthUpperUp=rng.uniform(0, 1), mouthLowerDown=rng.beta(1, 1.5))
    if rng.random() < 0.5:
        face += weights_of(jawOpen=rng.beta(1, 2.5))
    face += weights_of(cheekSquint=rng.uniform(0, 0.8), eyeSquint=rng.uniform(0, 0.6), eyeBlink=rng.beta(0.5, 4))
    face += weights_of(**{str(rng.choice(("browInnerUp", "browOuterUp", "browDown"))): rng.beta(0.5, 2)})
    for name in rng.choice(AROUND_TEETH, rng.integers(0, 3), replace=False):
        face += weights_of(**{name: rng.beta(0.8, 3)})
    if rng.random() >= SYMMETRIC_SHARE:
        for _, right in PARTNERS:
            face[right] *= rng.uniform(0.6, 1.0)
    return face


def _compose(face: NDArray[np.float64], rng: np.random.Generator) -> None:
    """Compounds and a few single movements."""
    for _ in range(rng.integers(0, 4)):
        _add_compound(face, COMPOUNDS[rng.integers(len(COMPOUNDS))], rng)
    singles = rng.choice(len(NAMES), rng.integers(0, 7), replace=False)
    face[singles] += rng.beta(0.8, 1.6, len(singles))
    if rng.random() < SYMMETRIC_SHARE:
        for left, right in PARTNERS:
            face[right] = face[left]


def _mix(face: NDArray[np.float64], rng: np.random.Generator) -> None:
    """Any movements at once, each by both halves of the face."""
    for movements, most in ((OF_MOUTH, MOST_OF_MOUTH), (OF_REST, MOST_OF_REST)):
        for movement in rng.choice(len(movements), rng.integers(1, most + 1), replace=False):
            face[list(movements[movement])] += rng.beta(1.0, 1.4)
    if rng.random() >= SYMMETRIC_SHARE:
        for _, right in PARTNERS:
            face[right] *= rng.uniform(*OTHER_HALF)


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
