"""Faces to learn from: single shapes, visemes, emotions, gaze and blinks, and their mixtures, as ARKit weights."""

import numpy as np
from numpy.typing import NDArray

from ..arkit import NAMES
from .expressions import weights_of

Weights = NDArray[np.float32]

VISEMES: dict[str, dict[str, float]] = {
    "sil": {},
    "PP": {"mouthPress": 0.6, "mouthRollLower": 0.35, "mouthRollUpper": 0.25},
    "FF": {"mouthRollLower": 0.6, "mouthUpperUp": 0.3, "jawOpen": 0.08},
    "TH": {"jawOpen": 0.18, "mouthLowerDown": 0.25, "tongueOut": 0.3},
    "DD": {"jawOpen": 0.15, "mouthStretch": 0.2, "mouthLowerDown": 0.25},
    "kk": {"jawOpen": 0.22, "mouthLowerDown": 0.2},
    "CH": {"mouthFunnel": 0.55, "jawOpen": 0.12, "mouthShrugUpper": 0.2},
    "SS": {"mouthStretch": 0.35, "mouthLowerDown": 0.3, "jawOpen": 0.06, "mouthDimple": 0.2},
    "nn": {"jawOpen": 0.14, "mouthShrugUpper": 0.15},
    "RR": {"mouthFunnel": 0.35, "mouthPucker": 0.3, "jawOpen": 0.12},
    "aa": {"jawOpen": 0.65, "mouthLowerDown": 0.25},
    "E": {"jawOpen": 0.35, "mouthStretch": 0.35, "mouthSmile": 0.2},
    "ih": {"jawOpen": 0.25, "mouthSmile": 0.3, "mouthLowerDown": 0.2},
    "oh": {"jawOpen": 0.42, "mouthFunnel": 0.65},
    "ou": {"jawOpen": 0.18, "mouthPucker": 0.85},
}
EMOTIONS: dict[str, dict[str, float]] = {
    "calm": {},
    "smile": {"mouthSmile": 0.85, "cheekSquint": 0.5, "eyeSquint": 0.25},
    "grin": {"mouthSmile": 1.0, "mouthUpperUp": 0.55, "jawOpen": 0.15, "cheekSquint": 0.8, "eyeSquint": 0.4},
    "laugh": {"mouthSmile": 0.9, "jawOpen": 0.55, "mouthUpperUp": 0.4, "eyeSquint": 0.6, "browOuterUp": 0.2},
    "surprise": {"browInnerUp": 0.9, "browOuterUp": 0.9, "eyeWide": 0.9, "jawOpen": 0.45, "mouthFunnel": 0.2},
    "anger": {"browDown": 0.95, "noseSneer": 0.5, "eyeSquint": 0.4, "mouthPress": 0.6, "mouthFrown": 0.3},
    "sad": {"browInnerUp": 0.9, "mouthFrown": 0.75, "mouthShrugLower": 0.5, "eyeBlink": 0.2},
    "disgust": {"noseSneer": 0.95, "mouthUpperUp": 0.6, "browDown": 0.5, "mouthFrown": 0.4},
    "fear": {"browInnerUp": 0.8, "eyeWide": 0.9, "mouthStretch": 0.6, "jawOpen": 0.2},
    "doubt": {"mouthPucker": 0.4, "browDownLeft": 0.7, "browOuterUpRight": 0.8, "mouthLeft": 0.4},
    "smirk": {"mouthSmileLeft": 0.8, "mouthDimpleLeft": 0.4, "eyeSquintLeft": 0.3, "browOuterUpLeft": 0.3},
    "puff": {"cheekPuff": 0.9, "mouthPucker": 0.3},
}
PAIRED = tuple(
    sorted({n.removesuffix("Left") for n in NAMES if n.endswith("Left") and not n.startswith(("jaw", "mouthL"))})
)


def perform(rng: np.random.Generator, frames: int = 600) -> Weights:
    """Weights [F, 52] of a performance: ``frames`` expressions, single shapes and rests included."""
    sheet = [np.zeros(len(NAMES), np.float32) for _ in range(8)]
    sheet += [level * unit for unit in np.eye(len(NAMES), dtype=np.float32) for level in (0.5, 1.0)]
    sheet += [weights_of(**{name: 1.0}) for name in PAIRED]
    sheet += [weights_of(**emotion) for emotion in EMOTIONS.values()]
    sheet += [weights_of(**viseme) for viseme in VISEMES.values()]
    while len(sheet) < frames:
        sheet.append(mixture(rng))
    return plausible(np.stack(sheet[:frames]))


def plausible(weights: Weights) -> Weights:
    """The weights [F, 52] within 0..1 and within what a face can do: lips close only as far as the jaw is open."""
    result = np.clip(weights, 0, 1).astype(np.float32)
    jaw, close = NAMES.index("jawOpen"), NAMES.index("mouthClose")
    result[:, close] = np.minimum(result[:, close], result[:, jaw])
    for side in ("Left", "Right"):
        for one, other in (("In", "Out"), ("Up", "Down")):
            a, b = NAMES.index(f"eyeLook{one}{side}"), NAMES.index(f"eyeLook{other}{side}")
            common = np.minimum(result[:, a], result[:, b])
            result[:, a] -= common
            result[:, b] -= common
        blink, wide = NAMES.index(f"eyeBlink{side}"), NAMES.index(f"eyeWide{side}")
        result[:, wide] *= 1 - result[:, blink]
        squint = NAMES.index(f"eyeSquint{side}")
        result[:, squint] *= 1 - 0.7 * result[:, blink]
    return result


def gaze(horizontal: float, vertical: float) -> Weights:
    """Both eyes turned: ``horizontal`` 1 looks fully to the person's left, ``vertical`` 1 fully up."""
    left, right = max(horizontal, 0), max(-horizontal, 0)
    up, down = max(vertical, 0), max(-vertical, 0)
    return weights_of(
        eyeLookOutLeft=left,
        eyeLookInRight=left,
        eyeLookOutRight=right,
        eyeLookInLeft=right,
        eyeLookUp=up,
        eyeLookDown=down,
    )


def mixture(rng: np.random.Generator) -> Weights:
    """One random face [52], not yet ``plausible``: speech, feeling, gaze, lids, sometimes with odd single muscles."""
    visemes, emotions = list(VISEMES.values()), list(EMOTIONS.values())
    face = np.zeros(len(NAMES), np.float32)
    if rng.random() < 0.7:
        a, b = rng.integers(len(visemes), size=2)
        blend = rng.random()
        face += rng.uniform(0.4, 1.3) * (blend * weights_of(**visemes[a]) + (1 - blend) * weights_of(**visemes[b]))
    if rng.random() < 0.75:
        face += rng.uniform(0.15, 1.15) * weights_of(**emotions[rng.integers(len(emotions))])
    if rng.random() < 0.7:
        face += gaze(float(rng.uniform(-1, 1)), float(rng.uniform(-1, 1)))
    if rng.random() < 0.4:
        lids = rng.choice([0.3, 0.6, 1.0])
        sides = rng.random(2) < 0.9
        face += weights_of(eyeBlinkLeft=lids * sides[0], eyeBlinkRight=lids * sides[1])
    if rng.random() < 0.45:
        for muscle in rng.choice(len(NAMES), rng.integers(1, 5), replace=False):
            face[muscle] += rng.beta(0.9, 1.2)
    if rng.random() < 0.3:
        uneven = rng.uniform(0.3, 1, 2)
        for index, name in enumerate(NAMES):
            face[index] *= uneven[0] if name.endswith("Left") else uneven[1] if name.endswith("Right") else 1
    return face
