import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import av
import numpy as np
import pytest
from gemheads.app.errors import OutputError
from gemheads.app.senders import microphone
from gemheads.app.senders.microphone import RATE, Microphone
from gemheads.app.senders.outlet import Shown
from gemheads.app.senders.recording import Recording

TONE = 0.3 * np.sin(np.arange(RATE * 3) * 2 * np.pi * 440 / RATE).astype(np.float32)


class Ear:
    """Stands for the module sounddevice and for the clock: what is heard is put in by hand."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        monkeypatch.setitem(sys.modules, "sounddevice", self)  # pyright: ignore[reportArgumentType]
        monkeypatch.setattr(microphone, "time", SimpleNamespace(perf_counter=lambda: self.now))
        self.calls: list[str] = []

    def InputStream(self, callback: Any, **settings: Any) -> "Ear":
        self.callback, self.settings = callback, settings
        return self

    def start(self) -> None:
        self.calls.append("start")

    def stop(self) -> None:
        self.calls.append("stop")

    def close(self) -> None:
        self.calls.append("close")

    def hear(self, samples: np.ndarray) -> None:
        for start in range(0, len(samples), 960):
            block = samples[start : start + 960]
            self.now += len(block) / RATE
            self.callback(block[:, None], len(block), None, None)


def heard(path: Path) -> np.ndarray:
    with av.open(str(path)) as container:
        return np.concatenate([frame.to_ndarray()[0] for frame in container.decode(audio=0)])


@pytest.fixture
def ear(monkeypatch: pytest.MonkeyPatch) -> Ear:
    return Ear(monkeypatch)


def record(ear: Ear, path: Path, gap: float = 0.0) -> None:
    """A second of tone before the first picture, then a second beside pictures, with ``gap`` seconds lost halfway."""
    recording = Recording(path, (64, 48), 30, microphone=Microphone())
    ear.hear(TONE[:RATE])
    start = ear.now
    recording.send(Shown(np.zeros((48, 64, 3), np.uint8), start))
    ear.hear(TONE[: RATE // 2])
    ear.now += gap
    ear.hear(TONE[: RATE // 2])
    recording.send(Shown(np.zeros((48, 64, 3), np.uint8), start + 1.0))
    recording.close()


@pytest.mark.parametrize("name", ["out.mp4", "out.mov", "out.webm"])
def test_sound_begins_with_the_first_picture(ear: Ear, tmp_path: Path, name: str) -> None:
    record(ear, tmp_path / name)
    sound = heard(tmp_path / name)
    assert len(sound) == pytest.approx(RATE, rel=0.06)
    assert np.sqrt(np.mean(sound[: RATE // 2] ** 2)) == pytest.approx(0.3 / np.sqrt(2), rel=0.1)
    assert ear.calls == ["start", "stop", "close"]
    assert ear.settings["channels"] == 1


def test_lost_sound_becomes_silence_so_that_the_rest_stays_in_time(ear: Ear, tmp_path: Path) -> None:
    record(ear, tmp_path / "out.mp4", gap=0.4)
    sound = heard(tmp_path / "out.mp4")
    assert len(sound) == pytest.approx(1.4 * RATE, rel=0.05)
    assert np.abs(sound[round(0.6 * RATE) : round(0.8 * RATE)]).max() < 0.02
    assert np.abs(sound[round(1.0 * RATE) : round(1.3 * RATE)]).max() > 0.2


def test_garbage_from_a_driver_ends_no_recording(ear: Ear, tmp_path: Path) -> None:
    recording = Recording(tmp_path / "out.mp4", (64, 48), 30, microphone=Microphone())
    recording.send(Shown(np.zeros((48, 64, 3), np.uint8), ear.now))
    ear.hear(np.full(RATE // 4, np.nan, np.float32))
    ear.hear(np.full(RATE // 4, 1e30, np.float32))
    recording.send(Shown(np.zeros((48, 64, 3), np.uint8), ear.now))
    recording.close()
    sound = heard(tmp_path / "out.mp4")
    assert np.isfinite(sound).all()
    assert np.abs(sound[: RATE // 5]).max() < 0.05


def test_no_sound_heard_leaves_a_video_that_plays(ear: Ear, tmp_path: Path) -> None:
    recording = Recording(tmp_path / "out.mp4", (64, 48), 30, microphone=Microphone())
    recording.send(Shown(np.zeros((48, 64, 3), np.uint8), 0.0))
    recording.close()
    with av.open(str(tmp_path / "out.mp4")) as container:
        assert len(list(container.decode(video=0))) == 1


def test_a_recording_that_cannot_begin_lets_the_microphone_go(ear: Ear, tmp_path: Path) -> None:
    (tmp_path / "out.mp4").touch()
    with pytest.raises(OutputError, match="never overwrites"):
        Recording(tmp_path / "out.mp4", (64, 48), 30, microphone=Microphone())
    assert ear.calls == ["start", "stop", "close"]


def test_no_device_is_one_plain_sentence(ear: Ear, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> None:
        raise RuntimeError("Error querying device -1")

    monkeypatch.setattr(ear, "start", refuse)
    with pytest.raises(OutputError, match=r"^no microphone: Error querying device -1; plug one in"):
        Microphone()
