"""Framing: head and shoulders, seen by a camera that stands where a photographer would."""

from math import radians, tan

from ...models.gem import Viewing
from ...render.camera import Camera, orbit

HEAD_SHARE = 0.64
"""The head's part of the picture's height."""
HEAD_MIDDLE = 0.45
"""Where the middle of the head lies, from the top, as a part of the height: room for the shoulders below."""
BELOW_HEADS = (1 - HEAD_MIDDLE) / HEAD_SHARE
"""From the middle of the head down to the lower side of the picture, in heights of the head, always: not far below
that busts end."""
FIELD_OF_VIEW_DEG = 18.0
"""Vertical: a long lens, which leaves noses their size."""
LEAST_WIDTH_HEADS = 1.0
"""Pictures in which the head would not have so many of its heights from side to side show a smaller one; the room that
this leaves is above it. The heads of the shipped avatars are not cut off then, turned by 30 degrees or tilted by 15."""
MOST_PITCH_DEG = 89.0
"""Right above a head no side of the picture is up."""


def portrait(viewing: Viewing, width: int, height: int, yaw_deg: float = 0.0, pitch_deg: float = 0.0) -> Camera:
    """The camera of a head-and-shoulders portrait, ``width`` x ``height`` pixels."""
    share = min(HEAD_SHARE, width / height / LEAST_WIDTH_HEADS)
    picture_height = viewing.head_height / share
    distance = picture_height / 2 / tan(radians(FIELD_OF_VIEW_DEG) / 2)
    x, y, z = viewing.target
    target = (x, y - BELOW_HEADS * viewing.head_height + picture_height / 2, z)
    pitch_deg = min(MOST_PITCH_DEG, max(-MOST_PITCH_DEG, pitch_deg))
    return orbit(target, distance, yaw_deg, pitch_deg, FIELD_OF_VIEW_DEG, width, height)
