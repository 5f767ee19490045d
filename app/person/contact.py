"""The contact sheet of a neutral: the faces that could be it, which one is, and what speaks against the others."""

import textwrap
from collections.abc import Sequence

import cv2
import numpy as np

from ...models.driver.face import FaceObservation
from ...models.driver.neutral import Candidate
from ...render.arrays import Image
from ..files.frames import Frame

COLUMNS = 3
FACE_PX = 256
"""Side of one face's picture."""
_TEXT_PX = 78
_GAP_PX = 12
_AROUND = 1.7
"""Side of the square that is shown, over the longer side of the face's landmarks."""
_CHOSEN = (0, 130, 60)
_OTHER = (90, 90, 90)
_LETTERS_A_LINE = 34


def contact_sheet(
    candidates: Sequence[Candidate], frames: Sequence[Frame], faces: Sequence[FaceObservation | None]
) -> Image:
    """sRGB [H, W, 3] with a picture of each candidate, the first of which is the chosen one.

    Args:
        candidates: at least one; their ``index`` points into the other two.
        frames: what was looked at.
        faces: the face in each.
    """
    cells = [_cell(c, frames[c.index], faces[c.index], c is candidates[0]) for c in candidates]
    cells += [np.full_like(cells[0], 255)] * (-len(cells) % min(COLUMNS, len(cells)))
    columns = min(COLUMNS, len(cells))
    rows = [np.concatenate(cells[i : i + columns], 1) for i in range(0, len(cells), columns)]
    return np.concatenate(rows)


def _cell(candidate: Candidate, frame: Frame, face: FaceObservation | None, chosen: bool) -> Image:
    colour, edge = (_CHOSEN, 5) if chosen else (_OTHER, 1)
    cell = np.full((FACE_PX + _TEXT_PX + _GAP_PX, FACE_PX + 2 * _GAP_PX, 3), 255, np.uint8)
    top = left = _GAP_PX
    cell[top : top + FACE_PX, left : left + FACE_PX] = _face(frame.rgb, face)
    cv2.rectangle(cell, (left, top), (left + FACE_PX - 1, top + FACE_PX - 1), colour, edge)
    lines = [f"{'CHOSEN: ' if chosen else ''}{place(frame)}"]
    lines += textwrap.wrap(against(candidate), _LETTERS_A_LINE)[:2]
    for i, line in enumerate(lines):
        below = (left, top + FACE_PX + 20 + 20 * i)
        cv2.putText(cell, line, below, cv2.FONT_HERSHEY_SIMPLEX, 0.44, colour, 1, cv2.LINE_AA)
    return cell


def place(frame: Frame) -> str:
    """Where in the clip a frame is, as ``--neutral`` wants it."""
    return f"time={frame.seconds:.2f}" if frame.number is None else f"frame={frame.number}, {frame.seconds:.2f} s"


def against(candidate: Candidate) -> str:
    """What speaks against a candidate, in words."""
    if candidate.flaws:
        return "; ".join(candidate.flaws)
    return f"a little: {candidate.weakness}" if candidate.weakness else "nothing against it"


def _face(rgb: Image, face: FaceObservation | None) -> Image:
    """The square around a face; where it reaches beyond the picture, white."""
    height, width = rgb.shape[:2]
    left, top, right, bottom = face.box_px if face else (0, 0, width, height)
    scale = FACE_PX / max(1.0, _AROUND * max(right - left, bottom - top))
    shift = (FACE_PX - scale * (left + right)) / 2, (FACE_PX - scale * (top + bottom)) / 2
    matrix = np.array([[scale, 0, shift[0]], [0, scale, shift[1]]])
    method = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    crop = cv2.warpAffine(
        rgb, matrix, (FACE_PX, FACE_PX), flags=method, borderMode=cv2.BORDER_CONSTANT, borderValue=(255, 255, 255)
    )
    return np.asarray(crop, np.uint8)
