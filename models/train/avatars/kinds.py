"""The models that can be learned, by the names of ``Plan.model``."""

from collections.abc import Callable, Mapping

from ...captures.texels import Texels
from .avatar import Avatar
from .blendshapes import BlendshapeAvatar
from .cnn import CnnAvatar
from .plan import Model, Plan
from .rigged import RiggedAvatar

KINDS: Mapping[Model, type[Avatar]] = {"cnn": CnnAvatar, "rigged": RiggedAvatar, "blendshapes": BlendshapeAvatar}
_BUILT: Mapping[Model, Callable[[Texels, Plan], Avatar]] = {
    "cnn": lambda texels, plan: CnnAvatar(texels, plan.architecture),
    "rigged": lambda texels, plan: RiggedAvatar(texels),
    "blendshapes": lambda texels, plan: BlendshapeAvatar(texels),
}


def untrained(texels: Texels, plan: Plan) -> Avatar:
    """The plan's model before it has learned anything; the CNN's weights are drawn by torch's generator."""
    return _BUILT[plan.model](texels, plan)
