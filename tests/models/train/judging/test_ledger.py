"""What is kept of an evaluation: given back as it was, believed only where it belongs, and lost only by a little."""

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

pytest.importorskip("torch", reason="evaluating needs the extra gemheads[train]")

from gemheads.models.captures.heldout import viewers
from gemheads.models.captures.layout import CaptureError
from gemheads.models.captures.reader import open_capture
from gemheads.models.metrics.tables import METRICS
from gemheads.models.train.judging.contestants import Act
from gemheads.models.train.judging.ledger import AT_STAKE, Ledger, Record, ShotKeys


def record(seed: int = 0) -> Record:
    rng = np.random.default_rng(seed)
    coefficients, turn, move = (rng.normal(size=count).astype(np.float32) for count in (9, 3, 3))
    values: dict[str, float | None] = dict.fromkeys(METRICS, float(rng.normal()))
    return Record(Act(coefficients, turn, move, (1, 2), 0.25), {**values, "LPIPS": None})


def test_records_come_back_to_the_last_bit(tmp_path: Path) -> None:
    path = tmp_path / "sub" / "a.json"
    ledger = Ledger(path, "a")
    ledger.put("fitted", record())
    ledger.put("tracked", Record(Act(None, None, None, (), 0.0), record().values))
    ledger.save()
    again = Ledger(path, "a")
    assert len(again) == 2
    fitted, tracked = again.get("fitted"), again.get("tracked")
    assert fitted is not None
    assert tracked is not None
    assert fitted.values == record().values
    for name in ("coefficients", "turn", "move"):
        np.testing.assert_array_equal(getattr(fitted.act, name), getattr(record().act, name))
        assert getattr(tracked.act, name) is None
    assert fitted.act.cameras == (1, 2)
    assert again.get("other") is None


@pytest.mark.parametrize("spoilt", ["", "[]", "{}", '{"version": 1, "avatar": "a", "judged": {"x": {}}}', "\0"])
def test_what_cannot_be_understood_is_begun_anew(tmp_path: Path, spoilt: str) -> None:
    path = tmp_path / "a.json"
    path.write_text(spoilt)
    assert len(Ledger(path, "a")) == 0


def test_another_avatars_are_not_believed(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    ledger = Ledger(path, "a")
    ledger.put("x", record())
    ledger.save()
    assert len(Ledger(path, "b")) == 0


def test_a_kill_loses_little_and_writing_stays_rare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.json"
    ledger, saves, save = Ledger(path, "a"), 0, Ledger.save

    def counted(self: Ledger) -> None:
        nonlocal saves
        saves += 1
        save(self)

    monkeypatch.setattr(Ledger, "save", counted)
    for index in range(400):
        ledger.put(str(index), record())
        if index % 40 == 0:
            kept = len(json.loads(path.read_text())["judged"])
            assert index + 1 - kept <= (index + 1) / AT_STAKE
    assert saves < 200


@pytest.fixture
def footage(toy_capture: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(toy_capture, tmp_path / "capture"))


def brightened(path: Path) -> None:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    assert image is not None
    image[0, 0] ^= 1
    cv2.imwrite(str(path), image)


def test_keys_follow_all_that_a_figure_depends_on(footage: Path) -> None:
    capture = open_capture(footage)
    shot = capture.test[0]
    seen = viewers(capture, "test", shot)
    apart = next(s for s in capture.test if s.timestep != shot.timestep)
    assert shot.mask is not None

    def key(*judged_by: str) -> str:
        return ShotKeys(open_capture(footage), judged_by).key("test", shot)

    before = key()
    assert key() == before
    assert key("LPIPS alex") != before
    brightened(apart.picture)
    assert key() == before
    for path in (shot.picture, shot.mask, seen[0].picture, capture.meshes[shot.timestep], footage / "template.npz"):
        before = key()
        if path.suffix == ".npz":
            with np.load(path) as arrays:
                moved = {name: arrays[name] for name in arrays.files}
            np.savez(path, **{**moved, "vertices": moved["vertices"] + np.float32(1e-4)})
        else:
            brightened(path)
        assert key() != before, path


def test_keys_differ_between_pictures_and_name_what_is_gone(footage: Path) -> None:
    capture = open_capture(footage)
    keys = ShotKeys(capture, ())
    assert len({keys.key("test", shot) for shot in capture.test}) == len(capture.test)
    capture.val[0].picture.unlink()
    with pytest.raises(CaptureError, match="cannot be read"):
        keys.key("val", capture.val[0])
