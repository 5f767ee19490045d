"""The bar people watch: rate and time left, on stderr, only where somebody looks."""

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn


class ProgressBar:
    """One bar for one clip after another."""

    def __init__(self, quiet: bool = False) -> None:
        self._console = Console(stderr=True)
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            console=self._console,
            disable=quiet or not self._console.is_terminal,
            transient=True,
        )
        self._task = self._bar.add_task("", total=None, rate="", visible=False)
        self._stage = ""
        self._said: set[str] = set()

    def __enter__(self) -> "ProgressBar":
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def begin(self, name: str, frames: int | None) -> None:
        """A new clip."""
        self._bar.reset(self._task, description=name, total=frames, completed=0, visible=True, rate="")

    def advance(self) -> None:
        """One frame is drawn."""
        speed = self._bar.tasks[self._task].speed
        self._bar.update(self._task, advance=1, rate=f"{speed:.0f} frames/s" if speed else "")

    def reach(self, stage: str, done: int, total: int) -> None:
        """So many of a stage are done; another stage begins the bar anew."""
        if stage != self._stage:
            self._stage = stage
            self.begin(stage, total)
        self._bar.update(self._task, completed=done)

    def say(self, text: str) -> None:
        """One line above the bar."""
        self._console.print(text, highlight=False, markup=False, soft_wrap=True)

    def say_once(self, text: str) -> None:
        """One line above the bar, unless it was said for a clip before."""
        if text not in self._said:
            self._said.add(text)
            self.say(text)
