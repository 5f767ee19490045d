"""The live neutral: coached, counted down, collected for two seconds, and judged before it counts.

Pure: the clock is the caller's. No picture is looked at or kept, only features.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...models.driver.features import BLOCKS, relative_rotation
from ...models.driver.measures import MEASURES
from ...models.driver.neutral import NeutralChoice
from ..performing.casting import Avatar, expression_of
from ..performing.shots import Observed
from .coach import Coaching, coach
from .median import geometric_median

COUNTDOWN_SECS = 3.0
COLLECT_SECS = 1.8
FEWEST = 15
"""Pictures that are needed; a slow camera gets more time ..."""
PATIENCE_SECS = 4.0
"""... but no more than this."""
GRACE_SECS = 0.4
"""What stands in the way for less than this does not begin the countdown anew."""
CLOSING = 0.8
"""Lids that are closer together than this part of their usual gap blink."""
FAR_OFF = 3.0
"""A picture that is this many times further from the median than most is an outlier."""
MOST_RESIDUAL = 0.06
"""Of the length of sigma, by what the tracker's scores alone make of a face: the same however an avatar was taught. The
demo clip's face has .01 at rest, .1 while it talks with its lips together."""
MOST_LEARNED_RESIDUAL = 0.12
"""The same by the regressor of an avatar that knows no ARKit shapes."""

NOTHING_SAID = Coaching(())
RestPhase = Literal["coaching", "countdown", "collecting", "done"]


@dataclass(frozen=True)
class Sample:
    """One picture of a face at rest."""

    features: NDArray[np.float32]
    """[D]"""
    rotation: NDArray[np.float64]
    """[3] radians."""


@dataclass(frozen=True)
class RestSession:
    """How far the taking of a neutral is."""

    phase: RestPhase = "coaching"
    coaching: Coaching = NOTHING_SAID
    remaining: float = 0.0
    """Seconds of the countdown or of collecting that are left."""
    samples: tuple[Sample, ...] = ()
    since: float = 0.0
    """When the phase began."""
    green_at: float = 0.0
    """When the coach was last content."""
    last: Observed | None = None
    """The last thing seen: the same again is not counted twice."""

    @property
    def message(self) -> str:
        """What to tell the person now."""
        if self.phase == "coaching":
            return self.coaching.sentences[0] if self.coaching.sentences else "Look at the camera."
        if self.phase == "countdown":
            return f"Look at the camera, mouth closed, face relaxed: {int(np.ceil(self.remaining))}"
        return "Hold still." if self.phase == "collecting" else "Taken."


@dataclass(frozen=True)
class Resting:
    """A neutral that was taken, and what to think of it."""

    choice: NeutralChoice
    noise: NDArray[np.float32]
    """[D] the personal noise floor: how much each feature of this face trembles while it is at rest (one sigma)."""
    residual: float
    """What is left of expression while at rest, in lengths of the avatar's sigma."""
    why: str
    """Why it is not accepted, and what to do; empty when it is."""

    @property
    def accepted(self) -> bool:
        """Whether it may be used."""
        return not self.why


def step(session: RestSession, observed: Observed | None, rate: float, now: float) -> RestSession:
    """The session at the time ``now`` (seconds), when this is what is seen; ``rate``: frames a second."""
    if session.phase == "done":
        return session
    coaching = coach(observed, rate)
    fresh = observed is not None and observed is not session.last
    session = replace(session, coaching=coaching, last=observed, green_at=now if coaching.green else session.green_at)
    if session.phase == "coaching":
        return _begun(session, "countdown", COUNTDOWN_SECS, now) if coaching.green else session
    if session.phase == "countdown":
        if now - session.green_at > GRACE_SECS:
            return replace(session, phase="coaching", remaining=0.0)
        remaining = COUNTDOWN_SECS - (now - session.since)
        return (
            replace(session, remaining=remaining) if remaining > 0 else _begun(session, "collecting", COLLECT_SECS, now)
        )
    if fresh and coaching.green and observed is not None:
        session = replace(session, samples=(*session.samples, Sample(observed.features, observed.rotation)))
    elapsed = now - session.since
    if elapsed >= PATIENCE_SECS or (elapsed >= COLLECT_SECS and len(session.samples) >= FEWEST):
        return replace(session, phase="done", remaining=0.0)
    return replace(session, remaining=max(0.0, COLLECT_SECS - elapsed))


def judge(session: RestSession, avatar: Avatar) -> Resting | None:
    """The neutral of a session that is done; None when it saw too little of a face to speak of one.

    What the collected pictures, relative to the neutral, make of ``avatar`` is what it would do while its driver does
    nothing: by the scores where it knows their shapes, else by its regressor. Raises InputError when it has neither.
    """
    rigged = avatar.gem.arkit_weights is not None
    express = expression_of(avatar, "baseline" if rigged else "learned")
    most = MOST_RESIDUAL if rigged else MOST_LEARNED_RESIDUAL
    samples, blinks = _without_blinks(session.samples)
    if len(samples) < FEWEST:
        return None
    features = np.stack([sample.features for sample in samples])
    rotations = np.stack([sample.rotation for sample in samples])
    kept = _near(features)
    neutral = _middle(features[kept]).astype(np.float32)
    rotation = geometric_median(rotations[kept])
    still = express(np.zeros_like(neutral), np.zeros(3)).coefficients  # a regressor's own leaning is not the driver's
    moved = [
        np.linalg.norm(express(f - neutral, relative_rotation(r, rotation)).coefficients - still)
        for f, r in zip(features[kept], rotations[kept], strict=True)
    ]
    residual = float(np.median(moved) / np.linalg.norm(avatar.gem.sigma))
    reason = (
        f"your face at rest: {int(kept.sum())} pictures, {blinks} blinks and {int((~kept).sum())} outliers left out"
    )
    choice = NeutralChoice(0, 0.0, neutral, rotation, reason, ())
    spread = 1.4826 * np.median(np.abs(features[kept] - np.median(features[kept], axis=0)), axis=0)
    return Resting(choice, spread.astype(np.float32), residual, _why_not(residual, most))


TOO_FEW = "too few pictures of your face at rest were seen; stay in the picture, eyes open, and press N again"
"""What to say where ``judge`` gives None."""


def _why_not(residual: float, most: float) -> str:
    if residual < most:
        return ""
    return (
        f"your face moved while it was taken (residual {residual:.2f}, allowed {most}); hold still, do not"
        " speak, and press N again"
    )


def _begun(session: RestSession, phase: RestPhase, secs: float, now: float) -> RestSession:
    return replace(session, phase=phase, since=now, remaining=secs, samples=())


def _without_blinks(samples: tuple[Sample, ...]) -> tuple[tuple[Sample, ...], int]:
    """The samples with open eyes, and how many were left out."""
    if not samples:
        return (), 0
    lids = [MEASURES.index("right_lid_gap"), MEASURES.index("left_lid_gap")]
    gaps = np.array([sample.features[BLOCKS["measures"]][lids].min() for sample in samples])
    open_eyed = gaps >= CLOSING * np.quantile(gaps, 0.7)
    return tuple(sample for sample, is_open in zip(samples, open_eyed, strict=True) if is_open), int((~open_eyed).sum())


def _near(features: NDArray[np.float32]) -> NDArray[np.bool_]:
    """[n] which of the samples [n, D] are not far from the middle of all."""
    scaled = features / _scale(features)
    distances = np.linalg.norm(scaled - geometric_median(scaled), axis=1)
    return distances <= FAR_OFF * max(float(np.median(distances)), 1e-6)


def _middle(features: NDArray[np.float32]) -> NDArray[np.float64]:
    scale = _scale(features)
    return geometric_median(features / scale) * scale


def _scale(features: NDArray[np.float32]) -> NDArray[np.float64]:
    """[D] one unit for each block, so that distances do not hang on centimetres, radians or scores."""
    scale = np.ones(features.shape[1])
    off = np.abs(features - np.median(features, axis=0))
    for part in BLOCKS.values():
        scale[part] = max(float(off[:, part].mean()), 1e-4)
    return scale
