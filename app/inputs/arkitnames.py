"""What senders call the 52 ARKit shapes, and the few shapes of VRM that can be said in them: one table."""

import re

from ...models.arkit import NAMES

Target = tuple[tuple[int, float], ...]
"""Indices into ``arkit.NAMES`` and how much of each."""

_OTHERS: dict[str, dict[str, float]] = {
    "a": {"jawOpen": 0.7},
    "i": {"mouthStretchLeft": 0.5, "mouthStretchRight": 0.5, "jawOpen": 0.1},
    "u": {"mouthPucker": 0.7, "jawOpen": 0.15},
    "e": {"mouthStretchLeft": 0.3, "mouthStretchRight": 0.3, "jawOpen": 0.35},
    "o": {"mouthFunnel": 0.6, "jawOpen": 0.35},
    "blink": {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0},
    "blinkleft": {"eyeBlinkLeft": 1.0},
    "blinkright": {"eyeBlinkRight": 1.0},
    "joy": {"mouthSmileLeft": 0.8, "mouthSmileRight": 0.8, "cheekSquintLeft": 0.4, "cheekSquintRight": 0.4},
    "sorrow": {"mouthFrownLeft": 0.7, "mouthFrownRight": 0.7, "browInnerUp": 0.6},
    "angry": {"browDownLeft": 0.8, "browDownRight": 0.8, "mouthPressLeft": 0.3, "mouthPressRight": 0.3},
    "surprised": {"browInnerUp": 0.6, "eyeWideLeft": 0.7, "eyeWideRight": 0.7, "jawOpen": 0.3},
}
"""The blend shapes of VRM 0 and, under other names, VRM 1."""
_SAME = {
    "aa": "a",
    "ih": "i",
    "ou": "u",
    "ee": "e",
    "oh": "o",
    "happy": "joy",
    "sad": "sorrow",
    "surprise": "surprised",
}

_TABLE: dict[str, Target] = {name.lower(): ((index, 1.0),) for index, name in enumerate(NAMES)}
_TABLE |= {
    name: tuple((NAMES.index(shape), part) for shape, part in shapes.items()) for name, shapes in _OTHERS.items()
}
_TABLE |= {name: _TABLE[other] for name, other in _SAME.items()}

_SIDES = re.compile(r"[_\-. ](l|r)$", re.IGNORECASE)
_PUNCTUATION = re.compile(r"[_\-. ]")


def target_of(name: str) -> Target | None:
    """What a sender's name means: ``jawOpen``, ``JawOpen``, ``eyeBlink_L``, ``mouth_smile_right``; None if nothing."""
    if len(name) > 64:
        return None
    plain = _SIDES.sub(lambda side: {"l": "left", "r": "right"}[side[1].lower()], name.strip())
    return _TABLE.get(_PUNCTUATION.sub("", plain).lower())
