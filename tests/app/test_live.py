from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import pytest
from faces import face
from gemheads.app.files.frames import Frame
from gemheads.app.live import drive, perform
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.presence import Phase
from gemheads.app.performing.timing import Stopwatch
from gemheads.app.person.following import EXPRESSION_FILTER, Actor, Memory, turned_gain
from gemheads.app.reenacting.reports import Tally
from gemheads.models.driver.answer import Answer, Express
from gemheads.models.driver.detector import overlap
from gemheads.models.driver.face import Box, FaceObservation
from gemheads.models.driver.neutral import neutral_of
from gemheads.models.driver.smoothing import step
from gems import ball

GEM = ball()
RNG = np.random.default_rng(3)
RATE = 25


Seen = FaceObservation | None | list[FaceObservation]


@dataclass
class ScriptedTracker:
    """Sees what the script says, one entry an image: nobody, a face, or several, the surest first."""

    script: Sequence[Seen]
    people: int = 1
    resets: int = 0
    seen: int = field(default=0)

    def track(self, rgb: np.ndarray, locked: Box | None = None) -> FaceObservation | None:
        self.seen += 1
        entry = self.script[self.seen - 1]
        there = entry if isinstance(entry, list) else [] if entry is None else [entry]
        return next((face for face in there if locked is None or overlap(face.box_px, locked) > 0.2), None)

    def detect(self, rgb: np.ndarray) -> list[None]:
        return [None] * self.people

    def reset(self) -> None:
        self.resets += 1


def jaw_of(features: np.ndarray, turn: np.ndarray) -> Answer:
    """A regressor that puts the sum of the scores, in sigmas, on the first coefficient."""
    from gemheads.models.driver.features import score

    k = np.zeros(GEM.coefficient_count, np.float32)
    k[0] = score(features, "jawOpen") * GEM.sigma[0]
    return Answer(k, turn)


def upright_jaw_of(features: np.ndarray, turn: np.ndarray) -> Answer:
    """The same, and an open jaw only seems to nod by a tenth of a radian."""
    coefficients = jaw_of(features, turn).coefficients
    nod = np.array([0.1 * coefficients[0] / GEM.sigma[0], 0, 0])
    return Answer(coefficients, turn - nod, nod)


def play(
    tracker: ScriptedTracker,
    images: list[np.ndarray] | None = None,
    head_pose: bool = True,
    express: Express = jaw_of,
) -> list[Pose]:
    lids = np.zeros(GEM.coefficient_count)
    lids[1] = GEM.sigma[1]
    actor = Actor(tracker, neutral_of(face(), 0, 0.0, "made up"), express, GEM, lids, head_pose)  # pyright: ignore[reportArgumentType]
    images = images or [np.full((48, 64, 3), 90, np.uint8)] * len(tracker.script)
    frames = [Frame(image, i, Fraction(1, RATE)) for i, image in enumerate(images)]
    return [pose for _, pose, _ in perform(actor, frames, Stopwatch())]


def first_sigmas(poses: list[Pose]) -> np.ndarray:
    return np.array([pose.coefficients[0] / GEM.sigma[0] for pose in poses])


def test_an_expression_arrives_and_a_neutral_face_is_at_rest() -> None:
    poses = play(ScriptedTracker([face()] * 5 + [face(jaw=1.0)] * 15))
    assert np.allclose(first_sigmas(poses[:5]), 0, atol=1e-6)
    assert first_sigmas(poses)[-1] == pytest.approx(1, abs=0.05)
    assert all(pose.phase is Phase.TRACKING for pose in poses)


def test_the_head_turns_as_far_as_the_drivers_and_only_if_wanted() -> None:
    script: list[FaceObservation | None] = [face(turn=(0, 0.3, 0))] * 20
    assert play(ScriptedTracker(script))[-1].turn == pytest.approx([0, 0.3, 0], abs=1e-3)
    assert play(ScriptedTracker(script), head_pose=False)[-1].turn.tolist() == [0, 0, 0]


def test_an_avatar_without_components_turns_its_head() -> None:
    still, none = GEM.truncated(0), np.zeros(0)
    tracker = ScriptedTracker([face(turn=(0, 0.3, 0))] * 20)
    actor = Actor(
        tracker, neutral_of(face(), 0, 0.0, "made up"), lambda features, turn: Answer(none, turn), still, none
    )  # pyright: ignore[reportArgumentType]
    frames = [Frame(np.full((48, 64, 3), 90, np.uint8), i, Fraction(1, RATE)) for i in range(20)]
    last = [pose for _, pose, _ in perform(actor, frames, Stopwatch())][-1]
    assert last.turn == pytest.approx([0, 0.3, 0], abs=1e-3)
    assert last.clamped == 0


def test_a_jaw_that_only_seems_to_nod_does_not_nod() -> None:
    script: list[FaceObservation | None] = [face()] * 5 + [face(jaw=1.0, turn=(0.1, 0.3, 0))] * 20
    upright = play(ScriptedTracker(script), express=upright_jaw_of)
    assert upright[-1].turn == pytest.approx([0, 0.3, 0], abs=5e-3)


def test_a_jaw_that_trembles_does_not_make_the_head_nod() -> None:
    """What an expression only seems to nod is taken off no faster than the expression is shown."""
    script = [face(jaw=0.5 + 0.3 * (-1) ** i, turn=(0.05, 0.2, 0)) for i in range(60)]
    pitch = np.array([pose.turn[0] for pose in play(ScriptedTracker(script), express=upright_jaw_of)])[20:]
    assert np.ptp(pitch) < 0.1 * 0.6 / 6  # a sixth of what seems to nod
    assert pitch.mean() == pytest.approx(0.0, abs=2e-3)


def test_a_lost_face_holds_then_rests_then_returns() -> None:
    poses = play(ScriptedTracker([face(jaw=1.0)] * 10 + [None] * 40 + [face(jaw=1.0)] * 20))
    jaw = first_sigmas(poses)
    assert jaw[10:19] == pytest.approx([jaw[9]] * 9)  # 0.36 s
    assert 0.05 < jaw[26] < 0.95
    assert jaw[45] == pytest.approx(0, abs=1e-6)
    assert jaw[51] < 0.5
    assert jaw[-1] == pytest.approx(1, abs=0.05)
    assert np.abs(np.diff(jaw)).max() < 0.3  # nothing jumps
    assert [poses[i].phase for i in (9, 12, 30, 55)] == [Phase.TRACKING, Phase.HOLD, Phase.IDLE, Phase.TRACKING]


def test_a_face_is_held_as_it_was_before_it_went_behind_a_hand() -> None:
    calm, awry = face(jaw=0.5), face(jaw=3.0, turn=(0, 0.4, 0))
    poses = play(ScriptedTracker([calm] * 20 + [awry] * 3 + [None] * 8 + [calm] * 10))
    jaw, yaw = first_sigmas(poses), np.array([pose.turn[1] for pose in poses])
    assert jaw[22] > 1
    assert yaw[22] > 0.2
    assert jaw[23] == jaw[22]  # one frame without a face may be a blink of the tracker
    assert jaw[27:31] == pytest.approx([jaw[19]] * 4)
    assert yaw[27:31] == pytest.approx([0] * 4, abs=1e-6)
    assert jaw[31:] == pytest.approx([0.5] * 10, abs=0.05)  # and is followed from there
    assert [poses[i].phase for i in (22, 23, 30, 31)] == [Phase.TRACKING, Phase.HOLD, Phase.HOLD, Phase.TRACKING]


def test_a_cut_does_not_hold_what_was_before_the_last_frame() -> None:
    dark, bright = (np.full((48, 64, 3), luma, np.uint8) for luma in (20, 230))
    script: list[Seen] = [face()] * 5 + [face(jaw=1.0)] * 3 + [None] * 8
    jaw = first_sigmas(play(ScriptedTracker(script), [dark] * 8 + [bright] * 8))
    assert jaw[8:16] == pytest.approx([jaw[7]] * 8)


def test_an_idle_avatar_breathes_and_blinks() -> None:
    poses = play(ScriptedTracker([face()] + [None] * (RATE * 9)))
    lids = np.array([pose.coefficients[1] / GEM.sigma[1] for pose in poses])
    assert lids.max() > 0.7
    assert np.ptp([pose.turn[0] for pose in poses[40:]]) > 0.005


def test_somebody_else_waits_until_the_followed_face_is_given_up() -> None:
    other = face(jaw=1.0, at=(400, 100))
    poses = play(ScriptedTracker([face(at=(100, 100))] * 10 + [other] * 30))
    phases = [pose.phase for pose in poses]
    assert phases[10:19] == [Phase.HOLD] * 9
    assert phases[19] is Phase.TRACKING
    assert first_sigmas(poses)[-1] == pytest.approx(1, abs=0.1)


def test_the_followed_face_keeps_the_lock_while_others_come_and_go() -> None:
    """The other one smiles, is always the surer one, and stays through a short absence of the followed face."""
    calm, other = face(at=(100, 100)), face(jaw=1.0, at=(300, 100))
    script: list[Seen] = [calm] * 5
    script += [[other, calm]] * 10 + [other] * 5 + [[other, calm]] * 10 + [calm] * 5  # gone for 0.2 s
    poses = play(ScriptedTracker(script))
    assert np.abs(first_sigmas(poses)).max() < 1e-6
    assert [pose.phase for pose in poses[15:20]] == [Phase.HOLD] * 5
    assert all(pose.phase is Phase.TRACKING for pose in (*poses[:15], *poses[20:]))


def test_a_face_that_moves_on_is_followed_however_far_it_gets() -> None:
    script = [face(jaw=1.0, at=(100 + 30 * i, 100)) for i in range(15)]  # .35 of its size in a frame
    assert all(pose.phase is Phase.TRACKING for pose in play(ScriptedTracker(script)))


def test_in_slow_pictures_a_face_may_be_anywhere_next_time() -> None:
    script = [face(at=(100 + 200 * i, 100)) for i in range(4)]
    actor = Actor(ScriptedTracker(script), neutral_of(face(), 0, 0.0, ""), jaw_of, GEM, np.zeros(GEM.coefficient_count))  # pyright: ignore[reportArgumentType]
    frames = [Frame(np.full((48, 64, 3), 90, np.uint8), i, Fraction(1)) for i in range(4)]  # one a second
    assert [pose.phase for _, pose, _ in perform(actor, frames, Stopwatch())] == [Phase.TRACKING] * 4


def test_other_people_are_counted() -> None:
    poses = play(ScriptedTracker([face()] * 4 + [None], people=2))
    assert [pose.faces for pose in poses] == [2, 2, 2, 2, 0]


def test_a_light_that_flickers_or_goes_out_is_no_cut() -> None:
    scene = np.random.default_rng(1).integers(60, 200, (48, 64, 3)).astype(np.uint8)
    images = [(scene * light).astype(np.uint8) for light in (1.2, 0.6, 1.2, 0.6, 1.0, 0.1, 0.1, 1.0)]
    tracker = ScriptedTracker([face()] * len(images))
    assert not any(pose.cut for pose in play(tracker, images))
    assert tracker.resets == 0


def test_a_cut_looks_anew_and_does_not_smear() -> None:
    dark, light = np.full((48, 64, 3), 30, np.uint8), np.full((48, 64, 3), 200, np.uint8)
    tracker = ScriptedTracker([face()] * 5 + [face(jaw=1.0, at=(400, 50))] * 5)
    poses = play(tracker, [dark] * 5 + [light] * 5)
    assert [pose.cut for pose in poses] == [False] * 5 + [True] + [False] * 4
    assert tracker.resets == 1
    assert first_sigmas(poses)[5] == pytest.approx(1)


def test_a_flash_holds_what_was_there() -> None:
    dark, white = np.full((48, 64, 3), 30, np.uint8), np.full((48, 64, 3), 255, np.uint8)
    poses = play(ScriptedTracker([face(jaw=1.0)] * 5 + [None] + [face(jaw=1.0)] * 5), [dark] * 5 + [white] + [dark] * 5)
    assert [pose.cut for pose in poses] == [False] * 5 + [True] * 2 + [False] * 4
    assert poses[5].phase is Phase.HOLD
    assert first_sigmas(poses) == pytest.approx(1)


def test_what_is_not_finite_keeps_the_last_good_expression() -> None:
    poses = play(ScriptedTracker([face(jaw=1.0)] * 10 + [face(jaw=float("nan"))] * 3))
    assert first_sigmas(poses)[10:] == pytest.approx(first_sigmas(poses)[9])


def test_the_same_clip_gives_the_same_performance() -> None:
    script = [face(jaw=float(j)) for j in RNG.random(30)] + [None] * 15
    first, second = play(ScriptedTracker([*script])), play(ScriptedTracker([*script]))
    assert all(np.array_equal(a.coefficients, b.coefficients) for a, b in zip(first, second, strict=True))


def test_a_clamped_expression_is_counted() -> None:
    poses = play(ScriptedTracker([face(jaw=3.0)] * 3))
    assert poses[-1].clamped == pytest.approx(1 / GEM.coefficient_count)


def test_expressions_fade_when_the_face_turns_away() -> None:
    degrees = [0, 29, 37.5, 60]
    gains = [turned_gain(np.radians([0, d, 0])) for d in degrees]
    assert gains == pytest.approx([1, 1, 0.75, 0.5])
    assert turned_gain(np.radians([0, 0, 60])) == 1


def test_the_report_counts_losses_not_only_frames() -> None:
    tally = Tally()
    for pose in play(ScriptedTracker([face()] * 3 + [None] * 2 + [face()] * 2 + [None] * 3)):
        tally.add(pose)
    counted = tally.as_json()
    assert counted["frames"] == 10
    assert counted["frames_without_face"] == 5
    assert counted["losses"] == 2


def test_while_time_stands_still_an_expression_is_taken_as_it_is() -> None:
    """There is no speed to smooth by, and nothing is divided by no time."""
    actor_frames = [Frame(np.full((48, 64, 3), 90, np.uint8), 0, Fraction(1, RATE))] * 2
    tracker = ScriptedTracker([face(), face(jaw=1.0)])
    actor = Actor(tracker, neutral_of(face(), 0, 0.0, ""), jaw_of, GEM, np.zeros(GEM.coefficient_count))  # pyright: ignore[reportArgumentType]
    memory, _ = drive(actor, Memory(), actor_frames[0])
    memory, pose = drive(actor, memory, actor_frames[1])
    assert first_sigmas([pose]) == pytest.approx([1])


def test_smoothing_keeps_the_proportions_of_an_expression() -> None:
    """Coefficients that make one shape together must not lag behind each other."""
    state = step(EXPRESSION_FILTER, None, np.zeros(3), 0.04)
    for _ in range(4):
        state = step(EXPRESSION_FILTER, state, np.array([3.0, 0.3, -0.03]), 0.04)
        assert state.value / state.value[0] == pytest.approx([1, 0.1, -0.01])
