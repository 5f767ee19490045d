"""Film strip of a driver above the avatars that repeat it: the picture at the top of the README.

    python tests/bench/film_strip.py -o docs/pictures/strip.jpg [--driver CLIP] [--seconds 0.3 1.6 ...] [AVATAR ...]

Every picture is a frame of what ``gemheads reenact`` writes for the clip.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
from gemheads.app.errors import CommandError
from gemheads.app.files.video import VideoFile
from gemheads.app.library import DEMO_CLIP, find_avatar
from gemheads.app.reenacting.reenact import reenact
from gemheads.app.reenacting.wish import Wish
from numpy.typing import NDArray

SIDE = 224
QUALITY = 88
WHY = "a strip of small pictures, which says what they are beside them"


def main() -> int:
    """The command; see ``--help``."""
    parser = argparse.ArgumentParser(description="A driver above the avatars that repeat it.")
    parser.add_argument("avatars", nargs="*", default=["mara", "theo", "jonah"], help="names or files")
    parser.add_argument("--driver", type=Path, default=DEMO_CLIP)
    parser.add_argument("--seconds", type=float, nargs="+", default=[0.3, 0.93, 1.63, 4.23, 5.83, 7.0, 8.17, 9.57])
    parser.add_argument("-o", dest="out", type=Path, required=True, help="JPEG or PNG")
    options = parser.parse_args()
    try:
        rows = [_row(options.driver, options.seconds)]
        with tempfile.TemporaryDirectory() as folder:
            for avatar in options.avatars:
                video = Path(folder) / f"{Path(avatar).stem}.mp4"
                code = reenact([str(options.driver)], str(video), Wish(find_avatar(avatar), no_badge=WHY))
                if code:
                    return code  # it has said why
                rows.append(_row(video, options.seconds))
    except CommandError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.code
    strip = cv2.cvtColor(np.concatenate(rows), cv2.COLOR_RGB2BGR)
    jpeg = options.out.suffix.lower() in (".jpg", ".jpeg")
    cv2.imwrite(str(options.out), strip, [cv2.IMWRITE_JPEG_QUALITY, QUALITY] if jpeg else [])
    return 0


def _row(video: Path, seconds: list[float]) -> NDArray[np.uint8]:
    """[SIDE, SIDE * pictures, 3] the frames nearest to these moments, side by side."""
    frames = list(VideoFile(video).frames())
    times = np.array([frame.seconds for frame in frames])
    chosen = [frames[int(np.abs(times - moment).argmin())].rgb for moment in seconds]
    return np.concatenate([cv2.resize(rgb, (SIDE, SIDE), interpolation=cv2.INTER_AREA) for rgb in chosen], 1)


if __name__ == "__main__":
    raise SystemExit(main())
