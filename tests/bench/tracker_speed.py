"""Milliseconds a frame of the face tracker: ``python tests/bench/tracker_speed.py [CLIP] [--height 720]``."""

import argparse
import time
from pathlib import Path

import av
import cv2
import numpy as np
from gemheads.models.driver.face import FaceTracker
from gemheads.models.driver.features import feature_vector

CLIP = Path(__file__).resolve().parents[2] / "assets" / "demo" / "driver.mp4"


def main() -> None:
    """Tracks a clip scaled to the height wanted and prints median, tenth and ninetieth percentile by stage."""
    parser = argparse.ArgumentParser(description="Time the face tracker.")
    parser.add_argument("clip", nargs="?", type=Path, default=CLIP)
    parser.add_argument("--height", type=int, default=720)
    parser.add_argument("--frames", type=int, default=200)
    options = parser.parse_args()
    frames = []
    with av.open(options.clip) as video:
        for frame, _ in zip(video.decode(video=0), range(options.frames), strict=False):
            picture = frame.to_ndarray(format="rgb24")
            width = round(picture.shape[1] * options.height / picture.shape[0])
            frames.append(cv2.resize(picture, (width, options.height)))
    tracker = FaceTracker()
    took: dict[str, list[float]] = {"track": [], "features": [], "detect": []}
    for frame in frames:
        began = time.perf_counter()
        face = tracker.track(frame)
        tracked = time.perf_counter()
        if face is None:
            continue
        feature_vector(face)
        featured = time.perf_counter()
        tracker.detect(frame)
        took["track"].append(tracked - began)
        took["features"].append(featured - tracked)
        took["detect"].append(time.perf_counter() - featured)
    print(f"{len(took['track'])} of {len(frames)} frames with a face, {frames[0].shape[1]}x{frames[0].shape[0]}")
    for stage, seconds in took.items():
        low, middle, high = np.percentile(np.array(seconds) * 1000, [10, 50, 90])
        print(f"{stage:9s} median {middle:.2f} ms   10 % {low:.2f}   90 % {high:.2f}")


if __name__ == "__main__":
    main()
