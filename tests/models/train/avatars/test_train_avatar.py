"""Training a CNN avatar: it learns, it survives kills and faults, and its run can be distilled."""

import json
import shutil
import signal
import subprocess
import sys
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

import toycapture  # noqa: E402
import trainee  # noqa: E402
from checkpoints import assert_identical  # noqa: E402
from gemheads.models.captures.reader import Capture, open_capture  # noqa: E402
from gemheads.models.importers.adopt import adopt  # noqa: E402
from gemheads.models.train.avatars.astray import astray  # noqa: E402
from gemheads.models.train.avatars.deform import Moment  # noqa: E402
from gemheads.models.train.avatars.moments import Moments  # noqa: E402
from gemheads.models.train.avatars.plan import PRESETS  # noqa: E402
from gemheads.models.train.avatars.run_source import run_source  # noqa: E402
from gemheads.models.train.avatars.runs import CHECKPOINT, CONFIG, RunError, open_run, read_checkpoint, read_config  # noqa: E402
from gemheads.models.train.avatars.scene import Scene  # noqa: E402
from gemheads.models.train.avatars.train_avatar import PATIENCE, RETURNS, Trainer, train_avatar  # noqa: E402
from gemheads.models.train.deck import Deck, frontal, spaced  # noqa: E402
from gemheads.models.train.perceptual import TINY, Perceptual  # noqa: E402
from trainee import BRIEF  # noqa: E402
from waiting import eventually  # noqa: E402


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Capture:
    return open_capture(toycapture.write_capture(tmp_path_factory.mktemp("toy") / "capture"))


@pytest.fixture(scope="module")
def trained(capture: Capture, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    train_avatar(capture, folder, BRIEF, Perceptual(TINY))
    return folder


def test_thirty_steps_learn(trained: Path) -> None:
    rows = np.genfromtxt(trained / "loss.csv", delimiter=",", names=True)
    assert len(rows) == 30
    l1 = rows["l1"]
    assert l1[-6:].mean() < 0.85 * l1[2:8].mean()  # a round of moments each; before it, colours alone were learned
    assert (rows["vgg"][::2] > 0).all()
    assert not rows["vgg"][1::2].any()
    assert {path.name for path in (trained / "previews").iterdir()} == {"000015.png", "000030.png"}
    assert (trained / "loss.png").stat().st_size > 1000


@pytest.mark.parametrize("preset", PRESETS)
def test_no_preset_throws_its_network_to_the_bounds(preset: str, capture: Capture, tmp_path: Path) -> None:
    plan = replace(PRESETS[preset].changed(steps=40, perceptual=False, size=64), views=2, colors_first=4)
    train_avatar(capture, tmp_path, plan)
    rows = np.genfromtxt(tmp_path / "loss.csv", delimiter=",", names=True)
    assert rows["loss"][-12:].mean() < rows["loss"][:4].mean()
    assert rows["offset"].max() < 10  # where every splat is as far off as it can be it is 70


def test_killed_at_any_moment_it_comes_to_the_same(capture: Capture, trained: Path, tmp_path: Path) -> None:
    training = subprocess.Popen([sys.executable, trainee.__file__, capture.folder, tmp_path])

    def midway() -> bool:
        assert training.poll() is None, "it ended before it could be killed"
        state = read_checkpoint(tmp_path)
        return state is not None and state["step"] >= 10

    eventually(midway, 120)
    training.send_signal(signal.SIGKILL)
    assert training.wait(20) == -signal.SIGKILL
    assert read_checkpoint(tmp_path)["step"] < 30
    (tmp_path / ".checkpoint.pt.1.partial").write_bytes(b"half")
    outcome = train_avatar(capture, tmp_path, BRIEF, Perceptual(TINY))
    assert outcome.steps == 30
    assert_identical(tmp_path, trained)
    assert (tmp_path / "loss.csv").read_bytes() == (trained / "loss.csv").read_bytes()
    assert not list(tmp_path.glob(".*partial"))


def test_a_finished_run_stays_as_it_is(capture: Capture, trained: Path) -> None:
    before = (trained / CHECKPOINT).read_bytes()
    outcome = train_avatar(capture, trained, BRIEF, Perceptual(TINY))
    assert (trained / CHECKPOINT).read_bytes() == before
    assert outcome.skipped == 0


def test_other_settings_are_another_run(capture: Capture, trained: Path) -> None:
    with pytest.raises(RunError, match="other settings"):
        train_avatar(capture, trained, replace(BRIEF, seed=1), Perceptual(TINY))


def test_another_capture_in_its_place_is_not_learned_on(capture: Capture, trained: Path) -> None:
    moved = replace(capture.template, vertices=capture.template.vertices + np.float32(0.001))
    with pytest.raises(RunError, match=r"learned of another capture than .* holds now; bring that one back"):
        train_avatar(replace(capture, template=moved), trained, BRIEF, Perceptual(TINY))


def test_a_run_finds_its_capture_where_it_was_moved_to(capture: Capture, trained: Path, tmp_path: Path) -> None:
    run, moved = tmp_path / "run", tmp_path / "moved"
    shutil.copytree(trained, run)
    shutil.copytree(capture.folder, moved)
    config = json.loads((run / CONFIG).read_text())
    (run / CONFIG).write_text(json.dumps({**config, "capture": str(tmp_path / "gone")}))
    with pytest.raises(RunError, match=r"its capture is no longer at .*gone; bring it back, or say where it is"):
        open_run(run)
    assert train_avatar(open_capture(moved), run, BRIEF, Perceptual(TINY)).skipped == 0
    assert open_run(run).capture.folder == moved.resolve()


def test_meshes_that_were_tracked_again_are_another_capture(capture: Capture, trained: Path, tmp_path: Path) -> None:
    shutil.copytree(capture.folder, tmp_path / "again")
    mesh = tmp_path / "again" / "meshes" / "00001.npz"
    size, arrays = mesh.stat().st_size, dict(np.load(mesh))
    np.savez(mesh, **{**arrays, "vertices": arrays["vertices"] + np.float32(0.001)})
    assert mesh.stat().st_size == size
    shutil.copytree(trained, tmp_path / "run")
    with pytest.raises(RunError, match="give that capture to go on"):
        train_avatar(open_capture(tmp_path / "again"), tmp_path / "run", BRIEF, Perceptual(TINY))
    with pytest.raises(RunError, match="learned of another capture"):
        open_run(tmp_path / "run", tmp_path / "again")


@pytest.mark.parametrize("part", ["uv", "neck_pivot", "triangles"])
def test_another_template_is_another_capture(capture: Capture, trained: Path, part: str) -> None:
    changed = replace(capture.template, **{part: getattr(capture.template, part)[::-1].copy()})
    with pytest.raises(RunError, match="learned of another capture"):
        train_avatar(replace(capture, template=changed), trained, BRIEF, Perceptual(TINY))


def test_a_checkpoint_that_would_fill_the_memory_is_refused(trained: Path, tmp_path: Path) -> None:
    shutil.copytree(trained, tmp_path / "run")
    path = tmp_path / "run" / CHECKPOINT
    with zipfile.ZipFile(path) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    with pytest.raises(RunError, match="is broken"):
        read_checkpoint(tmp_path / "run")


def test_a_config_as_large_as_none_is_refused_unread(tmp_path: Path) -> None:
    (tmp_path / CONFIG).write_text("[" + "[]," * 2**20 + "0]")
    with pytest.raises(RunError, match="more than a config takes"):
        read_config(tmp_path)


def test_a_folder_that_holds_something_else_takes_no_run(capture: Capture, tmp_path: Path) -> None:
    (tmp_path / "photo.png").touch()
    with pytest.raises(RunError, match=r"is no run, and there is something in it; name a new folder"):
        train_avatar(capture, tmp_path, BRIEF, Perceptual(TINY))
    assert [file.name for file in tmp_path.iterdir()] == ["photo.png"]


def poisoned(monkeypatch: pytest.MonkeyPatch, timesteps: set[int]) -> None:
    """Meshes of these moments reach the network as NaN."""
    sound = Moments.__getitem__

    def moment(self: Moments, timestep: int) -> Moment:
        found = sound(self, timestep)
        return replace(found, positions=found.positions * float("nan")) if timestep in timesteps else found

    monkeypatch.setattr(Moments, "__getitem__", moment)


def test_a_step_that_is_not_finite_is_skipped(
    capture: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    poisoned(monkeypatch, {3})
    plan = replace(BRIEF, steps=12, preview_every=100)
    outcome = train_avatar(replace(capture, val=(), test=()), tmp_path, plan)
    assert outcome.skipped == 2  # six moments, so each comes twice
    assert outcome.restored == 0
    assert np.isfinite(outcome.loss)
    state = read_checkpoint(tmp_path)
    assert state is not None
    assert all(torch.isfinite(tensor).all() for tensor in state["avatar"].values())


def test_weights_that_went_bad_are_taken_back(
    capture: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = replace(BRIEF, steps=20, preview_every=100)
    sound, calls = Scene.splats, []

    def splats(self: Scene, timestep: int, bare: bool = False) -> object:
        calls.append(timestep)
        if len(calls) == 9:  # the next checkpoint is due before patience ends
            with torch.no_grad():
                self.avatar.colors.fill_(float("nan"))
        return sound(self, timestep, bare)

    monkeypatch.setattr(Scene, "splats", splats)
    outcome = train_avatar(capture, tmp_path, plan)
    assert (outcome.skipped, outcome.restored) == (PATIENCE, 1)
    assert np.isfinite([outcome.loss, outcome.val_psnr]).all()


def test_what_is_thrown_off_goes_on_from_its_last_checkpoint_more_slowly(
    capture: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = replace(BRIEF, steps=160, checkpoint_every=40, preview_every=1000)
    sound, drawn = Trainer._learn, []

    def learn(self: Trainer) -> None:
        drawn.append(self.avatar.constant.detach().abs().max().item())
        if self.step == 90:
            with torch.no_grad():
                self.avatar.constant.add_(100.0)
        sound(self)

    monkeypatch.setattr(Trainer, "_learn", learn)
    outcome = train_avatar(capture, tmp_path, plan)
    assert (outcome.skipped, outcome.restored) == (0, 1)
    state = read_checkpoint(tmp_path)
    assert state is not None
    assert state["pace"] == 0.5
    assert max(drawn[91:120]) > 50 > max(drawn[:90] + drawn[120:])


@pytest.mark.parametrize(
    ("losses", "gone"),
    [
        ([0.1] * 80, False),
        ([0.1] * 70 + [0.3] * 10, True),
        ([0.1] * 70 + [0.3] * 5 + [float("nan")] * 5, True),
        ([0.1] * 60 + [0.3] * 10 + [0.1] * 10, False),  # it came back
        ([0.5] * 40 + [0.1] * 40, False),
        ([0.1] * 30 + [0.3] * 10, True),  # before the first checkpoint
        ([0.3] * 10 + [0.1] * 30, False),
        ([0.1] * 20 + [0.3] * 15, False),  # nobody asks before
        ([0.1] * 40 + [float("nan")] * 40, False),  # steps that are not finite have a cure of their own
    ],
)
def test_what_has_gone_astray(losses: list[float], gone: bool) -> None:
    assert astray(losses, 40) == gone


def test_a_capture_that_cannot_be_drawn_is_given_up(
    capture: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    poisoned(monkeypatch, set(capture.meshes))
    with pytest.raises(RunError, match=f"{PATIENCE * (RETURNS + 1)} steps in a row"):
        train_avatar(capture, tmp_path, replace(BRIEF, steps=100))


def test_a_run_answers_meshes_and_can_be_distilled(capture: Capture, trained: Path) -> None:
    run = open_run(trained)
    source = run_source(run)
    assert source.count == len(capture.timesteps("train")) == 6
    frames = list(source.frames())
    assert np.abs(frames[0].positions - frames[1].positions).max() > 1e-3
    assert source.performance is not None
    assert source.performance.shape == (6, 52)
    gem, distilled = adopt(source, "toy", components=5)
    assert len(gem) == len(run.texels)
    assert distilled.variance_kept["position"][-1] > 0.99
    composed = gem.compose(gem.project(frames[2]))
    assert np.abs(composed.positions - frames[2].positions).max() < 1e-3


def test_faults_of_a_folder_are_named(trained: Path, tmp_path: Path) -> None:
    with pytest.raises(RunError, match="is no training run"):
        open_run(tmp_path)
    (tmp_path / "config.json").write_bytes((trained / "config.json").read_bytes())
    with pytest.raises(RunError, match="nothing learned"):
        open_run(tmp_path)
    (tmp_path / CHECKPOINT).write_bytes((trained / CHECKPOINT).read_bytes()[:1000])
    with pytest.raises(RunError, match="is broken"):
        open_run(tmp_path)
    (tmp_path / "config.json").write_text('{"version": 7}')
    with pytest.raises(RunError, match="version 7"):
        open_run(tmp_path)
    (tmp_path / "config.json").write_text('{"version": 1, "plan": []}')
    with pytest.raises(RunError, match="cannot be understood"):
        open_run(tmp_path)


def moments_of_something_else(state: dict[str, Any]) -> None:
    state["optimizer"]["state"][0]["exp_avg"] = torch.zeros(3)


def moments_of_nobody(state: dict[str, Any]) -> None:
    state["optimizer"]["state"][1000] = state["optimizer"]["state"][0]


@pytest.mark.parametrize(
    "spoil",
    [
        *(lambda state, key=key: state.pop(key) for key in ("step", "avatar", "optimizer", "rows", "faults")),
        lambda state: state.update(step=-5),
        lambda state: state.update(step=3),
        lambda state: state.update(optimizer={}),
        lambda state: state.update(optimizer=[]),
        lambda state: state["optimizer"].update(state={0: {}}),
        moments_of_something_else,
        moments_of_nobody,
        lambda state: state.update(rows=torch.zeros(3)),
        lambda state: state.update(rows=[[0.0]]),
        lambda state: state.update(faults=[1]),
        lambda state: state.update(faults=[0, 0, -1, 0]),
        lambda state: state.update(pace=float("nan")),
        lambda state: state.update(pace={}),
    ],
)
def test_a_damaged_checkpoint_is_named(
    capture: Capture, trained: Path, tmp_path: Path, spoil: Callable[[dict[str, Any]], object]
) -> None:
    (tmp_path / "config.json").write_bytes((trained / "config.json").read_bytes())
    state = read_checkpoint(trained)
    assert state is not None
    spoil(state)
    torch.save(state, tmp_path / CHECKPOINT)
    with pytest.raises(RunError, match=f"{CHECKPOINT}: is broken .*; delete"):
        train_avatar(capture, tmp_path, BRIEF)


def test_weights_of_no_name_are_named(capture: Capture, trained: Path, tmp_path: Path) -> None:
    (tmp_path / "config.json").write_bytes((trained / "config.json").read_bytes())
    torch.save({"step": 1, "avatar": {1: torch.zeros(3)}}, tmp_path / CHECKPOINT)
    with pytest.raises(RunError, match="does not fit"):
        train_avatar(capture, tmp_path, BRIEF)


def test_every_moment_is_dealt_once_before_one_comes_again(capture: Capture) -> None:
    deck = Deck(capture.train, hand=2, seed=3)
    rounds = [[deck.dealt(step)[0].timestep for step in range(6 * turn, 6 * turn + 6)] for turn in (0, 1, 2)]
    assert all(sorted(order) == list(range(6)) for order in rounds)
    assert rounds[0] != rounds[1]
    again = Deck(capture.train, hand=2, seed=3)
    assert [shot.picture for shot in again.dealt(13)] == [shot.picture for shot in deck.dealt(13)]
    assert len({shot.camera_index for shot in deck.dealt(4)}) == 2
    assert len(Deck(capture.train, hand=9, seed=0).dealt(0)) == 4
    assert [shot.timestep for shot in spaced(capture.val, 3)] == [1, 3, 5]
    assert {shot.camera_index for shot in frontal(capture.test)} == {1}


def test_presets_can_be_built_and_changed() -> None:
    for plan in PRESETS.values():
        assert plan.size % 2**plan.levels == 0
    short = PRESETS["tiny"].changed(steps=50, perceptual=False, seed=4)
    assert (short.steps, short.colors_first, short.perceptual, short.seed) == (50, 5, 0, 4)
