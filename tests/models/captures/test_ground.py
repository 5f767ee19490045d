"""A room behind the person is noticed where no mask tells it from the person."""

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.models.captures.ground import room_behind
from gemheads.models.captures.reader import open_capture
from toycapture import write_capture

Pixels = np.ndarray


def wallpaper(picture: Pixels, mask: Pixels) -> Pixels:
    stripes = np.zeros_like(picture)
    stripes[:, ::3] = 200, 90, 30
    share = mask[..., None] / 255
    return np.round(share * picture + (1 - share) * stripes).astype(np.uint8)


def plain(picture: Pixels, mask: Pixels) -> Pixels:
    return picture


def green(picture: Pixels, mask: Pixels) -> Pixels:
    share = mask[..., None] / 255
    return np.round(share * picture + (1 - share) * np.array([64, 204, 64])).astype(np.uint8)


@pytest.mark.parametrize(
    ("behind", "masks", "background", "noticed"),
    [
        (plain, False, None, False),
        (wallpaper, False, None, True),
        (wallpaper, True, None, False),
        (green, False, None, True),
        (green, False, (64 / 255, 204 / 255, 64 / 255), False),
    ],
)
def test_a_room_without_masks(
    behind: Callable[[Pixels, Pixels], Pixels],
    masks: bool,
    background: tuple[float, ...] | None,
    noticed: bool,
    tmp_path: Path,
) -> None:
    folder = write_capture(tmp_path / "capture", moments=4, size=48)
    for name in ("train", "val", "test"):
        listed = folder / f"transforms_{name}.json"
        told = json.loads(listed.read_text())
        for frame in told["frames"]:
            picture = cv2.imread(str(folder / frame["file_path"]))
            mask = cv2.imread(str(folder / frame["fg_mask_path"]), 0)
            cv2.imwrite(str(folder / frame["file_path"]), behind(picture, mask))
            if not masks:
                del frame["fg_mask_path"]
        told.pop("background")
        if background is not None:
            told["background"] = background
        listed.write_text(json.dumps(told))
    capture = open_capture(folder)
    found = room_behind(capture)
    assert (found is not None) == noticed
    assert found is None or found in [shot.picture for shot in capture.train]
