"""Small runs of commands that need no face."""

from pathlib import Path

NAMES = ("export", "export --track", "modes", "reenact to mp4", "reenact to a folder", "distill", "train-regressor")


def commands(played: tuple[Path, Path], frames: Path, out: Path) -> dict[str, list[str]]:
    """Name -> words."""
    avatar, track = (str(path) for path in played)
    acting = ["reenact", "--avatar", avatar, "--track", track, "--engine", "software", "--size", "320x320", "-o"]
    words = (
        ["export", avatar, "-o", str(out / "a.ply")],
        ["export", avatar, "--track", track, "-o", str(out / "plys")],
        ["modes", avatar, "-o", str(out / "modes.png"), "--engine", "software"],
        [*acting, str(out / "a.mp4")],
        [*acting, str(out / "pictures"), "--background", "transparent"],
        ["distill", str(frames), "-o", str(out / "a.gem"), "--components", "2"],
        ["train-regressor", avatar, "-o", str(out / "b.gem"), "--pictures", "40", "--steps", "1"],
    )
    return dict(zip(NAMES, words, strict=True))
