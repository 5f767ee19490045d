"""Taking the neutral while the window goes on: countdown, collecting, judging, keeping."""

from datetime import date

from ...models.driver.neutral import NeutralChoice
from ..errors import CommandError
from ..performing.casting import Avatar
from ..performing.shots import Health, Shot
from ..person.profiles import load_profile, save_profile
from ..person.restface import COLLECT_SECS, COUNTDOWN_SECS, TOO_FEW, Resting, RestSession, judge, step
from .view import Rest


class NeutralTaking:
    """One taking after another; ``taken`` is the last one that was accepted."""

    def __init__(self) -> None:
        self._session: RestSession | None = None
        self._said = Rest()
        self.taken: Resting | None = None

    @property
    def on(self) -> bool:
        """Whether one is being taken."""
        return self._session is not None

    def begin(self) -> None:
        """Start with the coach."""
        self._session, self._said = RestSession(), Rest(score=self._said.score)

    def stop(self) -> None:
        """Forget what was collected."""
        self._session = None

    def advance(self, shot: Shot | None, health: Health, avatar: Avatar, now: float) -> Resting | None:
        """One frame of it. The neutral when it is done and accepted; why not is in ``told``."""
        if self._session is None:
            return None
        observed = shot.observed if shot is not None else None
        self._session = step(self._session, observed, health.rate, now)
        if self._session.phase != "done":
            return None
        session, self._session = self._session, None
        try:
            resting = judge(session, avatar)
        except CommandError as error:  # no face drives the avatar that came on stage meanwhile
            self._said = Rest(result=_sentence(str(error)))
            return None
        if resting is None:
            self._said = Rest(result=_sentence(TOO_FEW))
            return None
        if not resting.accepted:
            self._said = Rest(result=_sentence(resting.why), score=resting.residual)
            return None
        self._said = Rest(result=_sentence(resting.choice.reason), score=resting.residual, green=True)
        self.taken = resting
        return resting

    def told(self) -> Rest:
        """What the panels say of it."""
        session = self._session
        if session is None:
            return self._said
        counting, collecting = session.phase == "countdown", session.phase == "collecting"
        share = session.remaining / (COUNTDOWN_SECS if counting else COLLECT_SECS)
        return Rest(
            green=session.coaching.green,
            sentences=(session.message,),
            countdown=session.remaining + 0.5 if counting else None,
            progress=1 - share if collecting else None,
            score=self._said.score,
        )


def kept(camera: str, resting: Resting) -> str:
    """Keep a neutral for a camera; one sentence when that fails, else an empty one."""
    try:
        save_profile(camera, resting, date.today())
    except CommandError as error:
        return f"{error}."
    return ""


def recalled(camera: str) -> tuple[NeutralChoice | None, str]:
    """The neutral kept for a camera, and one sentence when something is wrong with it."""
    try:
        profile = load_profile(camera)
    except CommandError as error:
        return None, f"{error}."
    return (None, "") if profile is None else (profile.choice, profile.warning)


def _sentence(words: str) -> str:
    return words[:1].upper() + words[1:] + "."
