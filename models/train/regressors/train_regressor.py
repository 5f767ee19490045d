"""Trains the regressor of one avatar by closing the loop: what is read on a person shall be read on the avatar.

F, an avatar's response, is learned first: control weights to tracked channels, from pictures of the avatar. The
regressor g is then trained on relative features r of avatars and invented people (no labels) so that F(g(r)) matches r.
Before, the avatar acts several times what F says would follow people best, before the tracker, and F is learned again
with these pictures, too. A committee of g ships. It acts for portraits, of which is learned how the head has to turn.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from ...driver.regressor import Regressor, RegressorError
from ...gem import Gem
from ...gemfile import load_gem
from ..workers import ALONE, Advance, Workers
from .bystanders import heads_beside, leaks_of_bystanders
from .closing import ClosedLoop, descend
from .controls import Controls, controls_of
from .export_onnx import export_onnx
from .export_turns import with_turns
from .expressions import random_coefficients, random_weights
from .footage import read_footage
from .leaks import Leaks
from .network import RegressorNetwork
from .reduction import Reduction, compared_channels
from .rehearsal import answers_of, rehearse, remembered
from .response import PORTRAIT, ResponseModel, Responses, at_rest, fit_response, joined
from .series import LENGTH, Series, draw_series
from .strangers import Crowd, Person, crowd, in_tolerances
from .turns import PORTRAITS, learned_turns

CROWD = 120_000
"""Moments of invented people to follow, so many that a network that is trained three times as long does not learn them
by heart: with 40,000 more steps followed the avatars better and people worse."""
RESTS = 40_000
"""Moments in which nothing but the head moves. The few among the others a network would learn by heart, and heads of
strangers that turn would move its avatar."""
JUDGING = 2000
"""The same held out of training."""
REHEARSALS = 5
"""So often the avatar acts before the tracker. First what the regressor answers that it has, if it has one: that was
taught well already. Else what its response says would follow best, found by descent: there every error of the response
shows, which a network that was taught with it hardly finds."""
REHEARSED = 1.0
"""Pictures that it acts in each time, against the random ones, which say little of the faces that strangers ask for."""
FEWEST_OF_STRANGERS = 200
"""Pictures of each companion, however few there are of the avatar."""
RESTING = 0.12
"""Of an avatar's pictures so many show it at rest while its head turns: most of the time people do no more."""
RESPONSES = 3
"""So many models of the avatar's response, each learned with random numbers of its own, judge the regressor in turn: it
would find out where a single one errs. Of strangers, one says what to do."""
COMMITTEE = 3
"""So many networks ship, each trained from random numbers of its own; the mean of their answers counts, in which what
only one of them sees in a face it never saw is a third."""
Progress = Callable[[str, int, int], None]


def _silent(done: int, total: int) -> None:
    """Tells nobody."""


@dataclass(frozen=True)
class Former:
    """What an avatar has learned before."""

    regressor: Regressor
    controls: Controls
    """Of that avatar: what its coefficients mean."""


@dataclass(frozen=True)
class TrainingReport:
    """What a training reached."""

    pictures: int
    """Pictures of the avatar that its response was learned from."""
    response_r2: float
    """Share of the channels' variance that the response model explains on pictures it never saw."""
    start_mismatch: float
    """Mean mismatch between people and avatar, in tolerances, by the unlearned start ..."""
    end_mismatch: float
    """... and by the trained regressor, on moments of invented people held out of training."""


def train_regressor(
    avatar: Path,
    *,
    companions: Sequence[Path] = (),
    videos: Sequence[Path] = (),
    former: Path | None = None,
    pictures: int = 4000,
    steps: int = 9000,
    seed: int = 0,
    progress: Progress = lambda stage, done, total: None,
    jobs: int = 1,
) -> tuple[Gem, TrainingReport]:
    """Trains a regressor for ``avatar``, and gives the avatar with it.

    Args:
        avatar: a .gem file.
        companions: other avatars, which play strangers.
        videos: any videos of faces, unlabelled; they need not be of one person.
        former: an avatar of the same shapes whose regressor the first rehearsal plays; None: that of ``avatar``, where
            it has one.
        pictures: how many pictures of the avatar with random faces are drawn and read, besides those of what it has
            learned; of each companion as many.
        steps: training steps of each network that ships, and of the response models that teach it; those that only
            rehearse, and the companions', take a third.
        seed: makes the run repeatable.
        progress: called with the stage's name, steps done and steps in all.
        jobs: processes that draw pictures and teach networks; what is learned does not depend on it.

    Raises:
        GemFormatError: for a file that is no avatar.
        RegressorError: where ``former`` has no regressor of use.
        AvatarNotSeen: where the tracker finds no face in the avatar's picture.
        WorkerLost: where one of the processes is gone.
    """
    gem = load_gem(avatar)
    role = None if former is None else _former(load_gem(former), gem)
    others = [load_gem(path) for path in companions]
    footage = read_footage(videos, lambda done, total: progress("videos", done, total))
    with Workers(jobs) as workers:
        regressor, report = regressor_for(
            gem,
            others,
            footage,
            former=role,
            pictures=pictures,
            steps=steps,
            seed=seed,
            progress=progress,
            workers=workers,
        )
    return replace(gem, regressor=regressor), report


def regressor_for(
    gem: Gem,
    companions: Sequence[Gem],
    footage: NDArray[np.float32],
    *,
    former: Former | None = None,
    pictures: int,
    steps: int,
    seed: int,
    progress: Progress = lambda stage, done, total: None,
    workers: Workers = ALONE,
) -> tuple[bytes, TrainingReport]:
    """The ONNX graph of a regressor for ``gem``, and how well it does. ``footage`` as read_footage gives it;
    ``former``: what the first rehearsal plays instead of the regressor that ``gem`` has."""
    rng, controls = np.random.default_rng(seed), controls_of(gem)
    own = pictures_of(gem, pictures, seed, lambda done, total: progress("pictures", done, total), workers)
    count = max(FEWEST_OF_STRANGERS, pictures)
    brief = max(1, steps // 3)
    # the avatar's own faces: what strangers do is then what the avatar's response knows best, lowered brows above all
    seen = [
        pictures_of(one, count, seed, lambda done, total: progress("strangers", done, total), workers)
        for one in companions
    ]
    others = [
        person_of(one, brief, seed, arkit=companion.arkit_weights is not None)[0]
        for one, companion in zip(seen, companions, strict=True)
    ]
    arkit = gem.arkit_weights is not None
    leaks = leaks_of_bystanders(
        [gem, *companions],
        seed,
        heads_beside(pictures),
        lambda done, total: progress("turning heads", done, total),
        workers,
    )
    practised = former or _practised(gem)
    for _ in range(REHEARSALS):
        avatar, _ = person_of(own, brief, seed, RESPONSES if practised is None else 1, workers, arkit)
        audience = crowd([avatar, *others], leaks, footage, max(1, int(pictures * REHEARSED)), rng)
        if practised is not None:
            answers, practised = remembered(practised.regressor, practised.controls, audience), None
        else:
            untaught = RegressorNetwork(compared_channels(own.features), controls)
            answers = ClosedLoop(untaught, avatar, audience).best(workers)
        acted = rehearse(
            gem, controls, answers, audience, rng, lambda done, total: progress("rehearsal", done, total), workers
        )
        own = joined([own, acted])
    # as long as the networks: whatever it is wrong about, they learn
    avatar, r2 = person_of(
        own, steps, seed, RESPONSES, workers, arkit, lambda done, total: progress("response", done, total)
    )
    school = _School(controls, [avatar, *others], leaks, footage, rng)
    before = school.mismatch([RegressorNetwork(school.reduction, controls)])
    members = school.networks(steps, [seed + one for one in range(COMMITTEE)], progress, workers)
    audience = school.people(max(1, int(pictures * PORTRAITS)))
    answers = np.mean([answers_of(one, audience) for one in members], 0)
    portraits = rehearse(
        gem, controls, answers, audience, rng, lambda done, total: progress("portraits", done, total), workers, PORTRAIT
    )
    graph = with_turns(export_onnx(members), learned_turns(portraits, steps, seed, workers).poses)
    return graph, TrainingReport(len(own), r2, before, school.mismatch(members))


def _practised(gem: Gem) -> Former | None:
    """What an avatar has learned; None where it has no regressor that can be used, which is why it is trained again."""
    try:
        return None if gem.regressor is None else Former(Regressor.of(gem), controls_of(gem))
    except RegressorError:
        return None


def _former(other: Gem, gem: Gem) -> Former:
    """What ``other`` has learned, for an avatar of the same shapes. Raises RegressorError."""
    if other.arkit_weights is None or gem.arkit_weights is None:
        raise RegressorError(
            f"avatar '{gem.name}' cannot rehearse with what '{other.name}' has learned: only avatars with ARKit shapes"
            " do the same with the same weights; leave out --rehearse-with"
        )
    if other.regressor is None:
        raise RegressorError(f"avatar '{other.name}' has no regressor to rehearse with; name one that has")
    return Former(Regressor.of(other), controls_of(other))


class _School:
    """What a regressor learns from: the avatar, which is the first of the ``cast``, the others, what the turn of other
    heads adds, and footage."""

    def __init__(
        self,
        controls: Controls,
        cast: Sequence[Person],
        leaks: Leaks,
        footage: NDArray[np.float32],
        rng: np.random.Generator,
    ) -> None:
        self._controls, self._cast, self._leaks, self._footage, self._rng = controls, cast, leaks, footage, rng
        self._crowd, self._judges = self.people(CROWD), self.people(JUDGING)
        self._rests = self._resting(RESTS)
        self.reduction = compared_channels(np.concatenate([cast[0].seen.features, self._crowd.features[:8000]]))

    def people(self, count: int) -> Crowd:
        """``count`` moments of invented people.

        Each picture as often as any other: there are many more of the avatar than of others, and what is shown over
        and over again is learned by heart.
        """
        return crowd(self._cast, self._leaks, self._footage, count, self._rng, by_pictures=True)

    def _resting(self, count: int) -> Crowd | None:
        """``count`` moments of the same at rest; None where there is no picture of that."""
        still = [replace(one, seen=one.seen.only(at_rest(one.seen.weights))) for one in self._cast]
        still = [one for one in still if len(one.seen)]
        return crowd(still, self._leaks, self._footage[:0], count, self._rng) if still else None

    def networks(
        self, steps: int, seeds: Sequence[int], progress: Progress, workers: Workers = ALONE
    ) -> list[RegressorNetwork]:
        """Networks, each trained from random numbers of its own."""
        lessons = _Lessons(self._controls, self.reduction, self._cast[0], self._crowd, self._rests)
        total = steps * len(seeds)
        return workers.each(
            _taught, [(lessons, steps, seed) for seed in seeds], lambda done: progress("regressor", done, total)
        )

    def mismatch(self, members: Sequence[RegressorNetwork]) -> float:
        """Of the mean of their answers, on people held out of training."""
        return ClosedLoop(members[0], self._cast[0], self._judges).mismatch(members)


@dataclass(frozen=True)
class _Lessons:
    """What a network is trained with."""

    controls: Controls
    reduction: Reduction
    avatar: Person
    people: Crowd
    resting: Crowd | None


def _taught(advance: Advance, lessons: _Lessons, steps: int, seed: int) -> RegressorNetwork:
    torch.manual_seed(seed)
    network = RegressorNetwork(lessons.reduction, lessons.controls)
    loop = ClosedLoop(network, lessons.avatar, lessons.people, lessons.resting)
    descend(network, loop.loss, steps, lambda stage, done, total: advance())
    return network


def pictures_of(
    gem: Gem, count: int, seed: int, progress: Callable[[int, int], None] = _silent, workers: Workers = ALONE
) -> Responses:
    """``count`` pictures of an avatar with random faces, and at rest, as the tracker reads them; fewer where no face is
    seen.

    Whole series are the same in however many pictures. Raises AvatarNotSeen, WorkerLost.
    """
    controls = controls_of(gem)
    series: list[Series] = []
    for first in range(0, count, LENGTH):
        rng = np.random.default_rng([seed, first])
        weights = (
            random_coefficients(controls, LENGTH, rng) if gem.arkit_weights is None else random_weights(LENGTH, rng)
        )
        weights = weights[: count - first]
        weights[len(weights) - int(RESTING * len(weights)) :] = 0
        series.append(Series(weights, rng))
    return draw_series(gem, controls, series, progress, workers)


def person_of(
    seen: Responses,
    steps: int,
    seed: int,
    responses: int = 1,
    workers: Workers = ALONE,
    arkit: bool = False,
    progress: Callable[[int, int], None] = _silent,
) -> tuple[Person, float]:
    """An avatar with its response F, learned from its pictures ``responses`` times, and the share of variance that the
    first of them explains. ``arkit``: its control weights are those of ARKit's shapes. ``progress``: called with how
    many are learned, and of how many. Raises WorkerLost."""
    channels = in_tolerances(seen.features)
    lessons = [(seen.weights, seen.rotations, channels, steps, seed + one) for one in range(responses)]
    learned = workers.each(_learned, lessons, lambda done: progress(done, responses))
    doubters = tuple(response for response, _ in learned[1:])
    return Person(seen, learned[0][0], doubters, arkit), learned[0][1]


def _learned(
    advance: Advance,
    weights: NDArray[np.float32],
    rotations: NDArray[np.float32],
    channels: NDArray[np.float32],
    steps: int,
    seed: int,
) -> tuple[ResponseModel, float]:
    inputs = (torch.from_numpy(weights), torch.from_numpy(rotations))
    learned = fit_response(inputs, torch.from_numpy(channels), steps, seed)
    advance()
    return learned
