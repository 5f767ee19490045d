"""Files to sign, and somebody to sign them."""

from fractions import Fraction
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.credentials.localkey import local_key
from gemheads.app.credentials.origin import Origin
from gemheads.app.credentials.signing import Signer
from gemheads.app.credentials.statement import Driver, Statement
from gemheads.app.files.sinks import VideoSink

STATEMENT = Statement(
    (Origin("ada", "ab" * 32, "a sculptor", "CC-BY-4.0", "Ada, for this test"),), Driver("video", "cd" * 32)
)


@pytest.fixture(scope="session")
def signer(tmp_path_factory: pytest.TempPathFactory) -> Signer:
    """With a key of its own."""
    pytest.importorskip("c2pa", reason="the extra gemheads[credentials] is not installed")
    return Signer(local_key(tmp_path_factory.mktemp("key") / "key.pem"))


def write_file(path: Path) -> Path:
    """A picture or a video of noise."""
    noise = np.random.default_rng(1).integers(0, 256, (24, 48, 64, 3), np.uint8)
    if path.suffix in (".png", ".jpg"):
        assert cv2.imwrite(str(path), noise[0])
        return path
    sink = VideoSink(path, (64, 48), Fraction(1, 30), Fraction(30), False, None)
    for index, image in enumerate(noise):
        sink.write(index, image, index)
    sink.close(whole=True)
    return path
