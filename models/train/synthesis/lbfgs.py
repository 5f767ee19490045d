"""L-BFGS (Nocedal and Wright, algorithms 7.4 and 7.5) that can begin with what it learned of a problem alike: in a
video the curvature hardly changes from one frame to the next."""

from collections.abc import Callable

import torch
from torch import Tensor

SUFFICIENT = 1e-4
"""Share of the promised decrease that a step must bring (Armijo) ..."""
CURVED = 0.9
"""... and share of the slope that may be left at its end (Wolfe); a steeper one says that the step was too short."""
TRIALS = 8
"""Lengths tried along one direction before it is given up."""

Objective = Callable[[Tensor], tuple[float, Tensor]]
Memory = tuple[tuple[Tensor, Tensor], ...]
"""Steps and the changes of the gradient along them, oldest first."""


def minimise(
    objective: Objective, start: Tensor, evaluations: int, memory: Memory = (), history: int = 30
) -> tuple[Tensor, float, Memory]:
    """Go downhill from ``start`` [n] for at most so many evaluations of the objective (its value and gradient).

    Returns the lowest point, its value, and the memory to begin a problem alike with. Raises FloatingPointError where
    the objective is not finite at the start.
    """
    point = start.clone()
    value, slope = objective(point)
    if not (value < float("inf") and bool(torch.isfinite(slope).all())):
        raise FloatingPointError(f"the objective is {value} at the start: the input holds values that are not finite")
    pairs, used = list(memory), 1
    while used < evaluations and bool(slope.any()):
        direction = -_newton(slope, pairs)
        descent = float(direction @ slope)
        if descent >= 0:
            pairs, direction = [], -slope
            descent = -float(slope @ slope)
        # without a memory nothing is known of lengths: the first step is one unit long in all
        length = 1.0 if pairs else min(1.0, 1.0 / float(slope.abs().sum()))
        low, high, taken = 0.0, float("inf"), None
        for _ in range(min(TRIALS, evaluations - used)):
            trial = point + length * direction
            reached, there = objective(trial)
            used += 1
            if not reached <= value + SUFFICIENT * length * descent:
                high = length
                # the minimum of the parabola through what is known, within bounds
                curve = 2 * (reached - value - length * descent)
                best = -descent * length**2 / curve if curve > 0 and reached < float("inf") else 0.0
                length = min(max(best, low + 0.1 * (high - low)), low + 0.6 * (high - low))
                continue
            if taken is None or reached < taken[1]:
                taken = trial, reached, there
            if float(there @ direction) >= CURVED * descent:
                break
            low = length
            length = 2.5 * length if high == float("inf") else 0.5 * (low + high)
        if taken is None:
            if not pairs or used >= evaluations:
                break
            pairs = []  # what was learned misleads here
            continue
        step, change = taken[0] - point, taken[2] - slope
        if float(step @ change) > 1e-8 * float(step.norm() * change.norm()):
            pairs = [*pairs, (step, change)][-history:]
        point, value, slope = taken
    return point, value, tuple(pairs)


def _newton(slope: Tensor, pairs: list[tuple[Tensor, Tensor]]) -> Tensor:
    """The gradient times the inverse curvature that the pairs tell of: the two loops."""
    result, shares = slope.clone(), []
    for step, change in reversed(pairs):
        share = float(step @ result) / float(step @ change)
        shares.append(share)
        result -= share * change
    if pairs:
        step, change = pairs[-1]
        result *= float(step @ change) / float(change @ change)
    for (step, change), share in zip(pairs, reversed(shares), strict=True):
        result += step * (share - float(change @ result) / float(step @ change))
    return result
