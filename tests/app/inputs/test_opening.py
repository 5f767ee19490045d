from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.errors import InputError, UsageError
from gemheads.app.inputs import open_input
from gemheads.app.library import DEMO_CLIP
from gemheads.app.performing.tracks import save_track
from tracks import TRACK


def test_words_mean_what_they_say(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "shot_1.png"), np.zeros((32, 48, 3), np.uint8))
    for text, kind in (
        ("demo", "video"),
        ("performance", "track"),
        (str(DEMO_CLIP), "video"),
        (str(tmp_path), "pictures"),
        (str(tmp_path / "shot_1.png"), "pictures"),
        (str(tmp_path / "shot_%d.png"), "pictures"),
    ):
        source = open_input(text)()
        assert source.kind == kind
        source.close()


def test_a_track_is_one_whatever_its_name(tmp_path: Path) -> None:
    save_track(TRACK, tmp_path / "talk.track")
    source = open_input(str(tmp_path / "talk.track"))()
    assert (source.kind, source.name) == ("track", TRACK.avatar)


@pytest.mark.enable_socket
def test_ports_are_listened_on_here_unless_told_otherwise() -> None:
    for text, name in (("osc:0", "osc on 127.0.0.1:0"), ("iFacialMocap:0.0.0.0:0", "ifacialmocap on 0.0.0.0:0")):
        source = open_input(text)()
        assert (source.kind, source.name) == ("weights", name)
        source.close()


@pytest.mark.parametrize("text", ["osc:many", "osc:-1", "ifacialmocap:70000"])
def test_a_port_that_is_none_is_refused_at_once(text: str) -> None:
    with pytest.raises(UsageError, match="no port"):
        open_input(text)


@pytest.mark.parametrize("name", ["absent.mp4", "absent.safetensors", "absent"])
def test_a_file_that_is_not_there_is_told_when_it_is_opened(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="absent"):
        open_input(str(tmp_path / name))()
