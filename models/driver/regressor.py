"""Relative features and head rotation to what the avatar does: the small network that an avatar's file carries."""

import numpy as np
from numpy.typing import NDArray

from ..brevity import brief
from ..gem import Gem
from ..gemlayout import MAX_REGRESSOR_BYTES
from .answer import Answer
from .features import DIMENSION, FEATURE_VERSION
from .networks import NetworkError, open_session
from .nodding import Nodding, nodding_of
from .onnx_guard import check_graph

FEATURES_INPUT, ROTATION_INPUT, OUTPUT = "relative_features", "head_rotation", "coefficients"
"""The graph's inputs [1, D] and [1, 3] and its output [1, coefficients], all float32."""
TURN_OUTPUT = "head_turn"
"""A second output [1, 3], radians, which a graph may have: by how much the avatar's head turns, so that it is read as
the driver's is, whatever the expression adds to it: raised brows seem to nod, by not as much on all avatars."""
MOST_OFF = 0.35
"""Radians; a head turns no further than this from what was read on the driver, whatever its graph says."""
VERSION_KEY = "feature_version"
"""Key of the graph's metadata under which training writes FEATURE_VERSION."""


class RegressorError(ValueError):
    """A regressor that is not one, is not safe to run, or was trained for something else."""


class Regressor:
    """One avatar's regressor. Remembers its last good answer, so one per driven face."""

    def __init__(self, graph: bytes, coefficients: int | None = None, nodding: Nodding | None = None) -> None:
        """Opens an ONNX graph that came with an avatar.

        The graph is looked through before any of it runs: its size, its operators (arithmetic only), no data outside,
        only rows of bounded width, and the names, types and shapes of its inputs and its output, which must have
        ``coefficients`` values where given; then it is run once. The clamp to +-3 sigma is part of the graph.
        ``nodding`` is taken off the head's rotation where the graph does not say how the head turns.

        Raises:
            RegressorError: saying what is wrong with it.
        """
        if len(graph) > MAX_REGRESSOR_BYTES:
            size, limit = len(graph) / 2**20, MAX_REGRESSOR_BYTES / 2**20
            raise RegressorError(f"a regressor of {size:.0f} MB is refused: the limit is {limit:.0f} MB")
        try:
            check_graph(graph, DIMENSION)
            self._session = open_session(graph, "the avatar's regressor")
        except (ValueError, NetworkError) as error:
            raise RegressorError(f"the avatar's regressor cannot be used: {error}") from error
        inputs = {i.name: (i.shape, i.type) for i in self._session.get_inputs()}
        wanted = {FEATURES_INPUT: ([1, DIMENSION], "tensor(float)"), ROTATION_INPUT: ([1, 3], "tensor(float)")}
        if inputs != wanted:
            raise RegressorError(
                f"the avatar's regressor takes {brief(inputs)}, this version gives {wanted}: train it again"
                " (gemheads train-regressor)"
            )
        made_for = self._session.get_modelmeta().custom_metadata_map.get(VERSION_KEY, str(FEATURE_VERSION))
        if made_for != str(FEATURE_VERSION):
            raise RegressorError(
                f"the avatar's regressor was trained on features of version {made_for[:20]}, this is version"
                f" {FEATURE_VERSION}: train it again (gemheads train-regressor)"
            )
        outputs = {o.name: (o.shape, o.type) for o in self._session.get_outputs()}
        shape, kind = outputs.get(OUTPUT, ([], ""))
        fixed = len(shape) == 2 and shape[0] == 1 and isinstance(shape[1], int) and shape[1] > 0
        self._turns = TURN_OUTPUT in outputs
        others = {name: value for name, value in outputs.items() if name != OUTPUT}
        if kind != "tensor(float)" or not fixed or others not in ({}, {TURN_OUTPUT: ([1, 3], "tensor(float)")}):
            raise RegressorError(
                f"the avatar's regressor gives {brief(outputs)} instead of one {OUTPUT} [1, n], and perhaps"
                f" {TURN_OUTPUT} [1, 3]"
            )
        self._nodding = nodding
        if coefficients is not None and shape[1] != coefficients:
            raise RegressorError(f"the avatar has {coefficients} coefficients, its regressor gives {shape[1]}")
        self.coefficients: int = shape[1]
        """Length of the coefficient vector."""
        self.failures = 0
        """How many answers failed or were not finite, and were replaced by the last good one."""
        self._last = Answer(np.zeros(self.coefficients, np.float32), np.zeros(3))
        at_rest = {FEATURES_INPUT: np.zeros((1, DIMENSION), np.float32), ROTATION_INPUT: np.zeros((1, 3), np.float32)}
        if self._answer(at_rest) is None:
            raise RegressorError("the avatar's regressor cannot be used: it has no answer to a face at rest")

    @classmethod
    def of(cls, gem: Gem) -> "Regressor":
        """That of an avatar. Raises RegressorError where it has none, or none of use."""
        if gem.regressor is None:
            raise RegressorError(f"avatar '{gem.name}' has no regressor: train one (gemheads train-regressor)")
        return cls(gem.regressor, gem.coefficient_count, nodding_of(gem))

    def __call__(self, relative_features: NDArray[np.floating], rotation: NDArray[np.floating]) -> Answer:
        """What relative features r [D] and the head's rotation from its neutral [3] make the avatar do.

        A NaN or infinity anywhere, or a failure, gives the last good answer again (at first zeros) and is counted.
        """
        values = {
            FEATURES_INPUT: np.asarray(relative_features, np.float32).reshape(1, DIMENSION),
            ROTATION_INPUT: np.asarray(rotation, np.float32).reshape(1, 3),
        }
        answer = self._answer(values)
        if answer is None:
            self.failures += 1
            answer = self._last
        self._last = answer
        return Answer(answer.coefficients.copy(), answer.turn.copy(), answer.misread.copy())

    def _answer(self, values: dict[str, NDArray[np.float32]]) -> Answer | None:
        """The graph's answer; None where there is none of use."""
        if not all(np.isfinite(value).all() for value in values.values()):  # a clamp in the graph may hide a NaN
            return None
        try:
            answers = self._session.run([OUTPUT, TURN_OUTPUT] if self._turns else [OUTPUT], values)
        except Exception:  # a bound above the other; onnxruntime raises a dozen unrelated classes
            return None
        coefficients, *turns = (np.asarray(answer, np.float32).reshape(-1) for answer in answers)
        if coefficients.shape != (self.coefficients,) or not np.isfinite(coefficients).all():
            return None
        rotation = values[ROTATION_INPUT].reshape(3)
        if turns:
            if turns[0].shape != (3,) or not np.isfinite(turns[0]).all():
                return None
            turn = rotation + np.clip(turns[0] - rotation, -MOST_OFF, MOST_OFF)
        else:
            turn = rotation if self._nodding is None else self._nodding.taken_off(rotation, coefficients)
        return Answer.seen_as(coefficients, rotation, turn)
