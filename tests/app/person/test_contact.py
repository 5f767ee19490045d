"""The contact sheet shows each candidate's face, marks the chosen one, and says what speaks against the others."""

from fractions import Fraction

import numpy as np
import pytest
from faces import face
from gemheads.app.errors import UsageError
from gemheads.app.files.frames import Frame
from gemheads.app.person.contact import COLUMNS, FACE_PX, against, contact_sheet, place
from gemheads.app.person.neutrals import NeutralRule, read_rule, said
from gemheads.models.driver.face import FaceObservation
from gemheads.models.driver.neutral import Candidate, NeutralChoice

CALM = {"turned": 0.01, "open_mouth": 0.0, "blurred": 0.02}


def shots(count: int) -> tuple[list[Candidate], list[Frame], list[FaceObservation | None]]:
    """Candidates in reverse order of the frames; each frame's face is a square of its own grey on black."""
    frames, faces = [], []
    for i in range(count):
        rgb = np.zeros((240, 320, 3), np.uint8)
        rgb[100:180, 100 + i : 180 + i] = 100 + 10 * i
        frames.append(Frame(rgb, i, Fraction(1, 25), number=4 * i))
        faces.append(face(at=(100.0 + i, 100.0)))
    return [Candidate(i, i / 25, 0.1, CALM) for i in reversed(range(count))], frames, faces


def cell(sheet: np.ndarray, n: int, count: int) -> np.ndarray:
    columns = min(COLUMNS, count)
    height, width = sheet.shape[0] // -(-count // columns), sheet.shape[1] // columns
    row, column = divmod(n, columns)
    return sheet[row * height :, column * width :][:height, :width]


def has_green(image: np.ndarray) -> bool:
    r, g, b = image.astype(int).reshape(-1, 3).T
    return bool(((g > r + 60) & (g > b + 40)).any())


@pytest.mark.parametrize("count", [1, 2, 6])
def test_every_candidate_is_there_and_the_first_is_marked(count: int) -> None:
    candidates, frames, faces = shots(count)
    sheet = contact_sheet(candidates, frames, faces)
    assert sheet.dtype == np.uint8
    for n in range(count):
        picture = cell(sheet, n, count)
        middle = picture[12 + FACE_PX // 2, picture.shape[1] // 2]
        assert middle.tolist() == [100 + 10 * candidates[n].index] * 3  # its own face, in the middle
        assert has_green(picture) is (n == 0)


def test_a_face_at_the_edge_of_the_picture_is_shown_whole() -> None:
    candidates, frames, _ = shots(1)
    sheet = contact_sheet(candidates, frames, [face(at=(280.0, 200.0))])  # 80 pixels wide, 40 of them outside
    assert sheet[12 + FACE_PX - 20, 12 + FACE_PX - 20].tolist() == [255] * 3


def test_what_speaks_against_a_frame() -> None:
    assert against(Candidate(0, 0, 0, CALM)) == "nothing against it"
    assert against(Candidate(0, 0, 0, {**CALM, "turned": 0.2})) == "a little: the head is turned"
    both = Candidate(0, 0, 0, {**CALM, "turned": 0.5, "open_mouth": 1.0})
    assert against(both) == "the head is turned; the mouth is open"


def test_a_frame_is_named_as_the_option_takes_it() -> None:
    frame = Frame(np.zeros((2, 2, 3), np.uint8), 7, Fraction(1, 2), number=12)
    assert place(frame) == "frame=12, 3.50 s"
    assert place(Frame(frame.rgb, 7, Fraction(1, 2))) == "time=3.50"


def test_the_line_says_where_the_others_can_be_seen(tmp_path) -> None:
    choice = NeutralChoice(0, 0.0, np.zeros(1, np.float32), np.zeros(3), "frame 4", (Candidate(0, 0, 0, CALM),))
    assert "--neutral-sheet" in said(choice, NeutralRule("auto"))
    assert f"{tmp_path}" in said(choice, NeutralRule("auto", sheet=tmp_path))
    assert said(choice, NeutralRule("first")) == "frame 4"


def test_only_auto_has_others_to_show(tmp_path) -> None:
    assert read_rule("auto", tmp_path).sheet == tmp_path
    with pytest.raises(UsageError, match="leave it out with --neutral frame=3"):
        read_rule("frame=3", tmp_path)
