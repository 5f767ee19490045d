"""What faces' shapes seem to turn is learned from heads whose turns are known."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gemheads.models.driver.geometry import read_geometry
from gemheads.models.driver.networks import FOLDER, GEOMETRY_FILE, SEEMING_FILE, read_checked
from gemheads.models.driver.seeming import read_seeming

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

from gemheads.models.gemfile import load_gem, save_gem  # noqa: E402
from gemheads.models.train import seeming  # noqa: E402
from gemheads.models.train.response import AvatarNotSeen  # noqa: E402
from gemheads.render.rotations import matrix_from_wxyz, wxyz_from_rotvec  # noqa: E402
from pixelface import PixelTracker, painted  # noqa: E402
from toygem import toy_gem  # noqa: E402

AVATARS = FOLDER.parent / "avatars"
NOD = 0.02
"""Radians that the chin of the toy, a centimetre lower, seems to nod."""


class Leaning:
    """A studio in which a face that opens its mouth is read with a nod that its head does not make."""

    def __init__(self, gem: object) -> None:
        self._face = PixelTracker().track(painted(0, 0, 0))
        self._looks = 0

    def rest(self, rng):
        return self._seen(0.0, np.zeros(3))

    def look(self, coefficients, turn, rng):
        self._looks += 1
        if self._looks % 7 == 0:
            return None
        return self._seen(rng.uniform(0, 3), turn, lost=self._looks % 11 == 0)

    def _seen(self, chin: float, turn: np.ndarray, lost: bool = False):
        mesh, pose = self._face.metric_mesh.copy(), np.eye(4)
        mesh[152, 1] -= chin
        turned, nod = (matrix_from_wxyz(wxyz_from_rotvec(v)) for v in (turn, np.array([NOD * chin + lost, 0, 0])))
        pose[:3, :3] = 0.9 * turned @ nod
        return replace(self._face, metric_mesh=mesh, head_pose=pose)


def test_a_chin_that_seems_to_nod_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(seeming, "Studio", Leaning)
    told: list[tuple[int, int]] = []
    sitting = seeming.sit(toy_gem(), 60, 4, lambda done, total: told.append((done, total)))
    assert told[-1] == (60, 60)
    assert 40 < len(sitting.moved) < 52, "without the faces that were not seen, and those that were lost"
    found = seeming.learned([sitting])
    away = np.zeros((468, 3))
    away[152, 1] = -1
    np.testing.assert_allclose(found.turn(found.mean + away), [-NOD, 0, 0], atol=0.1 * NOD)


def test_a_mirror_image_seems_to_turn_as_the_face_does() -> None:
    shipped = read_seeming(read_checked(FOLDER, SEEMING_FILE))
    canonical = read_geometry(read_checked(FOLDER, GEOMETRY_FILE)).vertices
    partners = [int(((canonical - one * [-1, 1, 1]) ** 2).sum(1).argmin()) for one in canonical]
    mesh = shipped.mean + np.random.default_rng(3).normal(0, 0.05, (468, 3))
    turn, mirrored = shipped.turn(mesh), shipped.turn(mesh[partners] * [-1, 1, 1])
    np.testing.assert_allclose(mirrored, turn * [1, -1, -1], atol=1e-6)


def test_the_same_seed_sees_the_same() -> None:
    gem = load_gem(AVATARS / "mara.gem")
    one, again = (seeming.sit(gem, 3, 5) for _ in range(2))
    np.testing.assert_array_equal(one.moved, again.moved)
    np.testing.assert_array_equal(one.errors, again.errors)
    assert np.degrees(np.abs(one.errors)).max() < 8


def test_an_avatar_without_a_face_teaches_nothing() -> None:
    with pytest.raises(AvatarNotSeen):
        seeming.sit(toy_gem(), 3, 0)


def test_what_ships_mends_pictures_that_it_was_not_learned_from() -> None:
    shipped = read_seeming(read_checked(FOLDER, SEEMING_FILE))
    sitting = seeming.sit(load_gem(AVATARS / "mara.gem"), 80, 77)
    left = sitting.errors - [shipped.turn(shipped.mean + one) for one in sitting.moved]
    before, after = ((errors**2).mean(0) ** 0.5 for errors in (sitting.errors, left))
    assert after[0] < 0.7 * before[0], "the nods"
    assert (after < 1.1 * before).all()


def test_the_command_writes_a_file_and_says_whether_it_is_the_one_that_ships(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    avatar, out = tmp_path / "one.gem", tmp_path / "seeming.npy"
    save_gem(load_gem(AVATARS / "theo.gem"), avatar)
    assert seeming.main([str(avatar), "--pictures", "4", "--out", str(out)]) == 1
    said = capsys.readouterr()
    assert "sha256" in said.out
    assert "networks.py" in said.err
    assert read_seeming(out.read_bytes()).slopes.shape == (3, 468, 3)
