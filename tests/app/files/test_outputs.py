from pathlib import Path

import pytest
from gemheads.app.errors import UsageError
from gemheads.app.files.outputs import keep_inputs, plan_outputs
from gemheads.app.files.sources import files_of


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


def test_no_two_results_have_one_name() -> None:
    plan = plan_outputs(["talk.mp4", "x/talk.mp4", "talk-2.mp4", "Talk.mov"], "out", False)
    assert [result.name for _, result in plan] == ["talk.mp4", "talk-2.mp4", "talk-2-2.mp4", "Talk-3.mp4"]


def test_no_result_has_the_name_that_another_has_until_it_is_whole() -> None:
    for drivers, names in (
        (["talk.partial.mp4", "talk.mp4"], ["talk.partial.mp4", "talk-2.mp4"]),
        (["talk.mp4", "talk.partial.mp4"], ["talk.mp4", "talk.partial-2.mp4"]),
    ):
        results = [result for _, result in plan_outputs(drivers, "out", False)]
        assert [result.name for result in results] == names
        keep_inputs(results, [])
    with pytest.raises(UsageError, match="two results would have this name"):
        keep_inputs([Path("z.mp4"), Path("z.partial.mp4")], [])


def test_several_results_are_what_their_names_say(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    plan = plan_outputs([".", "v.mp4.mov"], "out", True)
    assert [result.name for _, result in plan] == [tmp_path.stem, "v_mp4"]


@pytest.mark.parametrize("out", [".", "/"])
def test_a_folder_without_a_name_of_its_own_takes_pngs(out: str) -> None:
    ((_, result),) = plan_outputs(["a.mp4"], out, False)
    keep_inputs([result], [])


def test_a_result_needs_a_name() -> None:
    with pytest.raises(UsageError, match="names nothing"):
        plan_outputs(["a.mp4"], "", False)


def test_names_of_any_length_are_looked_at(tmp_path: Path) -> None:
    """A name that is too long for the disk fails when it is written, and stops no other result."""
    for length in (244, 251, 300):
        keep_inputs([tmp_path / f"{'n' * length}.mp4", tmp_path / "ok.mp4"], [tmp_path / "in.mp4"])


def test_no_result_is_written_over_by_another(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"r\.mp4: two results would have this name"):
        keep_inputs([tmp_path / "r.mp4", None, tmp_path / "x" / ".." / "r.mp4"], [])


class TestWhatIsReadIsKept:
    @pytest.fixture
    def clip(self, tmp_path: Path) -> Path:
        (tmp_path / "a.mp4").touch()
        return tmp_path / "a.mp4"

    def test_under_another_spelling(self, clip: Path) -> None:
        with pytest.raises(UsageError, match=r"a\.mp4: would be written over .*a\.mp4, which is read"):
            keep_inputs([None, clip.parent / "." / "a.mp4"], [None, clip])

    def test_behind_a_folder_that_is_not_there_yet(self, clip: Path) -> None:
        with pytest.raises(UsageError, match="would be written over"):
            keep_inputs([clip.parent / "new" / ".." / "a.mp4"], [clip])

    def test_under_another_name_of_the_same_file(self, clip: Path) -> None:
        other = clip.with_name("b.mp4")
        other.hardlink_to(clip)
        with pytest.raises(UsageError, match="would be written over"):
            keep_inputs([other], [clip])

    def test_under_the_name_of_an_unfinished_result(self, clip: Path) -> None:
        unfinished = clip.rename(clip.with_name("b.partial.mp4"))
        with pytest.raises(UsageError, match=r"b\.mp4: would be written over"):
            keep_inputs([clip.with_name("b.mp4")], [unfinished])

    @pytest.mark.parametrize("driver", ["shots", "shots/frame_%06d.png", "shots/frame_000001.png"])
    def test_in_a_folder_of_pictures(self, tmp_path: Path, driver: str) -> None:
        (tmp_path / "shots").mkdir()
        (tmp_path / "shots" / "frame_000001.png").touch()
        with pytest.raises(UsageError, match="shots: would be written over"):
            keep_inputs([tmp_path / "shots"], files_of(str(tmp_path / driver)))

    def test_everything_else_may_be_written(self, clip: Path) -> None:
        clip.with_name("me.png").touch()
        clip.with_name("old.mp4").touch()
        keep_inputs(
            [clip.with_name("old.mp4"), clip.with_name("new.mp4"), clip.parent], [clip, clip.with_name("me.png")]
        )
