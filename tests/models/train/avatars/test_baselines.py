"""The baselines beside the CNN: each learns, survives a stop, and is what its name says; no config can ask for more."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the extra gemheads[train]")

import toycapture  # noqa: E402
from checkpoints import assert_identical  # noqa: E402
from gemheads.models.captures.layout import CaptureError, Tracked  # noqa: E402
from gemheads.models.captures.reader import Capture, open_capture  # noqa: E402
from gemheads.models.captures.standin import StandIn  # noqa: E402
from gemheads.models.importers.adopt import adopt  # noqa: E402
from gemheads.models.metrics.pixels import psnr  # noqa: E402
from gemheads.models.train.avatars.plan import Model, Plan  # noqa: E402
from gemheads.models.train.avatars.run_source import run_source  # noqa: E402
from gemheads.models.train.avatars.runs import CHECKPOINT, Run, RunError, open_run, read_checkpoint, read_config  # noqa: E402
from gemheads.models.train.avatars.train_avatar import Outcome, train_avatar  # noqa: E402
from gemheads.models.train.judging.contestants import RunContestant  # noqa: E402

BASELINES: tuple[Model, ...] = ("rigged", "blendshapes")
STILL = np.zeros(3, np.float32)
UP = np.array([0, 0.01, 0], np.float32)
STEPS = 60


@pytest.fixture(scope="module")
def capture(tmp_path_factory: pytest.TempPathFactory) -> Capture:
    return open_capture(toycapture.write_capture(tmp_path_factory.mktemp("toy") / "capture"))


def brief(model: Model, steps: int = STEPS) -> Plan:
    return Plan(32, 4, 2, steps, colors_first=8, checkpoint_every=10, preview_every=30, model=model, shape_rate=0.03)


@pytest.fixture(scope="module")
def trained(capture: Capture, tmp_path_factory: pytest.TempPathFactory) -> dict[Model, tuple[Path, Outcome]]:
    found = {}
    for model in BASELINES:
        folder = tmp_path_factory.mktemp(model)
        found[model] = folder, train_avatar(capture, folder, brief(model))
    return found


@pytest.mark.parametrize("model", BASELINES)
def test_it_learns(capture: Capture, trained: dict[Model, tuple[Path, Outcome]], model: Model, tmp_path: Path) -> None:
    folder, outcome = trained[model]
    rows = np.genfromtxt(folder / "loss.csv", delimiter=",", names=True)
    assert rows["l1"][-6:].mean() < 0.8 * rows["l1"][2:8].mean()  # a round of moments each; first colours alone
    bare = train_avatar(capture, tmp_path, brief(model, 8))
    assert outcome.val_psnr > bare.val_psnr + 1
    assert outcome.test_psnr > bare.test_psnr + 0.5
    assert {path.name for path in (folder / "previews").iterdir()} == {"000030.png", "000060.png"}
    assert (folder / "loss.png").stat().st_size > 1000


@pytest.mark.parametrize("model", BASELINES)
def test_stopped_it_comes_to_the_same(
    capture: Capture, trained: dict[Model, tuple[Path, Outcome]], model: Model, tmp_path: Path
) -> None:
    def stop(stage: str, done: int, total: int) -> None:
        if done == 37:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train_avatar(capture, tmp_path, brief(model), progress=stop)
    assert read_checkpoint(tmp_path)["step"] == 30
    before = read_config(tmp_path).seconds
    assert before > 0
    train_avatar(capture, tmp_path, brief(model))
    assert_identical(tmp_path, trained[model][0])
    assert (tmp_path / "loss.csv").read_bytes() == (trained[model][0] / "loss.csv").read_bytes()
    assert read_config(tmp_path).seconds > before


@pytest.mark.parametrize("model", BASELINES)
def test_it_draws_moments_held_out(capture: Capture, trained: dict[Model, tuple[Path, Outcome]], model: Model) -> None:
    run = open_run(trained[model][0])
    assert run.seconds > 0
    contestant, standin = RunContestant(run), StandIn(capture)
    assert contestant.driven_by == {"rigged": "the tracked mesh", "blendshapes": "the capture's ARKit weights"}[model]
    shots = [shot for shot in capture.test if shot.camera_index == 1]
    images = [contestant.draw(standin, shot, contestant.act(shot, "test")) for shot in shots]
    own = np.mean([psnr(image, standin.truth(shot)) for image, shot in zip(images, shots, strict=True)])
    other = np.mean([psnr(image, standin.truth(shot)) for image, shot in zip(images[::-1], shots, strict=True)])
    assert own > other + 0.5  # of another expression and pose
    gem, distilled = adopt(run_source(run), "toy", components=3)
    assert gem.arkit_weights is not None
    assert distilled.variance_kept["position"][-1] > 0.9


def at(run: Run, vertices: np.ndarray, weights: np.ndarray) -> Any:
    return run.splats(Tracked(vertices.astype(np.float32), STILL, STILL, weights.astype(np.float32)))


def test_rigged_splats_know_nothing_but_the_mesh(capture: Capture, trained: dict[Model, tuple[Path, Outcome]]) -> None:
    run = open_run(trained["rigged"][0])
    rest = capture.template.vertices
    still, weighted = (at(run, rest, np.full(52, weight)) for weight in (0.0, 1.0))
    np.testing.assert_array_equal(still.positions, weighted.positions)
    moved = at(run, rest + UP, np.zeros(52))
    np.testing.assert_allclose(moved.positions, still.positions + UP, atol=1e-6)
    np.testing.assert_array_equal(moved.opacity_logits, still.opacity_logits)
    assert np.abs(still.opacity_logits - run.avatar.opacity_logits.numpy()).max() > 0.1
    assert np.abs(still.positions - run.avatar.rest.numpy()).max() > 1e-4


def test_blendshapes_are_linear_and_know_no_mesh(capture: Capture, trained: dict[Model, tuple[Path, Outcome]]) -> None:
    run = open_run(trained["blendshapes"][0])
    rest = capture.template.vertices
    jaw, brow = np.zeros(52), np.zeros(52)
    jaw[17], brow[2] = 0.7, 0.4  # as the toy has them
    mean, first, second, both = (at(run, rest, weights) for weights in (0 * jaw, jaw, brow, jaw + brow))
    for name in ("positions", "log_scales", "opacity_logits"):
        moved = getattr(first, name) + getattr(second, name) - getattr(mean, name)
        np.testing.assert_allclose(getattr(both, name), moved, atol=1e-4, err_msg=name)
    assert np.abs(first.positions - mean.positions).max() > 1e-3
    np.testing.assert_array_equal(at(run, 1.1 * rest, jaw).positions, first.positions)


def without_arkit(source: Path, folder: Path, timestep: int) -> Capture:
    """The same capture, one mesh of which has no weights."""
    for path in sorted(source.rglob("*")):
        target = folder / path.relative_to(source)
        if path.is_dir():
            target.mkdir(parents=True, exist_ok=True)
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(path.read_bytes())
    mesh = folder / "meshes" / f"{timestep:05d}.npz"
    with np.load(mesh) as arrays:
        kept = {name: arrays[name] for name in arrays.files if name != "arkit"}
    np.savez(mesh, **kept)
    return open_capture(folder)


def test_without_weights_the_cure_is_told(
    capture: Capture, trained: dict[Model, tuple[Path, Outcome]], tmp_path: Path
) -> None:
    silent = without_arkit(capture.folder, tmp_path / "silent", 7)
    with pytest.raises(CaptureError, match=r"00007\.npz: has no ARKit weights.*--model rigged"):
        train_avatar(silent, tmp_path / "run", brief("blendshapes"))
    assert not (tmp_path / "run").exists()
    with pytest.raises(CaptureError, match="store arkit"):
        open_run(trained["blendshapes"][0], silent.folder)
    assert train_avatar(silent, tmp_path / "run", brief("rigged", 2)).steps == 2


def test_models_are_not_mixed_up(capture: Capture, trained: dict[Model, tuple[Path, Outcome]], tmp_path: Path) -> None:
    folder = trained["rigged"][0]
    with pytest.raises(RunError, match="other settings"):
        train_avatar(capture, folder, brief("blendshapes"))
    for name in ("config.json", CHECKPOINT):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    rewritten(tmp_path, lambda told: told["plan"].update(model="blendshapes"))
    with pytest.raises(RunError, match="does not fit"):
        open_run(tmp_path)


def test_a_config_from_before_is_a_cnn(capture: Capture, tmp_path: Path) -> None:
    plan = Plan(32, 4, 2, steps=2, colors_first=1)
    train_avatar(capture, tmp_path, plan)

    def older(told: dict[str, Any]) -> None:
        del told["seconds"], told["plan"]["model"], told["plan"]["shape_rate"]

    rewritten(tmp_path, older)
    run = open_run(tmp_path)
    assert (run.avatar.title, run.seconds) == ("CNN", None)
    assert train_avatar(capture, tmp_path, plan).steps == 2


def rewritten(folder: Path, change: Callable[[dict[str, Any]], None]) -> None:
    told = json.loads((folder / "config.json").read_text())
    change(told)
    (folder / "config.json").write_text(json.dumps(told))


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("model", "gan", "'gan' is none of cnn, rigged, blendshapes"),
        ("model", ["cnn"], "is none of cnn"),
        ("size", 100, "cannot be halved"),
        ("size", 1 << 20, "no whole number within 1..1024"),
        ("size", "128", "is no number"),
        ("levels", 9, "cannot be halved 9 times"),
        ("width", 10**6, "within 1..512"),
        ("steps", 0, "within 1"),
        ("steps", 1.5, "no whole number"),
        ("views", True, "is no number"),
        ("seed", -1, "within 0"),
        ("perceptual_side", 0, "within 1"),
        ("shape_rate", float("nan"), "not within 0..1000"),
        ("shape_rate", 10**400, "cannot be understood"),
        ("focus", -1, "not within"),
        ("horses", 4, "unexpected keyword"),
    ],
)
def test_a_config_that_no_program_wrote_is_refused(
    trained: dict[Model, tuple[Path, Outcome]], tmp_path: Path, name: str, value: object, said: str
) -> None:
    (tmp_path / "config.json").write_bytes((trained["rigged"][0] / "config.json").read_bytes())
    rewritten(tmp_path, lambda told: told["plan"].update({name: value}))
    with pytest.raises(RunError, match=r"config\.json: cannot be understood") as caught:
        read_config(tmp_path)
    assert said in str(caught.value)


@pytest.mark.parametrize("seconds", [-1, "soon", [], float("inf")])
def test_seconds_that_were_never_spent(
    trained: dict[Model, tuple[Path, Outcome]], tmp_path: Path, seconds: object
) -> None:
    (tmp_path / "config.json").write_bytes((trained["rigged"][0] / "config.json").read_bytes())
    rewritten(tmp_path, lambda told: told.update(seconds=seconds))
    with pytest.raises(RunError, match="cannot be understood"):
        read_config(tmp_path)
