"""What learning sees of a video is what driving sees of it."""

from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from gemheads.models.driver.features import DIMENSION
from gemheads.models.train.regressors import footage
from numpy.typing import NDArray

CLIP = Path(__file__).parents[4] / "assets" / "demo" / "driver.mp4"
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


@pytest.mark.parametrize("stored", [as_phones_film, with_half_the_columns])
def test_faces_are_looked_for_in_upright_pictures_of_square_pixels(stored, tmp_path: Path, watching: Watching) -> None:
    with pytest.raises(ValueError, match="no face was found in"):
        footage.read_footage([stored(tmp_path / "clip.mp4")])
    assert watching.shown[0].shape == PICTURE.shape
    assert np.abs(watching.shown[0].astype(float) - PICTURE).mean() < 4


def filmed(path: Path, sideways: bool) -> Path:
    """Some pictures of the demo clip in which the head turns; ``sideways`` as a phone stores them."""
    with av.open(str(CLIP)) as demo, av.open(str(path), "w") as out:
        stream = out.add_stream("libx264", rate=10, options={"preset": "ultrafast", "crf": "12"})
        stream.width, stream.height, stream.pix_fmt = 512, 512, "yuv420p"
        if sideways:
            stream.set_display_rotation(90)
        for index, picture in enumerate(demo.decode(video=0)):
            if index % 15 == 0:
                image = picture.to_ndarray(format="rgb24")
                stored = np.ascontiguousarray(np.rot90(image, -1)) if sideways else image
                out.mux(stream.encode(av.VideoFrame.from_ndarray(stored, format="rgb24")))
        out.mux(stream.encode())
    return path


@pytest.mark.skipif(not CLIP.is_file(), reason=f"the demo clip is missing: {CLIP}")
def test_a_phone_that_is_held_upright_teaches_the_same(tmp_path: Path) -> None:
    upright, sideways = (
        footage.read_footage([filmed(tmp_path / f"{name}.mp4", name == "sideways")]) for name in ("upright", "sideways")
    )
    turns, stored = upright[:, DIMENSION:], sideways[:, DIMENSION:]
    assert len(turns) == len(stored)
    assert np.abs(turns[:, :2]).max(0).min() > np.radians(3), "the clip nods and turns"
    assert np.abs(turns - stored).max() < np.radians(1.5)


def test_what_holds_no_video_is_named(tmp_path: Path) -> None:
    with av.open(str(tmp_path / "sound.wav"), "w") as container:
        stream = container.add_stream("pcm_s16le", rate=8000, layout="mono")
        samples = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
        samples.sample_rate = 8000
        container.mux(stream.encode(samples))
    with pytest.raises(ValueError, match=r"no video in .*sound\.wav"):
        footage.read_footage([tmp_path / "sound.wav"])
