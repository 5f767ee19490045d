"""How steady an avatar is where its driver does nothing: under noise, while heads turn, under other neutrals."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.crossing.extent import Extent, extent
from ...models.crossing.kept import Kept
from ...models.crossing.loop import answered
from ...models.crossing.mirror import Mirror, UnseenAvatar
from ...models.crossing.neutrals import Swayed, spread_of_correlations, spread_of_means, sway
from ...models.crossing.poseleak import Leak, Turned, leak, turn
from ...models.crossing.still import Jitter, jitter
from ...models.wholefile import file_sha256
from ..library import avatars
from ..performing.casting import open_avatar
from ..person.following import EXPRESSION_FILTER
from .drivers import Tracked
from .entrants import Entrant
from .trials import SIZE, Trial


@dataclass(frozen=True)
class Robustness:
    """Of one avatar by one way of driving it."""

    expression: Extent
    """Of the coefficients over all clips, away from what a neutral gives: what the others are held to."""
    jitter: dict[str, Jitter]
    """Driver -> while he stands still; without those whom the tracker loses under noise."""
    leaks: dict[str, Leak]
    """Avatar whose head turns -> what leaks into the expression; without those that the tracker does not see."""
    correlations: dict[str, NDArray[np.float64]]
    """Driver -> [channels] standard deviation of the correlations over neutrals."""
    means: dict[str, Extent]
    """Driver -> spread of the mean coefficients over neutrals."""
    neutrals: dict[str, int]
    """Driver -> how many there are beside the chosen one."""


def robustness(
    trial: Trial,
    clips: Sequence[Tracked],
    coefficients: Sequence[NDArray[np.float32]],
    heads: Mapping[str, Turned],
    kept: Kept,
    begin: Callable[[str, int], Callable[[], None]],
) -> Robustness:
    """Tries all; what was tried before is not tried again. Raises InputError, UnseenAvatar, OSError.

    Args:
        trial: who is driven, and how.
        clips: by whom.
        coefficients: [F, n] what each clip made of it.
        heads: avatar -> its head turning.
        kept: what was done before.
        begin: told what begins and how many parts it has; gives what is called after each part.
    """
    gem, express = trial.gem, trial.express
    away: list[NDArray[np.float32]] = []
    jitters: dict[str, Jitter] = {}
    correlations: dict[str, NDArray[np.float64]] = {}
    means: dict[str, Extent] = {}
    for tracked, answers in zip(clips, coefficients, strict=True):
        at_rest = answered(express, tracked.clip.neutral, tracked.clip.neutral).coefficients
        away.append((answers - at_rest).astype(np.float32))
        still = tracked.still(kept)
        if still is not None:
            jitters[tracked.name] = jitter(still, tracked.clip.neutral, express, gem, EXPRESSION_FILTER)
        advance = begin(f"{tracked.name}, other neutrals", len(tracked.clip.others) + 1)
        swayed = kept.get(
            "neutrals",
            [*tracked.made_of, *trial.made_of],
            Swayed,
            lambda clip=tracked.clip, advance=advance: sway(clip, express, trial.mirror, advance),
        )
        correlations[tracked.name] = spread_of_correlations(swayed)
        means[tracked.name] = spread_of_means(swayed, gem)
    return Robustness(
        expression=extent(np.concatenate(away), gem),
        jitter=jitters,
        leaks={name: leak(turned, express, gem) for name, turned in heads.items()},
        correlations=correlations,
        means=means,
        neutrals={tracked.name: len(tracked.clip.others) for tracked in clips},
    )


def turning_heads(entrant: Entrant, kept: Kept) -> dict[str, Turned]:
    """The avatar itself while its head turns, and a shipped one beside it; without those that the tracker does not see.

    Raises InputError, OSError.
    """
    own = entrant.column.sha256
    heads: list[tuple[str, Path, str]] = [(entrant.column.name, entrant.path, own)]
    for entry in avatars():
        sha256 = file_sha256(entry.path) if entry.shipped else own
        if sha256 != own:
            heads.append((f"{entry.name}, shipped", entry.path, sha256))
            break
    found: dict[str, Turned] = {}
    for name, path, sha256 in heads:
        try:
            found[name] = kept.get(
                "turned", [sha256, SIZE], Turned, lambda path=path: turn(Mirror(open_avatar(path).gem, SIZE))
            )
        except UnseenAvatar:
            continue
    return found
