"""Which camera a word means."""

import pytest
from devices import Device, blue
from gemheads.app.desk import sources
from gemheads.app.desk.sources import camera_named
from gemheads.app.inputs import CameraChoice, open_camera
from gemheads.app.inputs.source import SourceLost


@pytest.fixture
def connected(monkeypatch: pytest.MonkeyPatch) -> list[CameraChoice]:
    """Two cameras, until a test unplugs them."""
    found = [CameraChoice("Built-in", 0), CameraChoice("Logi C920", 2)]
    monkeypatch.setattr(sources, "cameras", lambda: found)

    def opened(choice: CameraChoice) -> object:
        return open_camera(choice, connected=lambda: found, open_device=lambda _: Device(blue))

    monkeypatch.setattr(sources, "open_camera", opened)
    return found


@pytest.mark.parametrize(
    ("word", "name"),
    [
        ("", "Built-in"),
        ("Logi C920", "Logi C920"),
        ("logi", "Logi C920"),
        ("Logi C920, 640x360 at 30 frames/s", "Logi C920"),  # as live.toml once had it
    ],
)
def test_a_camera_is_meant_by_its_name_a_part_of_it_or_none(
    word: str, name: str, connected: list[CameraChoice]
) -> None:
    camera = camera_named(word)()
    camera.close()
    assert camera.name == name


def test_a_name_that_no_camera_has_tells_those_there_are(connected: list[CameraChoice]) -> None:
    with pytest.raises(SourceLost, match="no camera called Other") as raised:
        camera_named("Other")()
    assert raised.value.cure == "Choose one of: Built-in, Logi C920."
    connected.clear()
    with pytest.raises(SourceLost, match="There is no camera"):
        camera_named("Other")()


def test_no_other_camera_is_opened_in_the_place_of_one_that_was_unplugged(connected: list[CameraChoice]) -> None:
    opener = camera_named("")
    opener().close()
    unplugged = connected.pop(0)
    with pytest.raises(SourceLost, match="Built-in is not connected"):
        opener()
    connected.append(unplugged)
    camera = opener()
    camera.close()
    assert camera.name == "Built-in"
