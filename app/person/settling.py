"""The neutral of a live driver: found while the avatar follows already, and gone over to without a jerk."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...models.driver.face import FaceObservation
from ...models.driver.features import head_rotation
from ...models.driver.neutral import NeutralChoice, choose_neutral

COLLECT_SECS = 1.5
"""So much of a face that is fit to be looked at."""
FEWEST = 8
"""Frames that have to be fit; fewer wait for more ..."""
PATIENCE_SECS = 4.0
"""... but no longer than this; then what there is has to do."""
RECHOOSE_SECS = 0.25
"""How often the provisional choice is looked over."""
EASE_SECS = 0.2
"""Time constant of going over from one neutral to another."""
MOST_TURN_DEG = 20.0
LEAST_PRESENCE = 0.7


@dataclass(frozen=True)
class Settling:
    """What is subtracted now, and how it came about."""

    automatic: NeutralChoice | None = None
    """The best of what was seen so far."""
    final: bool = False
    """Whether ``automatic`` stays."""
    given: NeutralChoice | None = None
    """The one that the person took, in its place."""
    now: NeutralChoice | None = None
    """What is to be subtracted at this moment."""
    faces: tuple[FaceObservation, ...] = ()
    times: tuple[float, ...] = ()
    """Of ``faces``, seconds."""
    begun: float = 0.0
    """When the first face was seen."""
    chosen_at: float = 0.0

    @property
    def settled(self) -> bool:
        """Whether the person's neutral is known."""
        return self.final or self.given is not None

    @property
    def reason(self) -> str:
        """Why this one, in words."""
        choice = self.given or self.automatic
        return choice.reason if choice else ""


def settle(before: Settling, face: FaceObservation, now: float, dt: float, strength: float = 1.0) -> Settling:
    """One more look at the driver's face, ``dt`` seconds after the last.

    ``strength``: how much of the neutral that was given counts, the automatic one counts for the rest.
    """
    return go_over(before if before.final else _collected(before, face, now), dt, strength)


def go_over(before: Settling, dt: float, strength: float = 1.0) -> Settling:
    """``dt`` seconds later without another look. Raises ValueError where no neutral is known yet."""
    target = _between(before.automatic, before.given, strength)
    share = 1.0 if before.now is None else float(-np.expm1(-max(dt, 0.0) / EASE_SECS))
    return replace(before, now=_towards(before.now, target, share))


def _collected(before: Settling, face: FaceObservation, now: float) -> Settling:
    """The collection with one more face, where it is fit; looked over now and then; at last final."""
    begun = before.begun if before.automatic else now
    waited = now - begun
    if before.automatic and waited < PATIENCE_SECS and not _is_fit(face):
        return before
    faces, times = (*before.faces, face), (*before.times, now)
    final = (now - times[0] >= COLLECT_SECS and len(faces) >= FEWEST) or waited >= PATIENCE_SECS
    if not final and before.automatic and now - before.chosen_at < RECHOOSE_SECS:
        return replace(before, faces=faces, times=times)
    choice = choose_neutral(faces, [time - begun for time in times])
    kept = ((), ()) if final else (faces, times)
    return replace(before, automatic=choice, final=final, faces=kept[0], times=kept[1], begun=begun, chosen_at=now)


def _is_fit(face: FaceObservation) -> bool:
    pitch, yaw, _ = np.degrees(np.abs(head_rotation(face)))
    return face.presence >= LEAST_PRESENCE and bool(max(pitch, yaw) <= MOST_TURN_DEG)


def _between(automatic: NeutralChoice | None, given: NeutralChoice | None, strength: float) -> NeutralChoice:
    """Raises ValueError without either."""
    target = given or automatic
    if target is None:
        raise ValueError("no neutral: neither found nor given")
    return target if given is None or automatic is None else _towards(automatic, given, strength)


def _towards(before: NeutralChoice | None, target: NeutralChoice, share: float) -> NeutralChoice:
    if before is None or share >= 1:
        return target

    def blend(old: NDArray[np.floating], new: NDArray[np.floating]) -> NDArray[np.floating]:
        return (old + share * (new - old)).astype(new.dtype)

    return replace(
        target,
        features=blend(before.features, target.features),
        rotation=blend(before.rotation, target.rotation),
    )
