"""The closed loop as a loss: what is read on a person shall be read on the avatar that repeats it."""

from collections.abc import Callable, Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from ..threads import one_torch_thread
from ..workers import ALONE, Advance, Workers
from .channels import channel_indices, channel_tolerances, felt
from .controls import UNBOUNDED
from .network import RegressorNetwork
from .response import HUBER
from .strangers import Crowd, Person

BATCH = 256
PRIOR = 0.3
"""Price of one unit of weight away from the unlearned start, in squared tolerances, where nobody knows what the people
act ..."""
ACTED = 3.0
"""... and away from what they do act, where that is known. What is read on a face can be had of an avatar in many ways,
most of which no face makes: without this brows rose and eyes widened to mend what was missed of a smile."""
ONE_SIDED = 4.0
"""The same for one unit by which the two halves of a face move apart more than the start moves them. What is read on
each half trembles by itself; a mouth that goes awry is the first thing that people see."""
STILLNESS = 15.0
"""The same for one unit of any weight where nothing but the head moves. Without it a face at rest followed what light,
framing and a turned head do to what is read. Dearer stillness costs small movements, lowered brows and pursed lips
first."""
EXCESS = 20.0
"""Price of a weight beyond its bounds."""
BELOW = 0.5
"""Share of what falls deeper below people's rest than networks heed (``Controls.least``) that avatars shall follow.
Their own rests read as next to nothing, so that they hardly can, and what they pay for it other channels lack; with
none of it, puckers were followed less."""
LABELS = 1.0
"""Price of missing the known weights on the avatar's own pictures."""
STRIDE, STRIDES = 0.1, 120
"""The first step of the descent to the best weights, and how many there are, each smaller than the one before."""
AT_ONCE = 1000
"""So many moments descend together; each goes its own way."""


class ClosedLoop:
    """Needs no labels of people: the avatar's response, which is known, says what its weights should have been."""

    def __init__(self, network: RegressorNetwork, own: Person, people: Crowd, resting: Crowd | None = None) -> None:
        """
        Args:
            network: learns.
            own: the avatar, whose weights are known.
            people: whom to follow.
            resting: moments in which nothing but the head moves; None takes those among the people.
        """
        self._network, self._responses = network, (own.response, *own.doubters)
        self._wanted = felt(_eased(torch.from_numpy(people.wanted), network.least))
        self._known = torch.from_numpy(own.seen.weights)
        self._seen = (torch.from_numpy(people.features), torch.from_numpy(people.rotations))
        self._people = network.inputs(*self._seen)
        acted = torch.from_numpy(people.acted)
        known = ~acted.isnan()
        self._aims = torch.where(known, network.bounded(acted), self._people[1])
        self._prices = torch.where(known, ACTED, PRIOR)
        rests = torch.from_numpy(np.flatnonzero(people.resting))
        self._resting = tuple(array[rests] for array in self._people)
        if resting is not None:
            self._resting = network.inputs(torch.from_numpy(resting.features), torch.from_numpy(resting.rotations))
        self._own = network.inputs(torch.from_numpy(own.seen.features), torch.from_numpy(own.seen.seen_rotations))
        self._turns = torch.from_numpy(people.turns)

    def mismatch(self, members: Sequence[RegressorNetwork] = ()) -> float:
        """Mean Huber distance of what the avatar's expression adds to its channels from what the people's add to
        theirs, in tolerances; the mean of what all responses say. ``members``: networks whose mean answer counts,
        instead of the one."""
        with torch.no_grad():
            weights = torch.stack([one.weights(*self._seen) for one in members or (self._network,)]).mean(0)
            got = [self._shown(weights, self._turns, one) for one in range(len(self._responses))]
            misses = [nn.functional.huber_loss(read, self._wanted, delta=HUBER) for read in got]
            return float(torch.stack(misses).mean())

    def loss(self, step: int = 0) -> Tensor:
        """Of a random batch; each ``step`` asks another response: what only one of them promises does not last."""
        network = self._network
        batch = torch.randint(len(self._wanted), (BATCH,))
        inputs, start = (array[batch] for array in self._people)
        free = network.steered(inputs, start)
        loss = self._missed(free, start, batch, step % len(self._responses)).mean()
        if len(self._resting[0]):
            rest = torch.randint(len(self._resting[0]), (BATCH // 2,))
            still = network.bounded(network.steered(*(array[rest] for array in self._resting)))
            loss = loss + STILLNESS * (still**2).mean()
        known = torch.randint(len(self._known), (BATCH // 2,))
        labelled = network.steered(*(array[known] for array in self._own))
        return loss + LABELS * ((labelled - self._known[known]) ** 2).mean()

    def best(self, workers: Workers = ALONE) -> NDArray[np.float32]:
        """[S, E] the control weights with which the avatar follows each moment of the people best, as the mean of all
        responses knows it and at the same prices: what a network strives for, and what it never sees whole.

        Found by descent (Adam). Where responses err, this is the first to run into it. Raises WorkerLost.
        """
        parts = [(self, slice(first, first + AT_ONCE)) for first in range(0, len(self._wanted), AT_ONCE)]
        return np.concatenate(workers.each(_best, parts))

    @one_torch_thread()
    def best_of(self, rows: slice) -> NDArray[np.float32]:
        """The same for the moments ``rows``."""
        network, start = self._network, self._people[1][rows]
        ways = torch.zeros_like(start, requires_grad=True)
        optimizer = torch.optim.Adam([ways], STRIDE)
        schedule = torch.optim.lr_scheduler.LinearLR(optimizer, 1.0, 1 / STRIDES, STRIDES)
        for _ in range(STRIDES):
            free = network.moved(start, ways)
            asked = [self._missed(free, start, rows, one) for one in range(len(self._responses))]
            optimizer.zero_grad()
            torch.stack(asked).mean(0).sum().backward()
            optimizer.step()
            schedule.step()
        with torch.no_grad():
            return network.bounded(network.moved(start, ways)).numpy()

    def _missed(self, free: Tensor, start: Tensor, rows: Tensor | slice, one: int) -> Tensor:
        """[B] what weights [B, E], not clipped yet, cost that begin at ``start`` and shall follow moments ``rows``."""
        network, wanted = self._network, self._wanted[rows]
        bounded = network.bounded(free)
        # a weight outside its bounds keeps a little gradient, or it would never come back
        got = self._shown(bounded + 0.05 * (free - bounded), self._turns[rows], one)
        missed = nn.functional.huber_loss(got, wanted, delta=HUBER, reduction="none").mean(1)
        moved = bounded - start
        missed = missed + (self._prices[rows] * (bounded - self._aims[rows]) ** 2).mean(1)
        missed = missed + EXCESS * ((free - bounded) ** 2).mean(1)
        if len(network.pairs):
            left, right = network.pairs.T
            missed = missed + ONE_SIDED * ((moved[:, left] - moved[:, right]) ** 2).mean(1)
        return missed

    def _shown(self, weights: Tensor, turns: Tensor, one: int) -> Tensor:
        """What is read on the avatar with its head turned, relative to itself at rest and turned alike, as one of the
        responses knows it."""
        response = self._responses[one]
        with torch.no_grad():
            rest = response(torch.zeros_like(weights), turns)
        return felt(response(weights, turns) - rest)


def _eased(wanted: Tensor, least: Tensor) -> Tensor:
    """Channels [S, T], in tolerances, with what of them is below the ``least`` [D] that is heeded cut to BELOW."""
    heeded = least[torch.from_numpy(channel_indices())] / torch.from_numpy(channel_tolerances())
    heeded = heeded.clamp(min=UNBOUNDED)  # by a tolerance below 1 it is -inf, of which there is no share
    return torch.where(wanted < heeded, heeded + BELOW * (wanted - heeded), wanted)


def _best(advance: Advance, loop: ClosedLoop, rows: slice) -> NDArray[np.float32]:
    found = loop.best_of(rows)
    advance()
    return found


@one_torch_thread()
def descend(
    network: RegressorNetwork, loss: Callable[[int], Tensor], steps: int, progress: Callable[[str, int, int], None]
) -> None:
    """Trains a network in place; ``loss`` is asked with the number of the step."""
    optimizer = torch.optim.AdamW(network.parameters(), 1e-3, weight_decay=1e-3, fused=True)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    for step in range(steps):
        value = loss(step)
        optimizer.zero_grad()
        value.backward()
        optimizer.step()
        schedule.step()
        progress("regressor", step + 1, steps)
