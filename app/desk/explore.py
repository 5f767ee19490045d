"""What the person's own hands add to a pose: explored components, sweeps, modalities at rest. Pure."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...models.gem import CLAMP_SIGMAS, Gem
from ..performing.performance import Pose
from .state import DeskState, Exploring

SWEEP_SECS = 4.0
"""From -3 sigma to +3 sigma and back."""


def posed(gem: Gem, pose: Pose, state: DeskState, seconds: float) -> Pose:
    """The pose with what the state adds and takes away; the same object where that is nothing.

    Args:
        gem: whose coefficients they are.
        pose: of the driver.
        state: of the desk.
        seconds: any clock; sweeps follow it.
    """
    if not state.off and not state.exploring.on:
        return pose
    coefficients = pose.coefficients.copy()
    for name in state.off:
        coefficients[gem.slices[name]] = gem.rest_coefficients[gem.slices[name]]
    if state.exploring.on:
        coefficients = gem.clamped(coefficients + nudge(gem, state.exploring, seconds))
    return replace(pose, coefficients=coefficients)


def nudge(gem: Gem, exploring: Exploring, seconds: float) -> NDArray[np.float32]:
    """[coefficients] what sliders and sweep add, in the avatar's units. What the avatar does not have is left out."""
    added = np.zeros(gem.coefficient_count, np.float32)
    sliders = list(exploring.sigmas)
    if exploring.sweep:
        place = (exploring.modality, exploring.component)
        sliders = [slider for slider in sliders if slider[:2] != place] + [(*place, sweep(seconds))]
    for name, component, sigmas in sliders:
        part = gem.slices[name]
        if part.start + component < part.stop:
            added[part.start + component] = sigmas * gem.sigma[part.start + component]
    return added


def sweep(seconds: float) -> float:
    """Between -3 and +3 sigma, as a sine of SWEEP_SECS."""
    return float(CLAMP_SIGMAS * np.sin(2 * np.pi * seconds / SWEEP_SECS))
