"""A disk too full to keep what numba compiles: it is compiled all the same."""

import errno
import os

import numpy as np
import pytest
from gemheads.app import export
from gemheads.app.errors import ExitCode
from gemheads.render import software
from gemheads.render.camera import orbit
from gemheads.render.gaussians import RawGaussians
from gemheads.render.software import SoftwareEngine
from refusals import refused


def full(*_: object, **__: object) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


class Unkept:
    """A kernel that is ready before it fails to be kept, as numba's are."""

    def __init__(self, kernel: object) -> None:
        self.kernel, self.tried = kernel, 0

    def compile(self, types: tuple[object, ...]) -> None:
        self.tried += 1
        self.kernel.compile(types)  # type: ignore[attr-defined]
        full()

    def __call__(self, *arguments: object) -> object:
        return self.kernel(*arguments)  # type: ignore[operator]


def test_an_engine_is_warm_and_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    unkept = Unkept(software._rasterise)
    monkeypatch.setattr(software, "_rasterise", unkept)
    engine = SoftwareEngine()
    engine.warm()
    assert unkept.tried == 1
    ball = RawGaussians(
        np.zeros((1, 3), np.float32),
        np.float32([[1, 0, 0, 0]]),
        np.log(np.full((1, 3), 0.1, np.float32)),
        np.float32([4]),
        np.float32([[1, 0.5, 0]]),
    )
    picture = engine.draw(ball, orbit((0.0, 0.0, 0.0), 1.0, 0, 0, 30, 16, 16))
    assert picture[8, 8, 3] > 0.9


def test_a_command_says_that_a_disk_is_full(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path
) -> None:
    monkeypatch.setattr(export, "export_expression", full)
    code, error = refused(capsys, "export", "mara", "-o", tmp_path / "a.ply")
    assert code == ExitCode.OUTPUT
    assert error.startswith("error: a disk is full: make room")
