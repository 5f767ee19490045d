"""The closed loop as a loss: what is read on a person shall be read on the avatar that repeats it."""

from collections.abc import Callable

import torch
from torch import Tensor

from .network import RegressorNetwork
from .strangers import Crowd, Person

BATCH = 256
PRIOR = 0.3
"""Price of one unit of weight away from the unlearned start, in squared tolerances."""
EXCESS = 20.0
"""Price of a weight beyond its bounds."""
LABELS = 2.0
"""Price of missing the known weights on the avatar's own pictures."""
HUBER = 3.0
"""Beyond so many tolerances a mismatch grows linearly only: the avatar may be unable to do what the person does."""


class ClosedLoop:
    """Needs no labels of people: the avatar's response, which is known, says what its weights should have been."""

    def __init__(self, network: RegressorNetwork, own: Person, people: Crowd) -> None:
        """``own``: the avatar, whose weights are known; ``people``: whom to follow."""
        self._network, self._response = network, own.response
        self._people = tuple(torch.from_numpy(array) for array in (people.features, people.rotations, people.wanted))
        seen = own.seen
        self._own = tuple(torch.from_numpy(array) for array in (seen.features, seen.rotations, seen.weights))
        self._rest = self._shown(torch.zeros(1, seen.weights.shape[1]))

    def mismatch(self, people: Crowd) -> float:
        """Mean Huber distance of the avatar's channels from what people's would read from the front, in tolerances."""
        features, rotations = torch.from_numpy(people.features), torch.from_numpy(people.rotations)
        with torch.no_grad():
            got = self._shown(self._network.weights(features, rotations)) - self._rest
            return float(torch.nn.functional.huber_loss(got, torch.from_numpy(people.wanted), delta=HUBER))

    def loss(self, step: int = 0) -> Tensor:
        """Of a random batch, the same for every ``step``."""
        network, people, own = self._network, self._people, self._own
        batch = torch.randint(len(people[0]), (BATCH,))
        r, turn, wanted = (array[batch] for array in people)
        free = network.free_weights(r, turn)
        bounded = network.bounded(free)
        # a weight outside its bounds keeps a little gradient, or it would never come back
        got = self._shown(bounded + 0.05 * (free - bounded)) - self._rest
        loss = torch.nn.functional.huber_loss(got, wanted, delta=HUBER)
        start = network.started(r)
        loss = loss + PRIOR * ((bounded - start) ** 2).mean() + EXCESS * ((free - bounded) ** 2).mean()
        known = torch.randint(len(own[0]), (BATCH // 2,))
        labelled = network.free_weights(own[0][known], own[1][known])
        return loss + LABELS * ((labelled - own[2][known]) ** 2).mean()

    def _shown(self, weights: Tensor) -> Tensor:
        """What is read on the avatar from the front."""
        return self._response(weights, torch.zeros(len(weights), 3))


def descend(
    network: RegressorNetwork, loss: Callable[[int], Tensor], steps: int, progress: Callable[[str, int, int], None]
) -> None:
    """Trains a network in place; ``loss`` is asked with the number of the step."""
    optimizer = torch.optim.AdamW(network.parameters(), 1e-3, weight_decay=1e-3)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, steps)
    for step in range(steps):
        value = loss(step)
        optimizer.zero_grad()
        value.backward()
        optimizer.step()
        schedule.step()
        progress("regressor", step + 1, steps)
