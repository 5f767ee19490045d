"""The picture of single components."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from gemheads.app.credentials.badge import badged
from gemheads.app.errors import InputError, OutputError, UsageError
from gemheads.app.modes import LABEL_PX, draw_modes, modes_picture
from gemheads.models.gem import MODALITIES, Basis
from gemheads.models.gemfile import load_gem, save_gem
from gemheads.render.software import SoftwareEngine


def test_rows_are_components_and_columns_are_sigmas(tiny: Path) -> None:
    gem = load_gem(tiny)
    picture = modes_picture(gem, range(2), "position", (36, 64), SoftwareEngine())
    assert picture.shape == (2 * (LABEL_PX + 64), 5 * 36, 3)
    assert picture.dtype == np.uint8
    cells = [picture[LABEL_PX : LABEL_PX + 64, 36 * i : 36 * (i + 1)].astype(int) for i in range(5)]
    assert all((cell.min() < 200) and (cell[0] == 255).all() for cell in cells)  # a head on white
    assert np.abs(cells[0] - cells[4]).mean() > np.abs(cells[1] - cells[3]).mean() > 0


@pytest.mark.parametrize("modality", MODALITIES)
def test_every_modality_shows(tiny: Path, modality: str) -> None:
    gem = load_gem(tiny)
    bases = {name: Basis(basis.rows.copy(), basis.sigma * 40) for name, basis in gem.bases.items()}
    bases["scale"].rows[0, ::3] += 1  # long splats, whose turning shows
    bases["opacity"].rows[:2] = [[0], [0.05]]  # half transparent, and all together
    picture = modes_picture(replace(gem, bases=bases), [0], modality, (48, 48), SoftwareEngine(), steps=3)
    cells = picture[LABEL_PX:].reshape(48, 3, 48, 3).swapaxes(0, 1).astype(int)
    assert (cells[0] != cells[2]).any()


def test_a_component_that_is_not_there_is_refused(tiny: Path) -> None:
    with pytest.raises(ValueError, match="6 scale components, not 7"):
        modes_picture(load_gem(tiny), [6], "scale", (32, 32), SoftwareEngine())


def test_the_command_writes_a_png(tiny: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "modes.png"
    draw_modes(tiny, out, 2, (32, 32), "software")
    picture = cv2.imread(str(out))
    assert picture is not None
    assert picture.shape == (4 * 2 * (LABEL_PX + 32), 5 * 32, 3)
    gem, engine = load_gem(tiny), SoftwareEngine()
    bare = np.concatenate([modes_picture(gem, range(2), modality, (32, 32), engine) for modality in MODALITIES])
    assert (picture[..., ::-1] == badged(bare)).all()


def test_an_avatar_that_does_not_move_cannot_be_drawn(tiny: Path, tmp_path: Path) -> None:
    still = tmp_path / "still.gem"
    save_gem(load_gem(tiny).truncated(0), still)
    with pytest.raises(InputError, match=r"still.gem: has no components, so nothing of it moves"):
        draw_modes(still, tmp_path / "modes.png", 2, (32, 32), "software")


def test_a_folder_that_is_a_file_is_one_plain_error(tiny: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match="cannot be written"):
        draw_modes(tiny, tmp_path / "file" / "modes.png", 1, (32, 32), "software")


def test_a_picture_is_a_png(tiny: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"end its name in \.png"):
        draw_modes(tiny, tmp_path / "modes.jpg", 1, (32, 32), "software")


def test_a_picture_that_nothing_opens_is_not_drawn(tiny: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"20480x98976 pixels .* fewer --components or less --size"):
        draw_modes(tiny, tmp_path / "modes.png", 6, (4096, 4096), "software")
    assert not list(tmp_path.iterdir())


def test_more_components_than_there_are_are_refused(tiny: Path, tmp_path: Path) -> None:
    for components in (0, 7):
        with pytest.raises(UsageError, match=rf"--components {components}: .* stores 6; choose from 1 to 6"):
            draw_modes(tiny, tmp_path / "modes.png", components, (32, 32), "software")
    draw_modes(tiny, tmp_path / "modes.png", None, (32, 32), "software")
