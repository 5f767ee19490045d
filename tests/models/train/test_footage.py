"""Unlabelled videos are read as their makers saw them."""

from pathlib import Path

import av
import numpy as np
import pytest
from gemheads.models.driver.features import DIMENSION
from gemheads.models.train.footage import read_footage

CLIP = Path(__file__).parents[3] / "assets" / "demo" / "driver.mp4"


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
        read_footage([filmed(tmp_path / f"{name}.mp4", name == "sideways")]) for name in ("upright", "sideways")
    )
    turns, stored = upright[:, DIMENSION:], sideways[:, DIMENSION:]
    assert len(turns) == len(stored)
    assert np.abs(turns[:, :2]).max(0).min() > np.radians(3), "the clip nods and turns"
    assert np.abs(turns - stored).max() < np.radians(1.5)
