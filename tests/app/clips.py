"""A second of the clip that ships, what `reenact` makes of it, and what is in videos."""

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from gemheads.app.cli import main
from gemheads.app.library import DEMO_CLIP

SIZE = ("--size", "64x64", "--engine", "software")


def grey_clip(path: Path, flags: str = "") -> Path:
    """Thirty greys, 25 a second, each 8 brighter than the one before, and not stored in the order they are shown in."""
    with av.open(str(path), "w", options={"movflags": flags} if flags else {}) as container:
        stream = container.add_stream("libx264", rate=25, options={"bf": "2", "x264-params": "b-adapt=0"})
        stream.width, stream.height, stream.pix_fmt = 96, 64, "yuv420p"
        for grey in range(0, 240, 8):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.full((64, 96, 3), grey, np.uint8), "rgb24")))
        container.mux(stream.encode())
    return path


def cut_clip(path: Path, pts: Sequence[int], hidden: range = range(0)) -> Path:
    """The first frames of the demo clip with these times in 1/30000 s and a tone; in ``hidden`` nobody is seen."""
    options = {"movflags": "frag_keyframe+delay_moov", "movie_timescale": "30000"}
    with av.open(str(DEMO_CLIP)) as demo, av.open(str(path), "w", options=options) as out:
        stream = out.add_stream("libx264", rate=30, options={"preset": "ultrafast", "bf": "0"})
        source = demo.streams.video[0]
        stream.width, stream.height, stream.pix_fmt = source.width, source.height, "yuv420p"
        stream.time_base = stream.codec_context.time_base = Fraction(1, 30000)
        audio = out.add_stream("aac", rate=48000, layout="mono")
        for index, (picture, instant) in enumerate(zip(demo.decode(source), pts, strict=False)):
            image = picture.to_ndarray(format="rgb24")
            frame = av.VideoFrame.from_ndarray(np.full_like(image, 90) if index in hidden else image, format="rgb24")
            frame.pts, frame.time_base = instant, Fraction(1, 30000)
            out.mux(stream.encode(frame))
        out.mux(stream.encode())
        for start in range(0, 48000 * pts[-1] // 30000, 1024):
            samples = np.sin(np.arange(start, start + 1024) * 0.05).astype(np.float32)[None]
            tone = av.AudioFrame.from_ndarray(samples, format="fltp", layout="mono")
            tone.pts, tone.sample_rate, tone.time_base = start, 48000, Fraction(1, 48000)
            out.mux(audio.encode(tone))
        out.mux(audio.encode())
    return path


VARIABLE = tuple(int(t) for t in np.cumsum([2002, *[1001, 1500, 500, 1001] * 6]))


def play(tiny: Path, *words: str | Path) -> int:
    driving = () if "--track" in words else ("--driver", "baseline")
    return main(["reenact", *map(str, words), "--avatar", str(tiny), *driving, *SIZE])


def times(path: Path) -> list[Fraction]:
    with av.open(str(path)) as container:
        return [frame.pts * frame.time_base for frame in container.decode(video=0)]


def pictures(path: Path) -> np.ndarray:
    with av.open(str(path)) as container:
        return np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)])


def sound(path: Path) -> list[bytes]:
    with av.open(str(path)) as container:
        return [bytes(packet) for packet in container.demux(audio=0) if packet.size]
