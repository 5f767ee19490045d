"""What `gemheads live` does after its window was closed."""

import signal
import threading
from pathlib import Path

import pytest
from gemheads.app.desk import command
from gemheads.app.desk.command import await_files, live_command
from gemheads.app.desk.farewell import ENDING, farewell
from gemheads.app.desk.outputs import Outputs
from gemheads.app.desk.wish import LiveWish
from gemheads.app.errors import InputError
from keepers import Keeper
from waiting import SOON


class Signing(Keeper):
    """A recording whose last moment takes as long as it is told to."""

    def __init__(self, go_on: threading.Event) -> None:
        super().__init__()
        self.go_on = go_on

    def close(self) -> None:
        self.closed = self.go_on.wait(SOON)


def closed(recording: Signing) -> Outputs:
    outputs = Outputs((96, 96), 30, Path)
    outputs.fan.start("Recording", lambda: recording, filing=True)
    outputs.fan.close(0.05)
    return outputs


@pytest.mark.parametrize("name", ENDING)
def test_what_ends_programs_asks_the_window_to_quit(name: str) -> None:
    number, asked = getattr(signal, name), []
    outside = signal.signal(number, signal.SIG_DFL)  # whoever runs the tests may ignore it
    try:
        with farewell(lambda: asked.append(name)):
            signal.raise_signal(number)
        assert asked == [name]
        assert signal.getsignal(number) == signal.SIG_DFL
    finally:
        signal.signal(number, outside)


@pytest.mark.parametrize("words", [{"avatar": "broken.gem"}, {"driver": "broken.gem"}], ids=["avatar", "driver"])
def test_an_avatar_that_is_none_is_refused_before_a_window_opens(
    words: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "broken.gem").write_bytes(b"no avatar")
    monkeypatch.setattr(command, "DeskWindow", lambda size: pytest.fail("a window was opened"))
    with pytest.raises(InputError, match=r"broken\.gem"):
        live_command(LiveWish(**{name: str(tmp_path / word) for name, word in words.items()}))


def test_a_recording_that_is_being_signed_is_waited_for_aloud(capsys: pytest.CaptureFixture[str]) -> None:
    recording = Signing(threading.Event())
    outputs = closed(recording)
    threading.Timer(0.1, recording.go_on.set).start()
    await_files(outputs, SOON)
    assert recording.closed
    assert capsys.readouterr().err == "The recording is being finished ...\n"
    await_files(outputs)
    assert capsys.readouterr().err == ""


def test_a_disk_that_hangs_is_not_waited_for_without_end(capsys: pytest.CaptureFixture[str]) -> None:
    recording = Signing(threading.Event())
    await_files(closed(recording), 0.05)
    assert "not finished" in capsys.readouterr().err
    recording.go_on.set()
