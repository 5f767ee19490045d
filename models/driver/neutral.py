"""Choosing the frame in which a person's face is at rest: what it shows there is subtracted from every other frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .face import FaceObservation
from .features import BLOCKS, SCORE_NAMES, SCORES, feature_vector, head_rotation
from .measures import MEASURES

CANDIDATES = 6
PLAUSIBLE = 1.0
"""A frame that costs at most this much more than the best might still be taken for the neutral."""
_FLAW, _WEAKNESS = 0.35, 0.05
"""Penalties from which on something is wrong with a frame, and from which on it is worth a word."""
_NEIGHBOURS = 2
"""The neutral's features are the median over this many frames before and behind the chosen one: less noise."""
_LIKE_THE_BEST = 0.15
"""Neighbours join when their cost is at most this much higher."""
_SEAT_DEG = np.array([25.0, 12.0, 20.0])
"""So far (pitch, yaw, roll) a head may be off the camera's axis and be taken to look ahead: cameras stand below or
above a face, seldom beside it; who is turned further aside for most of a clip looks at somebody else."""
_SWAY_DEG = 5.0
"""How far the neutral's head may be from how it sits most of the clip."""
_CLOSED = 0.1
"""A mouth is closed in this part of the frames: on everybody a closed one reads as next to nothing, and no avatar can
close further. One that stood a little open in the frame at rest would be followed only beyond that."""
_FACING = 1.0
"""Frames whose head is turned by at most so much of a penalty say how a closed mouth reads."""
_MOUTH = [SCORES.start + SCORE_NAMES.index("jawOpen"), BLOCKS["measures"].start + MEASURES.index("lip_gap")]
_EXPRESSIONS = (
    *("jawOpen", "mouthSmileLeft", "mouthSmileRight", "mouthPucker", "mouthFunnel", "browInnerUp", "browDownLeft"),
    *("browDownRight", "mouthPressLeft", "mouthPressRight", "mouthUpperUpLeft", "mouthUpperUpRight", "mouthLeft"),
    *("mouthRight", "jawLeft", "jawRight"),
)
_WORDS = {
    "turned": "the head is turned",
    "open_mouth": "the mouth is open",
    "closed_eyes": "the eyes are not fully open",
    "looking_aside": "the eyes look elsewhere than in most of the clip",
    "expression": "the face has an expression",
    "unusual": "the face is not as in most of the clip",
    "blurred": "the picture is blurred",
}


@dataclass(frozen=True)
class Candidate:
    """One frame and what speaks against it."""

    index: int
    """Position in the sequence of observations."""
    time: float
    """Seconds."""
    cost: float
    """Sum of the penalties; 0 is a perfect neutral, above 1 something is wrong."""
    penalties: dict[str, float]
    """Penalty by its name (turned, open_mouth, closed_eyes, looking_aside, expression,
    unusual, blurred), each >= 0."""

    @property
    def flaws(self) -> tuple[str, ...]:
        """What is wrong with it, in words."""
        return tuple(_WORDS[name] for name, penalty in self.penalties.items() if penalty > _FLAW)

    @property
    def weakness(self) -> str:
        """What speaks most against it, in words; empty where nothing does."""
        worst = max(self.penalties, key=self.penalties.__getitem__)
        return _WORDS[worst] if self.penalties[worst] > _WEAKNESS else ""


@dataclass(frozen=True)
class NeutralChoice:
    """The neutral of a clip, why it is the one, and what else could be."""

    index: int
    """Position in the sequence of observations."""
    time: float
    """Seconds."""
    features: NDArray[np.float32]
    """[D] the neutral's feature vector: the frame's, with its mouth as closed as it is in a tenth of the clip."""
    rotation: NDArray[np.float64]
    """[3] the neutral's head rotation, as from ``features.head_rotation``: that of the frame, but near how the head is
    in most of the clip, else an avatar would be bowed or turned throughout."""
    reason: str
    """Why this frame, in words."""
    candidates: tuple[Candidate, ...]
    """At most six, the best first, spread over the clip; the first is the chosen one."""


def choose_neutral(
    observations: Sequence[FaceObservation | None], times: Sequence[float], numbers: Sequence[int | None] | None = None
) -> NeutralChoice:
    """The frame that is frontal, mouth closed, eyes open, without expression, like most of the clip, and sharp.

    A head that is off the camera's axis for most of the clip, as before a camera that stands lower, is frontal there.

    Args:
        observations: one per sampled frame, None where no face was seen.
        times: their times in seconds.
        numbers: which frames of the clip they are, None where that is unknown; for the reason. Default: the first ones.

    Raises:
        ValueError: when no frame shows a face, or the lengths differ.
    """
    faces = _weighed(observations, times)
    costs, chosen = faces.costs, faces.ranking[0]
    best = int(costs.argmin())
    group = np.arange(max(0, best - _NEIGHBOURS), min(len(costs), best + _NEIGHBOURS + 1))
    group = group[costs[group] <= costs[best] + _LIKE_THE_BEST]
    turned = np.median(faces.rotations[group], axis=0)
    rotation = _near_the_seat(turned, faces.rotations)
    features = _with_closed_mouth(np.median(faces.features[group], axis=0), faces, chosen.penalties["turned"])
    number = chosen.index if numbers is None else numbers[chosen.index]
    return NeutralChoice(
        index=chosen.index,
        time=chosen.time,
        features=features,
        rotation=rotation,
        reason=_reason(chosen, faces.rotations[best], rotation, number),
        candidates=_spread(faces.ranking, max(times) - min(times), CANDIDATES),
    )


def other_neutrals(
    observations: Sequence[FaceObservation | None], times: Sequence[float], count: int
) -> tuple[Candidate, ...]:
    """Up to ``count`` other frames that might have been chosen as well, the best first, spread over the clip.

    Their cost is at most PLAUSIBLE above that of the best. Arguments and errors are those of ``choose_neutral``.
    """
    ranking = _weighed(observations, times).ranking
    plausible = [candidate for candidate in ranking if candidate.cost <= ranking[0].cost + PLAUSIBLE]
    return _spread(plausible, max(times) - min(times), count + 1)[1:]


def neutral_of(face: FaceObservation, index: int, time: float, reason: str) -> NeutralChoice:
    """A neutral that somebody chose: a given frame or a picture."""
    return NeutralChoice(index, time, feature_vector(face), head_rotation(face), reason, ())


@dataclass(frozen=True)
class _Weighed:
    """The S frames with a face, in the order of time."""

    features: NDArray[np.float32]
    """[S, D]"""
    rotations: NDArray[np.float64]
    """[S, 3]"""
    costs: NDArray[np.float64]
    """[S]"""
    turned: NDArray[np.float64]
    """[S] the penalty for how far the head is turned, a part of the cost."""
    ranking: list[Candidate]
    """The best first."""


def _weighed(observations: Sequence[FaceObservation | None], times: Sequence[float]) -> _Weighed:
    if len(observations) != len(times):
        raise ValueError(f"{len(observations)} observations with {len(times)} times")
    seen = [(i, face) for i, face in enumerate(observations) if face is not None]
    if not seen:
        raise ValueError(f"no face in any of {len(observations)} frames: a neutral needs at least one")
    features = np.stack([feature_vector(face) for _, face in seen])
    rotations = np.stack([head_rotation(face) for _, face in seen])
    sharpness = np.array([face.sharpness for _, face in seen])
    penalties = _penalties(features, rotations, sharpness)
    costs = np.sum(list(penalties.values()), axis=0)
    ranking = [
        Candidate(seen[i][0], times[seen[i][0]], float(costs[i]), {name: float(p[i]) for name, p in penalties.items()})
        for i in np.argsort(costs, kind="stable")
    ]
    return _Weighed(features, rotations, costs, penalties["turned"], ranking)


def _penalties(
    features: NDArray[np.float32], rotations: NDArray[np.float64], sharpness: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Penalty by name, each [frames] >= 0 and about 1 where the frame is clearly unfit."""
    measures = features[:, BLOCKS["measures"]]
    expressions = features[:, SCORES][:, [SCORE_NAMES.index(name) for name in _EXPRESSIONS]]
    lip_gap = measures[:, MEASURES.index("lip_gap")]
    lid_gap = measures[:, [MEASURES.index("right_lid_gap"), MEASURES.index("left_lid_gap")]].min(1)
    open_lids = np.quantile(lid_gap, 0.7)
    spread = np.median(np.abs(measures - np.median(measures, axis=0)), axis=0) + 0.02
    unusual = (np.abs(measures - np.median(measures, axis=0)) / spread).mean(1)
    degrees = np.degrees(np.abs(rotations - _seat(rotations)))
    gaze = np.degrees(features[:, BLOCKS["gaze"]])
    aside = np.abs(gaze - np.median(gaze, axis=0)).max(1)
    return {
        "turned": (np.maximum(degrees - 4, 0) * [1, 1, 0.7]).sum(1) / 15,
        "open_mouth": np.maximum(lip_gap - 0.15, 0) / 0.5,
        "closed_eyes": np.maximum(0.92 - lid_gap / max(open_lids, 1e-3), 0) / 0.3,
        "looking_aside": np.maximum(aside - 6, 0) / 50,
        "expression": np.maximum(expressions - np.quantile(expressions, 0.1, axis=0), 0).sum(1) / 1.5,
        "unusual": np.maximum(unusual - 1, 0) / 10,
        "blurred": np.maximum(np.log(np.quantile(sharpness, 0.7) + 1e-9) - np.log(sharpness + 1e-9) - 0.2, 0),
    }


def _with_closed_mouth(features: NDArray[np.float32], faces: _Weighed, turned: float) -> NDArray[np.float32]:
    """Features [D] of a rest whose penalty for being turned is ``turned``, its mouth no further open than where it is
    closed."""
    facing = faces.features[faces.turned <= max(turned, _FACING)]
    rest = features.astype(np.float32)
    rest[_MOUTH] = np.minimum(rest[_MOUTH], np.quantile(facing[:, _MOUTH], _CLOSED, axis=0))
    return rest


def _seat(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """[3] how the head [frames, 3] is held most of the time, as far as that may be looking ahead."""
    most = np.radians(_SEAT_DEG)
    with_ahead = np.concatenate([rotations, np.zeros((1, 3))])  # of two frames the one that looks ahead sits so
    return np.clip(np.median(with_ahead, axis=0), -most, most)


def _near_the_seat(rotation: NDArray[np.float64], rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """[3] a rotation no further than it may be from how the head is held most of the time."""
    ends, sway = np.stack([_seat(rotations), np.median(rotations, axis=0)]), np.radians(_SWAY_DEG)
    return np.clip(rotation, ends.min(0) - sway, ends.max(0) + sway)


def _reason(chosen: Candidate, turned: NDArray[np.float64], counted: NDArray[np.float64], number: int | None) -> str:
    """``turned`` [3] is the head in the frame, ``counted`` [3] what is taken for it."""
    which = "the frame" if number is None else f"frame {number}"
    words = f"{which} at {chosen.time:.2f} s: head {_in_degrees(turned)} degrees"
    if np.degrees(np.abs(counted - turned)).max() > _SWAY_DEG:
        words += f" (counted as {_in_degrees(counted)}, nearer to most of the clip)"
    if not chosen.flaws:
        return f"{words}; mouth closed, eyes open, face at rest, sharp"
    return f"{words}; the best there is, but {' and '.join(chosen.flaws)}"


def _in_degrees(rotation: NDArray[np.float64]) -> str:
    pitch, yaw, roll = np.degrees(rotation)
    return f"turned {yaw:+.0f}, nodded {pitch:+.0f}, tilted {roll:+.0f}"


def _spread(ranking: Sequence[Candidate], duration: float, count: int) -> tuple[Candidate, ...]:
    """The best ``count`` of the ranking that are not almost the same moment."""
    apart, chosen = duration / (3 * count), []
    for candidate in ranking:
        if all(abs(candidate.time - other.time) >= apart for other in chosen):
            chosen.append(candidate)
        if len(chosen) == count:
            break
    return tuple(chosen)
