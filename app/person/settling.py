"""The neutral of a live driver: found while the avatar follows already, and gone over to without a jerk."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...models.driver.face import FaceObservation
from ...models.driver.features import head_rotation
from ...models.driver.neutral import NeutralChoice, choose_neutral

COLLECT_SECS = 6.0
"""So much of a face is looked at: who opens the window talks, or looks for a key, for longer than a moment."""
FEWEST = 8
"""Frames that have to be fit; fewer wait for more ..."""
PATIENCE_SECS = 20.0
"""... but no longer than this, and no longer for a face at rest; then what there is has to do."""
SPACING_SECS = 0.1
"""Faces that are closer together than this say the same."""
RECHOOSE_SECS, RECHOOSE_SHARE = 0.25, 0.1
"""The provisional choice is looked over after so long, and after such a part more of the time: many take longer."""
EASE_SECS = 0.2
"""Time constant of going over from one neutral to another."""
AT_REST = 0.4
"""A neutral that costs more is none. In eight seconds of a talking face the best costs .04 to .3 where it rests for a
moment, and .9 to 1.8 where it does not."""
FRONTAL_DEG = 12.0
"""Who looks further aside, up or down may look at something else than the camera for now: that takes longer to tell."""
FORMER_SECS = 4.0
"""So long at most the rest of whoever was here before counts for somebody who comes and shows none: it may be they."""
MOST_TURN_DEG = 45.0
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
    former: NeutralChoice | None = None
    """That of whoever was here before, which counts in the place of ``automatic`` until that is a rest."""
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
    def found(self) -> NeutralChoice | None:
        """What counts where none is given."""
        return self.former or self.automatic

    @property
    def at_rest(self) -> bool:
        """Whether what counts is a face at rest, as far as can be told, and no makeshift."""
        return self.given is not None or (self.found is not None and _cost(self.found) <= AT_REST)

    @property
    def reason(self) -> str:
        """Why this one, in words."""
        choice = self.given or self.found
        return choice.reason if choice else ""


def settle(before: Settling, face: FaceObservation, now: float, dt: float, strength: float = 1.0) -> Settling:
    """One more look at the driver's face, ``dt`` seconds after the last.

    ``strength``: how much of the neutral that was given counts, the automatic one counts for the rest.
    """
    return go_over(before if before.final else _collected(before, face, now), dt, strength)


def anew(before: Settling) -> Settling:
    """Where somebody comes back, or another one in their place: all is found anew, but for a neutral that was given."""
    return before if before.given is not None else Settling(former=before.found, now=before.now)


def go_over(before: Settling, dt: float, strength: float = 1.0) -> Settling:
    """``dt`` seconds later without another look. Raises ValueError where no neutral is known yet."""
    target = _between(before.found, before.given, strength)
    share = 1.0 if before.now is None else float(-np.expm1(-max(dt, 0.0) / EASE_SECS))
    return replace(before, now=_towards(before.now, target, share))


def _collected(before: Settling, face: FaceObservation, now: float) -> Settling:
    """The collection with one more face, where it is fit and says more; looked over now and then; at last final."""
    begun = before.begun if before.automatic else now
    waited = now - begun
    over = waited >= PATIENCE_SECS
    if before.automatic and not over and (now - before.times[-1] < SPACING_SECS or not _is_fit(face)):
        return before
    faces, times = (*before.faces, face), (*before.times, now)
    if before.automatic and not over and now - before.chosen_at < max(RECHOOSE_SECS, RECHOOSE_SHARE * waited):
        return replace(before, faces=faces, times=times)
    choice = choose_neutral(faces, [time - begun for time in times], [None] * len(faces))
    final = over or (waited >= COLLECT_SECS and len(faces) >= FEWEST and _is_rest(choice))
    kept = ((), ()) if final else (faces, times)
    shown = waited >= FORMER_SECS or (len(faces) >= FEWEST and _cost(choice) <= AT_REST)
    return replace(
        before,
        automatic=choice,
        final=final,
        former=None if shown else before.former,
        faces=kept[0],
        times=kept[1],
        begun=begun,
        chosen_at=now,
    )


def _is_fit(face: FaceObservation) -> bool:
    return face.presence >= LEAST_PRESENCE and _most_turned(head_rotation(face)) <= MOST_TURN_DEG


def _is_rest(choice: NeutralChoice) -> bool:
    """Whether nothing speaks against it, nor for something better to come."""
    return _cost(choice) <= AT_REST and _most_turned(choice.rotation) <= FRONTAL_DEG


def _cost(choice: NeutralChoice) -> float:
    return choice.candidates[0].cost if choice.candidates else 0.0


def _most_turned(rotation: NDArray[np.float64]) -> float:
    """Degrees of the turn to the side, or up and down, whichever is more."""
    return float(np.degrees(np.abs(rotation[:2])).max())


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
