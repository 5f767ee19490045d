import socket
import sys
from types import SimpleNamespace

import pytest
from gemheads.app import doctor_live, inputs
from gemheads.app.doctor import Finding
from gemheads.app.doctor_live import examine_live
from gemheads.app.inputs import CameraChoice
from gemheads.app.senders import loopback
from gemheads.app.senders.loopback import Loopback

pytestmark = pytest.mark.enable_socket
"""The ports are probed, on this machine only."""


def found() -> dict[str, Finding]:
    return {finding.what: finding for finding in examine_live()}


@pytest.fixture(autouse=True)
def no_display(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tests look the same on a desktop and without one."""
    monkeypatch.setattr("gemheads.app.machine.has_display", lambda: False)


def test_what_is_missing_comes_with_its_cure_and_stops_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(inputs, "cameras", list)
    monkeypatch.setattr(loopback, "loopbacks", list)
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    monkeypatch.setitem(sys.modules, "imgui_bundle", None)
    findings = found()
    assert "Plug one in." in findings["camera"].cure
    assert "usermod -aG video" in findings["camera"].cure
    assert "modprobe v4l2loopback" in findings["virtual camera"].cure
    assert findings["microphone"].cure == "run pip install gemheads[mic]"
    assert findings["panels"].cure == "pip install imgui-bundle"
    assert "DISPLAY" in findings["display"].cure
    for finding in findings.values():
        assert finding.works or (finding.cure and not finding.needed)


def test_what_is_there_is_called_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(inputs, "cameras", lambda: [CameraChoice("Integrated Camera", 0, "/dev/video0")])
    monkeypatch.setattr(loopback, "loopbacks", lambda: [Loopback(loopback.DEVICES / "video9", "gemheads")])
    module = SimpleNamespace(query_devices=lambda kind: {"name": f"a good {kind}"})
    monkeypatch.setitem(sys.modules, "sounddevice", module)  # pyright: ignore[reportArgumentType]
    findings = found()
    assert findings["camera"].detail == "Integrated Camera (/dev/video0)"
    assert findings["virtual camera"].detail == "gemheads (/dev/video9)"
    assert findings["microphone"].detail == "a good input"
    assert all(findings[name].works for name in ("camera", "virtual camera", "microphone"))


def test_a_microphone_that_the_system_hides_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(kind: str) -> None:
        raise ValueError(f"Error querying device -1 ({kind})")

    module = SimpleNamespace(query_devices=refuse)
    monkeypatch.setitem(sys.modules, "sounddevice", module)  # pyright: ignore[reportArgumentType]
    finding = doctor_live._microphone()
    assert (finding.works, finding.detail) == (False, "Error querying device -1 (input)")
    assert finding.cure.startswith("plug one in")


def test_the_networks_run_on_what_was_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    finding = doctor_live._provider()
    assert finding.works
    assert finding.detail == "requested: CPUExecutionProvider; active: CPUExecutionProvider"
    monkeypatch.setattr("gemheads.models.driver.face.FaceTracker.providers", ("OtherExecutionProvider",))
    other = doctor_live._provider()
    assert not other.works
    assert other.detail == "requested: CPUExecutionProvider; active: OtherExecutionProvider"


def test_a_port_in_use_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
        monkeypatch.setattr("gemheads.app.inputs.oscin.PORTS", {"osc": port})
        (finding,) = doctor_live._face_data()
        assert not finding.works
        assert "or choose another: osc:PORT" in finding.cure
    (finding,) = doctor_live._face_data()
    assert (finding.works, finding.detail) == (True, "free")
