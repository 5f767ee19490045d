"""The microphone beside a recording: an optional extra, and in time with the pictures."""

import threading
import time
from collections import deque
from typing import Any

import av
import numpy as np
from numpy.typing import NDArray

from ..errors import OutputError

RATE = 48000
_BLOCK = 960
"""Samples a block: 20 ms."""
_SLIP_SECS = 0.1
"""Sound that is further than this from where the clock puts it was lost in between, or the devices' clocks differ."""
_WAITING = 60 * RATE // _BLOCK
"""Blocks that may wait for the encoder: a minute; then the oldest go."""
MISSING = "no microphone: the extra that records sound is not installed; run pip install gemheads[mic]"


def sound_devices() -> Any:
    """The module sounddevice. Raises OutputError where it, or the system's PortAudio, is missing."""
    try:
        import sounddevice  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise OutputError(MISSING) from error
    except OSError as error:
        raise OutputError(
            "no microphone: the PortAudio library is missing; Debian, Ubuntu: sudo apt install libportaudio2"
        ) from error
    return sounddevice


class Microphone:
    """The system's default microphone, mono, as the sound of one recording."""

    def __init__(self) -> None:
        """Starts listening. Raises OutputError with the cure when there is none."""
        devices = sound_devices()
        self._blocks: deque[tuple[float, NDArray[np.float32]]] = deque(maxlen=_WAITING)
        self._lock = threading.Lock()
        self._start: float | None = None
        self._written = 0
        self._container = self._encoder = None
        try:
            self._stream = devices.InputStream(
                samplerate=RATE, channels=1, dtype="float32", blocksize=_BLOCK, callback=self._heard
            )
            self._stream.start()
        except Exception as error:  # PortAudioError, which is only there where the module is
            raise OutputError(
                f"no microphone: {error}; plug one in and allow this program to use it, or record without sound"
            ) from error

    def into(self, container: Any) -> "Microphone":
        """Adds the sound track to a container that has not been written to."""
        codec = "libopus" if "webm" in container.format.name else "aac"
        self._container = container
        self._encoder = container.add_stream(codec, rate=RATE, layout="mono")
        return self

    def begin(self, now: float) -> None:
        """The first picture is shown at ``now`` (seconds of ``time.perf_counter``): sound before it is left out."""
        self._start = now

    def copy_until(self, seconds: float) -> None:
        """Encode what was heard up to so many seconds after the first picture."""
        if self._start is None:
            return
        while (block := self._next(self._start + seconds)) is not None:
            self._encode(block[0] - self._start, block[1])

    def close(self, whole: bool) -> None:
        """Stop listening; the rest that was heard is written when ``whole``."""
        self._stream.stop()
        self._stream.close()
        if self._encoder is None or self._container is None:
            return
        if whole:
            self.copy_until(float("inf"))
        if self._written:
            for packet in self._encoder.encode(None):
                self._container.mux(packet)

    def _heard(self, samples: NDArray[np.float32], count: int, _time: Any, _status: Any) -> None:
        """Called in the sound system's thread for each block that ends about now. Encoders refuse NaN."""
        with self._lock:
            self._blocks.append((time.perf_counter() - count / RATE, np.clip(np.nan_to_num(samples[:, 0]), -1, 1)))

    def _next(self, until: float) -> tuple[float, NDArray[np.float32]] | None:
        with self._lock:
            return self._blocks.popleft() if self._blocks and self._blocks[0][0] < until else None

    def _encode(self, seconds: float, samples: NDArray[np.float32]) -> None:
        """Samples one behind the other; lost ones become silence, and what comes too early is left out."""
        if seconds < 0:
            return
        slip = seconds - self._written / RATE
        if slip > _SLIP_SECS:
            samples = np.concatenate([np.zeros(round(slip * RATE), np.float32), samples])
        elif slip < -_SLIP_SECS:
            return
        frame = av.AudioFrame.from_ndarray(samples[None], format="fltp", layout="mono")
        frame.sample_rate, frame.pts = RATE, self._written
        self._written += len(samples)
        assert self._encoder is not None  # the recording opened its container before it asked for sound
        assert self._container is not None
        for packet in self._encoder.encode(frame):
            self._container.mux(packet)
