"""Every script of tests/bench still runs, on as little as it takes: what it prints then measures nothing."""

import sys
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import av
import pytest

pytest.importorskip("torch", reason="benches of training need the extra gemheads[train]")

from gemheads.app.cli import main
from gemheads.app.errors import ExitCode
from gemheads.app.library import DEMO_CLIP, find_avatar
from gemheads.models.crossing import poseleak
from gemheads.models.gemfile import load_gem, save_gem
from gems import ball
from refusals import refusal

BENCH = Path(__file__).parent / "bench"
RUN_ELSEWHERE = {"gpu_speed", "results"}
"""By tests/results."""
ONLY_ASKED = {"coverage_fuzz", "soak"}
"""One needs another package, the other minutes: they are asked for --help alone. What soak does, tests/soak does."""
SMALL = {
    "ablations": "{capture} {run} --quick",
    "closed_loop": "{clip} --avatar {mara} --every 1 --components 5 --size 128 --json {out}.json --strip {out}.png",
    "diff_speed": "--runs 1 --oracle-runs 1",
    "distill": "--frames 4 --splats 50 --components 2",
    "film_strip": "{mara} --driver {clip} --seconds 0.2 1 -o {out}.png",
    "fit_speed": "--side 32 --frames 2 {ball}",
    "fuzz": "--inputs 2 --format gem --seed 7",
    "known_faces": "{mara} --drivers {theo} --pictures 6",
    "lag": "{clip}",
    "learning_table": "{capture} --mesh {mesh} --run {run} --distilled {cnn} --refined {cnn} --shots 2 --network none",
    "mouths": "{clip} --avatars {mara} --cache {out}",
    "nodding": "{mara} {theo} --faces 4",
    "pose_leak": "{mara} --heads {mara} --fov 20 --size 128",
    "reread": "{mara} {clip} --every 1 --components 5",
    "resting": "{mara} --steps 1",
    "shapes": "{mara}",
    "sides": "{clip} --heads {mara}",
    "sizes": "{clip} --avatars {mara} --cache {out}",
    "tracker_speed": "{clip} --height 120 --frames 3",
}
SMALLER: dict[str, dict[str, object]] = {
    "diff_speed": {"SCENES": ((50, 16),)},
    "mouths": {"EVERY": 1, "WHOLE": ("jawOpen",), "BARED": -1.0, "SMILING": -1.0, "SHUT": 2.0, "AJAR": (-1.0, 2.0)},
    "resting": {"RESTS": ("mouthSmile",), "GAINS": (), "WANTED": lambda wanted: wanted[-1:]},
    "shapes": {"SHAPES": ("jawOpen",)},
    "sides": {"EVERY": 1, "FEWEST": 3},
    "sizes": {"EVERY": 1, "SIZES": (128,), "SCALES": (1.0,)},
}
"""Constants of theirs, or what becomes of them."""


@pytest.fixture(scope="module")
def places(toy_capture: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """What scripts are given, by name; the clip has each 25th picture of the demo's driver."""
    folder = tmp_path_factory.mktemp("bench")
    found = {"capture": toy_capture, "mara": find_avatar("mara"), "theo": find_avatar("theo")}
    found |= {name: folder / f"{name}.gem" for name in ("ball", "untaught", "mesh", "cnn")}
    found |= {"clip": folder / "clip.mp4", "run": folder / "run", "out": folder / "out"}
    with av.open(DEMO_CLIP) as read, av.open(found["clip"], "w") as written:
        stream = written.add_stream("mpeg4", rate=5, options={"qscale": "2"})
        stream.width, stream.height, stream.pix_fmt = 320, 320, "yuv420p"
        for place, frame in enumerate(read.decode(video=0)):
            if place % 25 == 0:
                picture = frame.reformat(320, 320, "rgb24").to_ndarray()
                written.mux(stream.encode(av.VideoFrame.from_ndarray(picture, "rgb24")))
        written.mux(stream.encode())
    save_gem(ball(), found["ball"])
    save_gem(replace(load_gem(found["mara"]), regressor=None), found["untaught"])
    for words in (
        "distill {capture} -o {mesh} --maps 16 --components 2",
        "train {capture} -o {run} --steps 1 --no-perceptual --maps 64",
        "distill {run} -o {cnn} --components 2",
    ):
        assert main(words.format(**found).split()) == ExitCode.OK
    return found


@pytest.fixture(autouse=True)
def own_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Some keep there what they have tracked."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))


def run(name: str, words: str, monkeypatch: pytest.MonkeyPatch) -> int | None:
    """A script with these words; its exit code, if it says one."""
    script = opened(name, monkeypatch)
    for constant, value in SMALLER.get(name, {}).items():
        monkeypatch.setattr(script, constant, value(getattr(script, constant)) if callable(value) else value)
    monkeypatch.setattr(poseleak, "SIDE_STEPS", 1)
    monkeypatch.setattr(poseleak, "ROUND_STEPS", 2)
    monkeypatch.setattr(sys, "argv", [name, *words.split()])
    return script.main()


def opened(name: str, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A script, imported."""
    spec = spec_from_file_location(f"bench_{name}", BENCH / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    script = module_from_spec(spec)
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setitem(sys.modules, script.__name__, script)
    spec.loader.exec_module(script)
    return script


@pytest.mark.parametrize("name", sorted(SMALL))
def test_a_script_runs(
    name: str, places: dict[str, Path], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert not run(name, SMALL[name].format(**places), monkeypatch)
    assert "nan" not in capsys.readouterr().out


@pytest.mark.parametrize("name", sorted(ONLY_ASKED))
def test_a_script_says_what_it_takes(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        run(name, "--help", monkeypatch)
    assert left.value.code == 0
    assert "--seed" in capsys.readouterr().out


def test_no_script_is_forgotten() -> None:
    assert {path.stem for path in BENCH.glob("*.py")} == {*SMALL, *ONLY_ASKED, *RUN_ELSEWHERE}


def test_an_avatar_without_a_regressor_gives_no_strip(
    places: dict[str, Path], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    words = "{untaught} --driver {clip} --seconds 0.2 -o {out}.jpg".format(**places)
    assert run("film_strip", words, monkeypatch) == ExitCode.INPUT
    assert "untaught.gem: has no regressor" in refusal(capsys.readouterr().err)


def test_an_avatar_without_a_regressor_gives_no_smile_back(
    places: dict[str, Path], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run("mouths", "{clip} --avatars {untaught} --cache {out}".format(**places), monkeypatch)
    assert capsys.readouterr().out.splitlines()[-1] == "| mara | - | - | - |"
