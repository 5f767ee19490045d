"""What one avatar has learned, for another that does the same with the same ARKit weights; nothing is trained."""

import numpy as np
import onnx
from onnx import numpy_helper

from ...driver.regressor import OUTPUT, Regressor, RegressorError
from ...gem import Gem
from .controls import controls_of

AVATARS_OWN = ("rest", "to_coefficients", "limit")
"""Constants of a graph that turn control weights into an avatar's coefficients; all the rest is about faces."""


def taken_over(former: Gem, gem: Gem) -> bytes:
    """The ONNX graph with which ``gem`` shows the ARKit weights that ``former`` would show.

    For an avatar that was baked anew and reads as before: how it reads is part of what was learned.

    Raises:
        RegressorError: where one of them has no ARKit shapes, or ``former`` no regressor that training wrote.
    """
    if former.arkit_weights is None or gem.arkit_weights is None:
        raise RegressorError(
            f"avatar '{gem.name}' cannot take over what '{former.name}' has learned: only avatars with ARKit shapes do"
            " the same with the same weights; train it without --take-over"
        )
    if former.regressor is None:
        raise RegressorError(f"avatar '{former.name}' has no regressor to take over; name one that has")
    Regressor(former.regressor, former.coefficient_count)
    graph = onnx.load_from_string(former.regressor)
    before, after = controls_of(former), controls_of(gem)
    constants = {constant.name: constant for constant in graph.graph.initializer}
    for name in AVATARS_OWN:
        wanted = getattr(before, name)
        kept = numpy_helper.to_array(constants[name]) if name in constants else np.empty(0)
        if kept.shape != wanted.shape or not np.allclose(kept, wanted, rtol=1e-3, atol=1e-5 * np.abs(wanted).max()):
            raise RegressorError(
                f"the regressor of avatar '{former.name}' is not one that train-regressor wrote; leave out --take-over"
            )
        constants[name].CopyFrom(numpy_helper.from_array(getattr(after, name).astype(np.float32), name))
    (output,) = (value for value in graph.graph.output if value.name == OUTPUT)
    output.type.tensor_type.shape.dim[1].dim_value = gem.coefficient_count
    made = graph.SerializeToString(deterministic=True)
    Regressor(made, gem.coefficient_count)
    return made
