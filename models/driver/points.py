"""Which of MediaPipe's 478 landmarks is what. Left and right are the person's own."""

from ..arkit import NAMES

RIGHT_EYE_OUTER, RIGHT_EYE_INNER = 33, 133
LEFT_EYE_INNER, LEFT_EYE_OUTER = 362, 263
RIGHT_IRIS, LEFT_IRIS = 468, 473
"""Centres; the four points behind each are on its rim."""

RIGHT_EYE = (33, 246, 161, 160, 159, 158, 157, 173, 133, 155, 154, 153, 145, 144, 163, 7)
LEFT_EYE = (263, 466, 388, 387, 386, 385, 384, 398, 362, 382, 381, 380, 374, 373, 390, 249)
RIGHT_BROW = (70, 63, 105, 66, 107, 46, 53, 52, 65, 55)
"""Upper edge from the temple to the nose, then the lower edge."""
LEFT_BROW = (300, 293, 334, 296, 336, 276, 283, 282, 295, 285)
LIPS = (
    *(61, 185, 40, 39, 37, 0, 267, 269, 270, 409, 291, 375, 321, 405, 314, 17, 84, 181, 91, 146),
    *(78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308, 324, 318, 402, 317, 14, 87, 178, 88, 95),
)
"""The outer ring, then the inner ring."""
JAW = (152, 377, 148, 400, 176, 378, 149, 379, 150, 365, 136, 397, 172)
"""The chin and the lower edge of the jaw."""
NOSE = (1, 2, 98, 327, 48, 278, 64, 294)
"""Tip, base and wings."""
CHEEKS = (50, 280, 205, 425, 117, 346, 187, 411, 36, 266)

NET_INPUT = (
    *(0, 1, 4, 5, 6, 7, 8, 10, 13, 14, 17, 21, 33, 37, 39, 40, 46, 52, 53, 54, 55, 58, 61, 63, 65, 66, 67, 70, 78, 80),
    *(81, 82, 84, 87, 88, 91, 93, 95, 103, 105, 107, 109, 127, 132, 133, 136, 144, 145, 146, 148, 149, 150, 152, 153),
    *(154, 155, 157, 158, 159, 160, 161, 162, 163, 168, 172, 173, 176, 178, 181, 185, 191, 195, 197, 234, 246, 249),
    *(251, 263, 267, 269, 270, 276, 282, 283, 284, 285, 288, 291, 293, 295, 296, 297, 300, 308, 310, 311, 312, 314),
    *(317, 318, 321, 323, 324, 332, 334, 336, 338, 356, 361, 362, 365, 373, 374, 375, 377, 378, 379, 380, 381, 382),
    *(384, 385, 386, 387, 388, 389, 390, 397, 398, 400, 402, 405, 409, 415, 454, 466, 468, 469, 470, 471, 472, 473),
    *(474, 475, 476, 477),
)
"""The 146 landmarks that the score network reads, in its order."""

SCORES: tuple[str, ...] = ("_neutral", *(name for name in NAMES if name != "tongueOut"))
"""The outputs of the score network, in its order: ARKit's names without tongueOut."""
DEAD_SCORES = frozenset(
    "_neutral cheekPuff cheekSquintLeft cheekSquintRight jawForward noseSneerLeft noseSneerRight".split()
)
"""Scores that stay near zero whatever the face does."""
