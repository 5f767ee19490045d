import os
import signal
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from gemheads.app.errors import OutputError, UsageError
from gemheads.app.files.video import VideoFile
from gemheads.app.senders.outlet import Marks, Shown
from gemheads.app.senders.recording import Recording, open_recording, recording_in, recording_name
from gemheads.render.arrays import Image

SIZE = (96, 64)


def picture(red: int, size: tuple[int, int] = SIZE, alpha: int | None = None) -> Image:
    image = np.full((size[1], size[0], 3 if alpha is None else 4), (red, 90, 40, alpha)[: 3 if alpha is None else 4])
    return image.astype(np.uint8)


def record(path: Path, times: list[float], transparent: bool = False, alpha: int | None = None) -> Recording:
    recording = Recording(path, SIZE, 30, transparent)
    for time in times:
        recording.send(Shown(picture(200, alpha=alpha), time))
    recording.close()
    return recording


def read(path: Path) -> tuple[list[float], list[Image]]:
    with av.open(str(path)) as container:
        frames = list(container.decode(video=0))
    return [float(frame.pts * frame.time_base) for frame in frames], [
        frame.to_ndarray(format="rgb24") for frame in frames
    ]


def test_pictures_keep_the_times_of_the_wall_clock(tmp_path: Path) -> None:
    shown = [100.0, 100.04, 100.2, 101.0]
    recording = record(tmp_path / "out.mp4", shown)
    times, images = read(tmp_path / "out.mp4")
    assert times == pytest.approx([0.0, 0.04, 0.2, 1.0], abs=1e-4)
    assert np.abs(images[0][32, 48].astype(int) - (200, 90, 40)).max() <= 6
    assert recording.status.startswith(f"saved {tmp_path / 'out.mp4'}: 1.0 s, 0.")


def test_what_becomes_transparent_keeps_its_ground_in_a_file_without_alpha(tmp_path: Path) -> None:
    recording = Recording(tmp_path / "out.mp4", SIZE, 30)
    ground = Marks(ground=(20, 160, 90), no_badge="a test")
    for number, shown in enumerate((picture(200), picture(200, alpha=0))):
        recording.send(Shown(shown, number / 10, marks=ground))
    recording.close()
    _, images = read(tmp_path / "out.mp4")
    assert np.abs(images[1][32, 48].astype(int) - ground.ground).max() <= 6


def test_a_fast_window_does_not_make_a_larger_file(tmp_path: Path) -> None:
    record(tmp_path / "out.mp4", [number / 120 for number in range(121)])
    times, _ = read(tmp_path / "out.mp4")
    assert 30 <= len(times) <= 32
    assert min(np.diff(times)) > 0.6 / 30


def test_at_its_own_rate_no_picture_is_lost_however_unevenly_they_come(tmp_path: Path) -> None:
    late = np.random.default_rng(0).uniform(0, 0.030, 121)
    record(tmp_path / "out.mp4", [number / 30 + float(late[number]) for number in range(121)])
    assert len(read(tmp_path / "out.mp4")[0]) >= 118


def test_the_size_stays_while_the_window_is_resized(tmp_path: Path) -> None:
    recording = Recording(tmp_path / "out.mp4", (97, 65), 30)
    for number, size in enumerate([(97, 65), (300, 64), (48, 32), (33, 77)]):
        recording.send(Shown(picture(220, size), number / 10))
    recording.close()
    _, images = read(tmp_path / "out.mp4")
    assert [image.shape for image in images] == [(64, 96, 3)] * 4
    assert images[1][2, 48].max() < 20  # a wide window: black above and below
    assert images[3][32, 2].max() < 20  # a tall one: black on both sides
    assert all(image[32, 48, 0] > 200 for image in images)


KILLED = """
import sys, time
from pathlib import Path
import numpy as np
from gemheads.app.senders.outlet import Shown
from gemheads.app.senders.recording import Recording

recording = Recording(Path(sys.argv[1]), (96, 64), 30)
for number in range(150):
    recording.send(Shown(np.full((64, 96, 3), number, np.uint8), number / 30))
print("written", flush=True)
time.sleep(60)
"""


def test_a_killed_program_leaves_a_file_that_plays(tmp_path: Path) -> None:
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path / "out.mp4")], stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stdout.readline().strip() == b"written"
    process.kill()
    process.wait()
    process.stdout.close()
    assert process.returncode == -signal.SIGKILL
    assert not (tmp_path / "out.mp4").exists()
    times, images = read(tmp_path / "out.partial.mp4")
    assert len(times) >= 90  # of five seconds, the last two may be on their way
    assert times[60] == pytest.approx(2.0, abs=1e-3)
    assert abs(int(images[60][32, 48, 0]) - 60) <= 6


@pytest.mark.parametrize("suffix", [".mov", ".webm"])
def test_transparent_videos_keep_their_alpha(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"out{suffix}"
    record(path, [0.0, 0.1, 0.2], transparent=True, alpha=128)
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        if suffix == ".webm":  # ffmpeg's own decoder passes alpha by, libvpx reads it
            decoder = av.CodecContext.create("libvpx-vp9", "r")
            frames = [frame for packet in container.demux(stream) if packet.size for frame in decoder.decode(packet)]
        else:
            frames = list(container.decode(stream))
    rgba = frames[0].to_ndarray(format="rgba")
    assert len(frames) == 3
    assert np.abs(rgba[32, 48].astype(int) - (200, 90, 40, 128)).max() <= 8


def test_a_name_without_suffix_is_a_folder_of_transparent_pngs(tmp_path: Path) -> None:
    record(tmp_path / "pictures", [5.0, 5.1], transparent=True, alpha=77)
    files = sorted(file.name for file in (tmp_path / "pictures").iterdir())
    assert files == ["frame_000000.png", "frame_000001.png", "times.csv"]
    image = cv2.imread(str(tmp_path / "pictures" / files[0]), cv2.IMREAD_UNCHANGED)
    assert image is not None
    assert image[0, 0].tolist() == [40, 90, 200, 77]


def test_what_is_transparent_is_black_in_an_mp4(tmp_path: Path) -> None:
    record(tmp_path / "out.mp4", [0.0], alpha=0)
    assert read(tmp_path / "out.mp4")[1][0][:40].max() < 20  # below is the badge


def test_nothing_recorded_leaves_nothing(tmp_path: Path) -> None:
    assert record(tmp_path / "out.mp4", []).status == "nothing was recorded"
    assert record(tmp_path / "pictures", []).status == "nothing was recorded"
    assert list(tmp_path.iterdir()) == []


def test_an_earlier_recording_is_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "out.mp4").write_bytes(b"precious")
    with pytest.raises(OutputError, match="never overwrites"):
        Recording(tmp_path / "out.mp4", SIZE, 30)
    assert (tmp_path / "out.mp4").read_bytes() == b"precious"


def test_an_mp4_cannot_be_transparent(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot be transparent"):
        Recording(tmp_path / "out.mp4", SIZE, 30, transparent=True)


FULL = """
import resource, signal, sys
from pathlib import Path
import numpy as np
from gemheads.app.senders.fan import Fan
from gemheads.app.senders.outlet import Shown
from gemheads.app.senders.recording import Recording

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000))  # from here on the disk is full after 400 kB
rng = np.random.default_rng(0)
fan = Fan()
fan.start("recording", lambda: Recording(Path(sys.argv[1]), (320, 240), 30), depth=1000)
for number in range(120):
    fan.offer(rng.integers(0, 255, (240, 320, 3), np.uint8), number / 30)
fan.close(60)
print(fan.reports()[0].phase, fan.reports()[0].text)
"""


def test_a_full_disk_keeps_the_file_and_is_told(tmp_path: Path) -> None:
    command = [sys.executable, "-c", FULL, str(tmp_path / "out.mp4")]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert said.startswith(f"failed {tmp_path / 'out.partial.mp4'}: no space left; the ")
    assert not (tmp_path / "out.mp4").exists()
    assert len(list(VideoFile(tmp_path / "out.partial.mp4").frames())) > 0


def test_names_are_of_the_moment_and_not_taken(tmp_path: Path) -> None:
    now = datetime(2026, 3, 4, 5, 6, 7)
    first = recording_name(tmp_path, False, now)
    assert first.name == "gemheads-2026-03-04-050607.mp4"
    first.with_name("gemheads-2026-03-04-050607.partial.mp4").touch()  # one that was killed
    assert recording_name(tmp_path, False, now).name == "gemheads-2026-03-04-050607-2.mp4"
    assert recording_name(tmp_path, True, now).suffix == ".mov"


def test_two_windows_of_one_second_record_into_two_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = recording_in(tmp_path, SIZE, 30)
    names = iter([first.path, tmp_path / "next.mp4"])  # the second looked before the first had begun
    monkeypatch.setattr("gemheads.app.senders.recording.recording_name", lambda *_: next(names))
    second = recording_in(tmp_path, SIZE, 30)
    for recording, count in ((first, 2), (second, 3)):
        for number in range(count):
            recording.send(Shown(picture(90), number / 30))
        recording.close()
        assert len(read(recording.path)[0]) == count


def test_a_folder_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match=f"file{os.sep}out.partial.mp4: cannot be written"):
        Recording(tmp_path / "file" / "out.mp4", SIZE, 30)


def test_without_the_extra_a_recording_goes_on_without_sound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    recording = open_recording(tmp_path / "out.mp4", SIZE, 30, microphone=True)
    recording.send(Shown(picture(3), 0.0))
    assert "without sound: no microphone: the extra" in recording.status
    assert "pip install gemheads[mic]" in recording.status
    recording.close()
    assert (tmp_path / "out.mp4").is_file()
