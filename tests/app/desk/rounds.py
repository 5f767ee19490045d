"""Rounds of the loop without a window."""

import time
from collections.abc import Callable

import numpy as np
from gemheads.app.desk.onstage import Drawn
from gemheads.app.desk.session import Session
from waiting import eventually, in_words

from .conftest import Room


def turn(session: Session) -> np.ndarray | None:
    """One round of the loop without a window, and what was drawn in it."""
    now = time.perf_counter()
    session.settle(now)
    session.draw(now)
    drawn: Drawn | None = None

    def come() -> bool:
        nonlocal drawn
        drawn = session.drawn()
        return drawn is not None or session.stage.free

    eventually(come, what="a picture, or nothing to draw")
    if drawn is None:
        return None
    session.offer(drawn, now)
    session.view(now)
    return drawn.picture.copy()


def until(session: Session, done: Callable[[], object]) -> np.ndarray:
    """Rounds until something is the case; the last picture."""
    picture: np.ndarray | None = None

    def so() -> bool:
        nonlocal picture
        drawn = turn(session)
        picture = drawn if drawn is not None else picture
        return bool(done()) and picture is not None

    eventually(so, what=in_words(done))
    assert picture is not None
    return picture


def begin(room: Room) -> np.ndarray:
    """The first avatar on stage."""
    return until(room.session, lambda: room.session.stage.avatar is not None)
