"""Rounds of the loop without a window."""

import time
from collections.abc import Callable

import numpy as np
from gemheads.app.desk.session import Session

from .conftest import Room


def turn(session: Session) -> np.ndarray | None:
    """One round of the loop without a window, and what was drawn in it."""
    now = time.perf_counter()
    session.settle(now)
    session.draw(now)
    while (drawn := session.drawn()) is None and not session.stage.free:
        time.sleep(0.001)
    if drawn is None:
        return None
    session.offer(drawn, now)
    session.view(now)
    return drawn.picture.copy()


def until(session: Session, done: Callable[[], bool], secs: float = 20) -> np.ndarray:
    """Rounds until something is the case; the last picture."""
    picture, end = None, time.perf_counter() + secs
    while time.perf_counter() < end:
        drawn = turn(session)
        picture = drawn if drawn is not None else picture
        if done() and picture is not None:
            return picture
        time.sleep(0.002)
    raise AssertionError("it did not come to that")


def begin(room: Room) -> np.ndarray:
    """The first avatar on stage."""
    return until(room.session, lambda: room.session.stage.avatar is not None)
