"""What a face's shape only seems to turn is taken off the head's rotation."""

import io
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.crossing.mirror import Mirror
from gemheads.models.driver.face import FaceObservation, FaceTracker
from gemheads.models.driver.features import head_rotation, relative_rotation
from gemheads.models.driver.networks import FOLDER, SEEMING_FILE, read_checked
from gemheads.models.driver.seeming import MOST, Seeming, read_seeming
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.models.heads.expressions import weights_of
from gemheads.models.heads.performance import perform
from gemheads.models.importers.adopt import adopt
from gemheads.models.importers.lam import load_lam
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec

AVATARS = FOLDER.parent / "avatars"
STRANGERS = Path(__file__).resolve().parents[4] / "shared" / "data" / "lam"
ACTED = (
    weights_of(browInnerUp=1.0),
    weights_of(mouthSmile=0.8),
    weights_of(mouthFrown=1.0),
    weights_of(jawOpen=0.6, browInnerUp=0.5),
    weights_of(browDown=1.0, mouthPucker=0.7),
    weights_of(mouthSmileLeft=0.8, browOuterUpLeft=0.8),
)


def shipped() -> Seeming:
    return read_seeming(read_checked(FOLDER, SEEMING_FILE))


def posed(face: FaceObservation, turn: np.ndarray, shape: np.ndarray) -> FaceObservation:
    """The face with its head pose at ``turn``, its own ``shape`` added to its mesh."""
    pose, mesh = face.head_pose.copy(), face.metric_mesh + shape
    pose[:3, :3] = 1.4 * matrix_from_wxyz(wxyz_from_rotvec(turn))
    return replace(face, head_pose=pose, metric_mesh=mesh, seeming_turn=shipped().turn(mesh))


def test_a_mesh_seems_to_turn_in_proportion_and_not_without_end() -> None:
    rng = np.random.default_rng(2)
    seeming, away = shipped(), rng.normal(size=(468, 3))
    away *= 0.01 / np.abs(seeming.turn(seeming.mean + away)).max()
    np.testing.assert_allclose(seeming.turn(seeming.mean), 0)
    np.testing.assert_allclose(
        seeming.turn(seeming.mean + 3 * away), 3 * seeming.turn(seeming.mean + away), rtol=1e-9, atol=1e-12
    )
    assert np.abs(seeming.turn(seeming.mean + 1e6 * away)).max() == MOST


def test_a_file_is_read_as_it_was_written() -> None:
    seeming = shipped()
    again = read_seeming(seeming.packed())
    np.testing.assert_array_equal(again.mean, seeming.mean)
    np.testing.assert_array_equal(again.slopes, seeming.slopes)


@pytest.mark.parametrize(
    "table",
    [
        np.zeros((3, 468, 3), "f4"),
        np.zeros((4, 468, 3)),
        np.full((4, 468, 3), np.nan, "f4"),
        np.array([{"a": "pickle"}], dtype=object),
    ],
)
def test_another_table_is_refused(table: np.ndarray) -> None:
    file = io.BytesIO()
    np.save(file, table, allow_pickle=True)
    with pytest.raises(ValueError, match="seeming turn: "):
        read_seeming(file.getvalue())


@pytest.mark.parametrize("content", [b"", b"\x93NUMPY", b"\x80\x04K\x01."])
def test_other_bytes_are_refused(content: bytes) -> None:
    with pytest.raises(ValueError, match="seeming turn: "):
        read_seeming(content)


def test_what_seems_is_taken_off_where_the_head_looks(still_face: FaceObservation) -> None:
    turn, seems = np.array([0.2, 0.5, -0.1]), np.array([0.05, -0.02, 0.01])
    turned, moved = (matrix_from_wxyz(wxyz_from_rotvec(v)) for v in (turn, seems))
    pose = still_face.head_pose.copy()
    pose[:3, :3] = 1.3 * turned @ moved.T
    found = head_rotation(replace(still_face, head_pose=pose, seeming_turn=seems))
    np.testing.assert_allclose(found, turn, atol=1e-9)


def test_a_face_of_another_shape_turns_as_far(still_face: FaceObservation) -> None:
    """What a person's own shape seems to turn is in the neutral, too, and goes out of it however far the head turns."""
    rng, slopes = np.random.default_rng(8), shipped().slopes.reshape(3, -1)
    turn, none = np.array([0.2, 0.6, -0.1]), np.zeros(3)
    shape, expression = rng.normal(size=(2, 468, 3))
    shape *= 0.1 / np.abs(slopes @ shape.ravel()).max()
    expression *= 0.05 / np.abs(slopes @ expression.ravel()).max()

    def found(own: np.ndarray) -> np.ndarray:
        rest, acted = posed(still_face, none, own), posed(still_face, turn, own + expression)
        return relative_rotation(head_rotation(acted), head_rotation(rest))

    np.testing.assert_allclose(found(shape), found(np.zeros_like(shape)), atol=np.radians(0.4))


def plain_and_mended(gem: Gem) -> tuple[np.ndarray, np.ndarray]:
    """[ACTED, 3] each: how far a head that does not move is read to turn, in degrees, as if its face were rigid and as
    the product has it."""
    mirror, tracker = Mirror(gem, 384), FaceTracker()
    seen = []
    for weights in (np.zeros(52), *ACTED):
        tracker.reset()
        picture = mirror.draw(gem.arkit_coefficients(weights), np.zeros(3))
        face = [tracker.track(picture) for _ in range(2)][-1]
        assert face is not None
        seen.append(face)
    rigid = [replace(face, seeming_turn=np.zeros(3)) for face in seen]
    plain, mended = ([head_rotation(face) for face in faces] for faces in (rigid, seen))
    return tuple(np.degrees([relative_rotation(r, all_[0]) for r in all_[1:]]) for all_ in (plain, mended))


@pytest.mark.parametrize("name", ["jonah", "mara", "theo"])
def test_a_still_head_that_acts_seems_to_turn_less(name: str) -> None:
    plain, mended = plain_and_mended(load_gem(AVATARS / f"{name}.gem"))
    assert np.abs(plain).max() > 2.5
    assert np.abs(mended).max() < 1.8
    assert np.linalg.norm(mended) < 0.6 * np.linalg.norm(plain)


@pytest.mark.parametrize("name", ["nyx", "james"])
def test_so_does_that_of_somebody_it_was_not_learned_from(name: str, tmp_path: Path) -> None:
    archive = STRANGERS / f"{name}.zip"
    if not archive.is_file():
        pytest.skip(f"needs {archive.name} in ../shared/data/lam; it cannot ship (CC BY-NC)")
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(tmp_path)
    source = load_lam(next(tmp_path.glob("*/skin.glb")).parent).source(perform(np.random.default_rng(0), 120)[::2])
    plain, mended = plain_and_mended(adopt(source, name, 20)[0])
    assert np.linalg.norm(mended) < 0.75 * np.linalg.norm(plain)
