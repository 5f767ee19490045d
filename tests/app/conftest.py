"""A tiny avatar and tiny clips, made here: no test needs a network, a camera or a shipped file."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from gemheads.models.gemfile import save_gem
from gems import ball


@pytest.fixture(scope="session")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An avatar's file without a regressor."""
    path = tmp_path_factory.mktemp("avatars") / "tiny.gem"
    save_gem(ball(), path)
    return path


Clip = Callable[..., Path]


@pytest.fixture
def make_clip(tmp_path: Path) -> Clip:
    """Writes a video of noise-free gradients with given timestamps, optionally with a tone as its sound."""

    def make(
        name: str = "clip.mp4",
        pts: tuple[int, ...] = (0, 1001, 2002, 3003),
        time_base: Fraction = Fraction(1, 30000),
        size: tuple[int, int] = (96, 64),
        sound: bool = False,
        rotation: int = 0,
        pixel_aspect: Fraction = Fraction(1),
        options: dict[str, str] | None = None,
        flags: str = "delay_moov",
    ) -> Path:
        path = tmp_path / name
        if path.suffix == ".mp4":
            options = {"movflags": f"frag_keyframe+{flags}", "movie_timescale": str(time_base.denominator)}
        with av.open(str(path), "w", options=options or {}) as container:
            stream = container.add_stream("mpeg4", rate=30, options={"qscale": "2"})
            stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
            stream.time_base = stream.codec_context.time_base = time_base
            stream.codec_context.sample_aspect_ratio = pixel_aspect
            if rotation:
                stream.set_display_rotation(rotation)
            audio = container.add_stream("aac", rate=48000, layout="mono") if sound else None
            for index, instant in enumerate(pts):
                image = np.zeros((size[1], size[0], 3), np.uint8)
                image[: size[1] // 2, : size[0] // 2] = 120 + index % 120
                frame = av.VideoFrame.from_ndarray(image, format="rgb24")
                frame.pts, frame.time_base = instant, time_base
                container.mux(stream.encode(frame))
            if not pts:
                container.start_encoding()
            container.mux(stream.encode())
            if audio:
                samples = np.sin(np.arange(48000) * 0.05).astype(np.float32)[None]
                for start in range(0, round(48000 * float(pts[-1] * time_base)) or 1024, 1024):
                    tone = av.AudioFrame.from_ndarray(
                        samples[:, start % 40960 :][:, :1024], format="fltp", layout="mono"
                    )
                    tone.pts, tone.sample_rate, tone.time_base = start, 48000, Fraction(1, 48000)
                    container.mux(audio.encode(tone))
                container.mux(audio.encode())
        return path

    return make


def make_sound_unknown(clip: Path) -> None:
    """Name the AAC of an MP4 as no codec is named."""
    head, kind, rest = clip.read_bytes().partition(b"mp4a")
    assert kind
    clip.write_bytes(head + b"zzzz" + rest.replace(b"esds", b"zzzz", 1))
