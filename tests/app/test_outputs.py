from pathlib import Path

import pytest
from gemheads.app.errors import UsageError
from gemheads.app.outputs import plan_outputs


def test_one_driver_one_result(tmp_path: Path) -> None:
    assert plan_outputs(["a.mp4"], "out.mp4", False) == [("a.mp4", Path("out.mp4"))]
    assert plan_outputs(["a.mp4"], "pngs", True) == [("a.mp4", Path("pngs"))]


def test_several_drivers_share_a_folder_and_keep_their_names() -> None:
    plan = plan_outputs(["x/a.mp4", "y/a.mov", "frames/"], "out", False)
    assert [result for _, result in plan] == [Path("out/a.mp4"), Path("out/a-2.mp4"), Path("out/frames.mp4")]


def test_several_transparent_results_are_folders_of_pngs() -> None:
    assert [result for _, result in plan_outputs(["a.mp4", "b.mp4"], "out", True)] == [Path("out/a"), Path("out/b")]


def test_several_drivers_do_not_fit_into_one_video() -> None:
    with pytest.raises(UsageError, match="with 2 drivers the result is a folder"):
        plan_outputs(["a.mp4", "b.mp4"], "out.mp4", False)


def test_unknown_kinds_of_file_are_refused() -> None:
    with pytest.raises(UsageError, match=r"cannot write \.avi; end it in \.mp4"):
        plan_outputs(["a.mp4"], "out.avi", False)


def test_the_driver_is_never_overwritten(tmp_path: Path) -> None:
    clip = tmp_path / "a.mp4"
    clip.touch()
    with pytest.raises(UsageError, match="would overwrite the driver"):
        plan_outputs([str(clip)], str(tmp_path / "." / "a.mp4"), False)
