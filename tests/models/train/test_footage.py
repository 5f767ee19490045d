"""What learning sees of a video is what driving sees of it."""

from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from gemheads.models.train import footage
from numpy.typing import NDArray

PICTURE = np.zeros((64, 96, 3), np.uint8)
PICTURE[:32, :48] = 200


class Watching:
    """A face tracker that sees no face and keeps what it was shown."""

    def __init__(self) -> None:
        self.shown: list[NDArray[np.uint8]] = []

    def track(self, rgb: NDArray[np.uint8]) -> None:
        self.shown.append(rgb)


@pytest.fixture
def watching(monkeypatch: pytest.MonkeyPatch) -> Watching:
    tracker = Watching()
    monkeypatch.setattr(footage, "FaceTracker", lambda: tracker)
    return tracker


def clip(path: Path, image: NDArray[np.uint8], rotation: int = 0, pixel_aspect: Fraction = Fraction(1)) -> Path:
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=30, options={"qscale": "2"})
        stream.width, stream.height, stream.pix_fmt = image.shape[1], image.shape[0], "yuv420p"
        stream.codec_context.sample_aspect_ratio = pixel_aspect
        if rotation:
            stream.set_display_rotation(rotation)
        for _ in range(2):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        container.mux(stream.encode())
    return path


def as_phones_film(path: Path) -> Path:
    return clip(path, np.ascontiguousarray(np.rot90(PICTURE, -1)), rotation=90)


def with_half_the_columns(path: Path) -> Path:
    return clip(path, np.ascontiguousarray(PICTURE[:, ::2]), pixel_aspect=Fraction(2))


@pytest.mark.parametrize("filmed", [as_phones_film, with_half_the_columns])
def test_faces_are_looked_for_in_upright_pictures_of_square_pixels(filmed, tmp_path: Path, watching: Watching) -> None:
    with pytest.raises(ValueError, match="no face was found in"):
        footage.read_footage([filmed(tmp_path / "clip.mp4")])
    assert watching.shown[0].shape == PICTURE.shape
    assert np.abs(watching.shown[0].astype(float) - PICTURE).mean() < 4


def test_what_holds_no_video_is_named(tmp_path: Path) -> None:
    with av.open(str(tmp_path / "sound.wav"), "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000, layout="mono")
        samples = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
        samples.sample_rate = 8000
        container.mux(stream.encode(samples))
    with pytest.raises(ValueError, match=r"no video in .*sound\.wav"):
        footage.read_footage([tmp_path / "sound.wav"])
