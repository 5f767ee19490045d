"""Opening avatars, whatever is behind the name."""

import hashlib
import os
import sys
import tracemalloc
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from gemheads.app.errors import InputError
from gemheads.app.performing.casting import Driving, expression_of, open_avatar


@pytest.fixture
def sparing() -> Iterator[None]:
    """Fails when a test takes more than 8 MB."""
    tracemalloc.start()
    yield
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 8e6


def test_an_avatar_knows_the_hash_of_its_file(tiny: Path) -> None:
    assert open_avatar(tiny).sha256 == hashlib.sha256(tiny.read_bytes()).hexdigest()


@pytest.mark.usefixtures("sparing")
def test_a_huge_file_is_refused_unread(tmp_path: Path) -> None:
    huge = tmp_path / "huge.gem"
    with huge.open("wb") as file:
        file.truncate(2**30 + 1)  # takes no space on the disk
    with pytest.raises(InputError, match=r"huge\.gem: the file has 1073741825 bytes"):
        open_avatar(huge)


@pytest.mark.skipif(sys.platform == "win32", reason="named pipes are files only on POSIX")
@pytest.mark.timeout(10)
def test_a_pipe_that_nobody_writes_to_is_refused_at_once(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.gem"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match="no ordinary file"):
        open_avatar(pipe)


def test_what_is_not_there_is_told_with_its_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.gem: cannot be read \(No such file"):
        open_avatar(tmp_path / "none.gem")


@pytest.mark.parametrize("driving", ["learned", "baseline"])
def test_what_neither_scores_nor_a_regressor_drive_is_sent_to_training(tiny: Path, driving: Driving) -> None:
    avatar = open_avatar(tiny)
    bare = replace(avatar, gem=replace(avatar.gem, arkit_weights=None, regressor=None))
    with pytest.raises(InputError, match="train-regressor") as refused:
        expression_of(bare, driving)
    assert "--driver" not in str(refused.value)
