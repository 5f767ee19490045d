"""What a regressor steers: bounded weights, and what each adds to an avatar's coefficients."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...arkit import NAMES, PARTNERS
from ...driver.baseline import GAIN
from ...driver.features import SCORE_NAMES
from ...gem import CLAMP_SIGMAS, Gem

ARKIT_REACH = 0.7
"""How far training may move an ARKit weight from the tracker's own reading of it."""
UP_DOWN_REACH, SIDEWAYS_REACH = 0.5, 0.3
"""The same for gaze: looking aside is read well as it is, and only corrected for what lids and cheeks do to it; looking
up and down moves the lids, which the scores do not tell from the eyes."""
UNREAD = tuple(name for name in NAMES if name not in SCORE_NAMES)
"""The tracker reads these on nobody. They stay still: training knows nothing of what they should do, and would pull
faces with them to mend what it misses elsewhere."""
HARDLY_READ_REACH = 0.25
HARDLY_READ = (
    "jawLeft",
    "jawRight",
    "mouthDimpleLeft",
    "mouthDimpleRight",
    "mouthLeft",
    "mouthRight",
    "mouthShrugLower",
    "mouthShrugUpper",
)
"""Shapes whose scores hardly answer. Lips that part, press or roll are read as badly, but their distance says more."""
_TOGETHER = tuple(
    tuple(NAMES.index(f"eyeLook{name}") for name in pair)
    for pair in (("OutLeft", "InRight"), ("InLeft", "OutRight"), ("UpLeft", "UpRight"), ("DownLeft", "DownRight"))
)
"""Both eyes look at one thing: they start from the mean of what is read on the two, with less of the noise, and
training moves them as one. Each by itself would squint where that is read a little better; no correlation shows it."""

STRAIGHT = 0.8
"""Of 3 sigma: as far as this, ARKit weights make the coefficients that they stand for. Equation 4's tanh bends from the
first: of a whole smile it leaves .87, of a raised upper lip .74, so that no training could make an avatar laugh; this
leaves .99 and .82 (the middle of three avatars, ``tests/bench/mouths.py``)."""
DEEPEST = 0.025
"""So far below their rest's scores of what people do are heeded, but for those of gaze. A rest may read as pursed or
raised; a smile then takes that back, which says no more than that it smiles. Avatars' rests read as next to nothing:
what falls further no training has seen, and networks made frowns of it. Of twice as much Theo's made raised brows and
rolled lips where a stranger turned his head, whose rest had read as a kiss."""
UNBOUNDED = float(np.finfo(np.float32).min)
"""Least relative score of what is heeded however far it falls."""
_NEARLY_ONE = 0.9999
"""Of 3 sigma: what is nearer to it cannot be told from it."""
_RIDGE = 1e-6
"""Of the mean square of a weight's moves: a shape that moves nothing is not moved."""


@dataclass(frozen=True)
class Controls:
    """E weights: the 52 ARKit weights for an avatar with an ARKit map, else coefficients in sigmas from rest."""

    lower: NDArray[np.float32]
    """[E] least weight."""
    upper: NDArray[np.float32]
    """[E] greatest weight."""
    reach: NDArray[np.float32]
    """[E] greatest distance from the unlearned start."""
    pairs: NDArray[np.int64]
    """[Q, 2] weights of the same movement of a face's left and right half."""
    leaders: NDArray[np.int64]
    """[E] the weight whose learned movement each makes: its own, or that of the other eye."""
    start: NDArray[np.float32]
    """[scores, E] the unlearned reading of relative scores as weights, before clipping to the bounds."""
    to_coefficients: NDArray[np.float32]
    """[E, coefficients] what one unit of each weight adds to the rest coefficients."""
    rest: NDArray[np.float32]
    """[coefficients] the neutral expression."""
    limit: NDArray[np.float32]
    """[coefficients] 3 sigma."""
    straight: float = 0.0
    """Share of the limit, below 1, up to which coefficients are what the weights stand for; the rest of the way they
    approach it as tanh does. 0 is equation 4 to the letter."""
    least: NDArray[np.float32] = field(default_factory=lambda: np.full(len(SCORE_NAMES), UNBOUNDED, np.float32))
    """[scores] least relative score that is heeded."""

    def coefficients(self, weights: NDArray[np.float32]) -> NDArray[np.float32]:
        """Coefficients [..., coefficients] of weights [..., E], softly limited to 3 sigma."""
        free = (self.rest + weights @ self.to_coefficients) / self.limit
        core, left = np.clip(free, -self.straight, self.straight), np.float32(1 - self.straight)
        return (self.limit * (core + left * np.tanh((free - core) / left))).astype(np.float32)

    def weights(self, coefficients: NDArray[np.float32]) -> NDArray[np.float32]:
        """Weights [S, E] within their bounds that give coefficients [S, coefficients], by least squares; the nearer a
        coefficient is to its limit, the less it tells."""
        shares = np.clip(np.asarray(coefficients, float) / self.limit, -_NEARLY_ONE, _NEARLY_ONE)
        core, left = np.clip(shares, -self.straight, self.straight), 1 - self.straight
        bent = (shares - core) / left
        trust = (1 - bent**2) ** 2
        free = core + left * np.arctanh(bent) - self.rest / self.limit
        moves = self.to_coefficients.astype(float) / self.limit
        normal = np.einsum("ek,sk,fk->sef", moves, trust, moves, optimize=True)
        normal += _RIDGE * np.eye(len(moves)) * np.trace(normal, axis1=1, axis2=2)[:, None, None] / len(moves)
        found = np.linalg.solve(normal, ((trust * free) @ moves.T)[..., None])[..., 0]
        return np.clip(found, self.lower, self.upper).astype(np.float32)


def controls_of(gem: Gem) -> Controls:
    """The controls of an avatar."""
    if gem.arkit_weights is None:
        return free_controls(gem)
    start = np.zeros((len(SCORE_NAMES), len(NAMES)), np.float32)
    for column, name in enumerate(NAMES):
        if name in SCORE_NAMES:
            start[SCORE_NAMES.index(name), column] = GAIN
    leaders = np.arange(len(NAMES))
    for pair in _TOGETHER:
        start[:, pair] = start[:, pair].mean(1, keepdims=True)
        leaders[list(pair)] = pair[0]
    ones = np.ones(len(NAMES), np.float32)
    reach = np.array([_reach(name) for name in NAMES], np.float32)
    return Controls(
        0 * ones,
        ones,
        reach,
        np.array(PARTNERS),
        leaders,
        start,
        np.asarray(gem.arkit_weights, np.float32),
        gem.rest_coefficients,
        CLAMP_SIGMAS * gem.sigma,
        STRAIGHT,
        np.array([UNBOUNDED if name.startswith("eyeLook") else -DEEPEST for name in SCORE_NAMES], np.float32),
    )


def _reach(name: str) -> float:
    if name.startswith(("eyeLookUp", "eyeLookDown")):
        return UP_DOWN_REACH
    if name.startswith("eyeLook"):
        return SIDEWAYS_REACH
    if name in UNREAD:
        return 0.0
    return HARDLY_READ_REACH if name in HARDLY_READ else ARKIT_REACH


def free_controls(gem: Gem) -> Controls:
    """The coefficients themselves, each for itself: more than ARKit weights can say, and equation 4 to the letter.

    Where the avatar has an ARKit map, the unlearned start is still its reading of the scores.
    """
    count, sigma = gem.coefficient_count, np.maximum(gem.sigma, 1e-12)
    bound = np.full(count, CLAMP_SIGMAS, np.float32)
    start = np.zeros((len(SCORE_NAMES), count), np.float32)
    if gem.arkit_weights is not None:
        for row, name in enumerate(SCORE_NAMES):
            if name in NAMES:
                start[row] = GAIN * gem.arkit_weights[NAMES.index(name)] / sigma
    return Controls(
        -bound,
        bound,
        bound,
        np.empty((0, 2), np.int64),
        np.arange(count),
        start,
        np.diag(sigma).astype(np.float32),
        gem.rest_coefficients,
        CLAMP_SIGMAS * gem.sigma,
    )
