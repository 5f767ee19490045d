"""``gemheads live``: puts a session together, opens the window, and keeps what is to be remembered."""

import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ...render.contexts import NoOpenGLError
from ...render.enginename import EngineName
from ...render.engines import open_engine
from ...render.software import SoftwareEngine
from ...render.splats import SplatRenderer
from ..errors import ExitCode, InputError
from ..inputs.opening import check_input, open_input, plain_path
from ..library import avatars, find_avatar
from ..live import run_live
from ..performing.casting import Avatar
from .actions import Order
from .farewell import farewell
from .keys import keymap
from .loader import open_for_stage
from .outputs import Outputs
from .remote import Remote, read_listen
from .roster import Roster
from .session import Session
from .settings import Settings, load_settings, recalled, remembered, save_settings, settings_file
from .sources import is_avatar
from .state import DeskState, update
from .window import DeskWindow
from .wish import LiveWish

RATE = 30
"""Pictures a second that are recorded, at most."""
FINISH_SECS = 300.0
"""How long a recording may be finished and signed after the window was closed; a disk that hangs takes longer."""


def live_command(wish: LiveWish) -> ExitCode:
    """Open the window and stay until it is closed.

    Raises CommandError when an avatar or a driver is not there, a port cannot be listened on, or no window opens.
    """
    if wish.driver is not None:
        wish = replace(wish, driver=plain_path(wish.driver))
    opened = _checked(wish)
    file = settings_file()
    settings, complaint = load_settings(file)
    roster = opening_roster(wish.avatar, settings.avatar)
    remote = Remote(*read_listen(wish.listen)) if wish.listen is not None else None
    desk = _opened(settings)
    session = Session(
        _state(wish, settings, desk.content_scale),
        roster,
        keymap(settings.keys),
        lambda: open_engine(wish.engine, desk.context),
        Outputs(wish.size, RATE, recordings_folder),
        wish.size,
        remote,
        warm=warmer(wish.engine),
        spare=find_avatar() if avatars() else None,
        opened=opened,
    )
    session.driving.camera = settings.camera
    if complaint:
        session.tell(complaint)
    for order in first_orders(wish.driver, wish.camera):
        session.obey(order)
    with farewell(desk.quit):  # until files are finished, too
        try:
            run_live(desk, session)
        finally:
            desk.hide()  # what ends in its own thread may take a moment longer
            settings = _left(settings, session, desk)
            session.close()
            desk.close()
            if trouble := save_settings(settings, file):
                _say(trouble)
            await_files(session.outputs)
    return ExitCode.OK


def _checked(wish: LiveWish) -> list[Avatar]:
    """The avatars that are asked for; what cannot be is told before a window opens. Raises CommandError."""
    opened: list[Avatar] = []
    if wish.driver is not None and is_avatar(wish.driver):
        opened.append(open_for_stage(Path(wish.driver).expanduser()))
    elif wish.driver is not None:
        check_input(wish.driver)
        open_input(wish.driver)
    if wish.avatar is not None:
        opened.append(open_for_stage(find_avatar(wish.avatar)))
    return opened


def _opened(settings: Settings) -> DeskWindow:
    """The window, as large as it was; at the first run as this screen wants it. Raises InputError."""
    try:
        desk = DeskWindow(settings.window)
        if settings.window is None:
            desk.grow(desk.content_scale)
    except NoOpenGLError as error:
        raise InputError(f"gemheads live: {error}") from error
    return desk


def _state(wish: LiveWish, settings: Settings, scale: float) -> DeskState:
    """How the window begins; ``scale`` is that of letters on this screen, where none is remembered."""
    welcome = wish.driver is None and wish.camera is None
    state = replace(recalled(DeskState(), settings), welcome=welcome, no_badge=wish.no_badge)
    if wish.components is not None:
        state = replace(state, components=wish.components)
    return state if "ui_scale" in settings.wishes else update(state, Order("ui_scale", scale))


def _left(settings: Settings, session: Session, desk: DeskWindow) -> Settings:
    """What is remembered of a run that began with these settings."""
    window = settings.window if session.state.full_screen else desk.size
    avatar, camera = played(session, settings.avatar), session.driving.camera
    return replace(remembered(session.state, settings), avatar=avatar, camera=camera, window=window)


def await_files(outputs: Outputs, secs: float = FINISH_SECS) -> None:
    """Let closed outputs finish and sign what they write, for ``secs`` at most; says so when that takes a moment."""
    if outputs.finished():
        return
    _say("The recording is being finished ...")
    if not outputs.finished(secs):
        _say(f"It is not finished after {secs:.0f} s, so it stays as far as it is; check the disk.")


def _say(words: str) -> None:
    """On stderr, which may be gone with its terminal."""
    with suppress(OSError):
        print(words, file=sys.stderr, flush=True)


def opening_roster(wanted: str | None, before: str) -> Roster:
    """The library, with the avatar on stage that is wanted, else that of the last run, else the first shipped one.

    Raises InputError when the wanted one is not there.
    """
    roster = Roster(tuple(entry.path for entry in avatars()))
    if wanted is None and before and Path(before).is_file():
        return roster.staged(Path(before))
    return roster.staged(find_avatar(wanted))


def played(session: Session, before: str) -> str:
    """The file of the avatar on stage; that of the run before where none came there."""
    roster = session.stage.roster
    return before if session.stage.avatar is None else str(roster.paths[roster.current])


def first_orders(driver: str | None, camera: str | None) -> tuple[Order, ...]:
    """What the command line asks of the window."""
    if driver is not None:
        return (Order("open", driver),)
    return (Order("camera", camera),) if camera is not None else ()


def warmer(engine: EngineName) -> Callable[[], None]:
    """What compiles the engine's first frame; ``auto`` begins with quads, and compiles the other one by itself."""
    return SoftwareEngine().warm if engine == "software" else SplatRenderer.warm


def recordings_folder() -> Path:
    """Where recordings and pictures go."""
    import platformdirs

    return Path(platformdirs.user_videos_dir()) / "gemheads"
