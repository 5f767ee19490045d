"""Badge and credentials of what the live window writes and sends."""

from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from gemheads.app.credentials.badge import badged
from gemheads.app.credentials.origin import Origin
from gemheads.app.credentials.reading import read_credentials
from gemheads.app.senders.outlet import Marks, Shown
from gemheads.app.senders.recording import Recording
from gemheads.app.senders.snapshot import Snapshot
from gemheads.app.senders.virtualcamera import VirtualCamera
from gemheads.render.arrays import Image

WHY = "a test that wants to see it bare"
ORIGINS = {
    key: Origin(name, key, licence="CC0-1.0", consent=f"{name} said yes") for key, name in (("a", "ada"), ("b", "bo"))
}
PICTURE = np.full((96, 128, 3), (60, 120, 90), np.uint8)


def shown(at: float, avatar: str = "a", no_badge: str = "", camera_badge: bool = False) -> Shown:
    PICTURE.flags.writeable = False
    return Shown(PICTURE, at, None, avatar, Marks(no_badge, camera_badge, origins=ORIGINS))


def pictures(path: Path) -> list[np.ndarray]:
    with av.open(str(path)) as container:
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]


def has_badge(picture: np.ndarray) -> bool:
    return bool(picture[72:, 40:].max() > 220)


def test_a_recording_is_badged_but_where_a_reason_says_no_and_tells_all_its_faces(tmp_path: Path) -> None:
    recording = Recording(tmp_path / "out.mp4", (128, 96), 30)
    for shot in (shown(0.0), shown(0.1, no_badge=WHY), shown(0.2, "b")):
        recording.send(shot)
    recording.close()
    assert [has_badge(picture) for picture in pictures(tmp_path / "out.mp4")] == [True, False, True]
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    assert recording.status.endswith(", signed")
    verdict = read_credentials(tmp_path / "out.mp4")
    assert verdict.state == "intact"
    assert verdict.own
    assert verdict.ours is not None
    assert [avatar["consent"] for avatar in verdict.ours["avatars"]] == ["ada said yes", "bo said yes"]
    assert verdict.ours["badge"] == {"drawn": False, "reason": WHY}
    assert verdict.ours["driver"] == {"kind": "live"}


def test_recorded_pngs_are_signed_each(tmp_path: Path) -> None:
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    recording = Recording(tmp_path / "out", (128, 96), 30)
    recording.send(shown(0.0))
    recording.close()
    verdict = read_credentials(tmp_path / "out" / "frame_000000.png")
    assert verdict.state == "intact"
    assert verdict.ours is not None
    assert verdict.ours["avatars"][0]["name"] == "ada"


@pytest.mark.parametrize("why", ["", WHY])
def test_a_saved_picture_is_badged_and_signed(why: str, tmp_path: Path) -> None:
    outlet = Snapshot(tmp_path, PICTURE.shape[1::-1])
    outlet.send(shown(0.0, no_badge=why))
    (path,) = tmp_path.iterdir()
    image = cv2.imread(str(path))
    assert image is not None
    assert np.array_equal(image[..., ::-1], PICTURE if why else badged(PICTURE))
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    verdict = read_credentials(path)
    assert verdict.state == "intact"
    assert verdict.ours is not None
    assert verdict.ours["badge"] == ({"drawn": False, "reason": why} if why else {"drawn": True})


def test_the_virtual_camera_is_badged_only_when_chosen() -> None:
    class Device:
        name = "nothing"

        def __init__(self) -> None:
            self.sent: list[Image] = []

        def send(self, rgb: Image) -> None:
            self.sent.append(rgb.copy())

        def close(self) -> None:
            pass

    device = Device()
    camera = VirtualCamera(device, (128, 96))
    for chosen in (False, True):
        camera.send(shown(0.0, camera_badge=chosen))
    assert [has_badge(picture) for picture in device.sent] == [False, True]


def test_without_the_extra_a_recording_is_what_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "c2pa", None)
    recording = Recording(tmp_path / "out.mp4", (128, 96), 30)
    recording.send(shown(0.0))
    recording.close()
    assert recording.status.startswith("saved ")
    assert "signed" not in recording.status
    assert b"c2pa" not in (tmp_path / "out.mp4").read_bytes()
