"""The 52 ARKit blend shapes: the common language of trackers, heads and avatars."""

NAMES: tuple[str, ...] = tuple(
    """browDownLeft browDownRight browInnerUp browOuterUpLeft browOuterUpRight cheekPuff cheekSquintLeft
    cheekSquintRight eyeBlinkLeft eyeBlinkRight eyeLookDownLeft eyeLookDownRight eyeLookInLeft eyeLookInRight
    eyeLookOutLeft eyeLookOutRight eyeLookUpLeft eyeLookUpRight eyeSquintLeft eyeSquintRight eyeWideLeft
    eyeWideRight jawForward jawLeft jawOpen jawRight mouthClose mouthDimpleLeft mouthDimpleRight mouthFrownLeft
    mouthFrownRight mouthFunnel mouthLeft mouthLowerDownLeft mouthLowerDownRight mouthPressLeft mouthPressRight
    mouthPucker mouthRight mouthRollLower mouthRollUpper mouthShrugLower mouthShrugUpper mouthSmileLeft
    mouthSmileRight mouthStretchLeft mouthStretchRight mouthUpperUpLeft mouthUpperUpRight noseSneerLeft
    noseSneerRight tongueOut""".split()
)
"""Alphabetical. "Left" is the person's own left. A weight is 0 at rest and 1 at the full shape."""
PARTNERS: tuple[tuple[int, int], ...] = tuple(
    (NAMES.index(name), NAMES.index(name.replace("Left", "Right")))
    for name in NAMES
    if name.endswith("Left") and not name.startswith(("eyeLook", "jaw")) and name != "mouthLeft"
)
"""Places of the same movement of a face's left and right half. Eyes look at one thing, so theirs are not."""
