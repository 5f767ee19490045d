import pytest
from gemheads.app import doctor
from gemheads.app.doctor import run_doctor
from gemheads.app.errors import ExitCode, OutputError
from gemheads.app.finding import Finding


def told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *findings: Finding) -> tuple[int, str]:
    monkeypatch.setattr(doctor, "examine", lambda: iter(findings))
    return run_doctor(), capsys.readouterr().out


def test_a_healthy_machine(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    optional = Finding("display", False, "none", needed=False)
    code, text = told(monkeypatch, capsys, Finding("Python", True, "3.11", "not shown"), optional)
    assert code == ExitCode.OK
    assert "ok   Python: 3.11" in text
    assert "none display: none" in text
    assert "not shown" not in text


def test_what_is_needed_and_missing_comes_with_its_cure(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code, text = told(monkeypatch, capsys, Finding("avatars", False, "none", "make avatars"))
    assert code == ExitCode.UNEXPECTED
    assert "FAIL avatars: none\n     cure: make avatars" in text


@pytest.mark.enable_socket
def test_a_check_that_fails_does_not_stop_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    """The real examination, whatever it finds on this machine, but for one check."""

    def torn() -> str:
        raise RuntimeError("torn")

    monkeypatch.setattr(doctor, "_networks", torn)
    findings = {finding.what: finding for finding in doctor.examine()}
    names = list(findings)
    assert names[0] == "Python"
    assert {"engine software", "onnxruntime", "video to .mp4", "demo clip", "display"} <= set(names)
    failed = findings["face networks"]
    assert (failed.works, failed.needed, failed.detail) == (False, True, "RuntimeError: torn")
    assert names.index("face networks") < names.index("video to .mp4")
    assert all(finding.cure for finding in findings.values() if not finding.works)


def test_what_says_its_own_cure_is_told_with_that(monkeypatch: pytest.MonkeyPatch) -> None:
    def damaged() -> str:
        raise OutputError("key.pem: holds no signing key; delete it, and the next result makes a new one")

    finding = doctor._tried("content credentials", damaged, "pip install it", needed=False)
    assert finding.detail == "key.pem: holds no signing key"
    assert finding.cure == "delete it, and the next result makes a new one"
