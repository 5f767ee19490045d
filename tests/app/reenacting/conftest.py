"""What `reenact` and `track` are given."""

from pathlib import Path

import pytest

from ..clips import VARIABLE, cut_clip


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    return cut_clip(tmp_path / "talk.mp4", VARIABLE)
