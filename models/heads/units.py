"""What each ARKit weight adds to the base mesh: MakeHuman's face units, made as large and as round as people's."""

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ..arkit import NAMES
from .ingredients import Ingredients
from .lips import PURSES, arching, bowl, level, lip_alone, pursed
from .mesh import load_target
from .people import Person

GAIN = {
    "browInnerUp": 1.6,
    "browOuterUpLeft": 1.25,
    "browOuterUpRight": 1.25,
    "mouthPucker": 1.2,
    "mouthFunnel": 1.2,
    "mouthUpperUpLeft": 1.25,
    "mouthUpperUpRight": 1.25,
    "eyeWideLeft": 1.4,
    "eyeWideRight": 1.4,
}
"""Factors on shapes that are timid: measured on the face tracker, whose scores of people they should reach."""
SMILE = {"mouthSmile": 0.8, "mouthStretch": 0.7, "mouthDimple": 0.4, "cheekSquint": 0.3}
"""What a smile is made of. MakeHuman's lifts the corners more than it draws them apart: .7 and 1.0 cm wider than at
rest, .5 and .95 cm higher, where people to whom the tracker gives .63 and .87 of a smile have 1.0 and 1.6, .4 and .8.
``tests/bench/mouths.py`` measures people, and the avatars that this makes."""
LIDS_UP = {"eyeWide": 0.6}
"""What eyes that look up borrow, and how much: they raise the lids, which MakeHuman's shape hardly does."""
LIDS_DOWN = {"eyeSquint": -1.0, "eyeBlink": 0.2}
"""The same of eyes that look down. MakeHuman's lower lids stay up and hide the irises, its upper ones stay behind: an
avatar looked down by a blink, and where it looked to the side then was hardly seen."""
SIDES = ("Left", "Right")


def face_units(
    person: Person, body: Floats, is_flesh: NDArray[np.bool_], ingredients: Ingredients
) -> tuple[Floats, Floats]:
    """What one unit of each ARKit weight adds [52, V, 3], and what the person's face at rest does [V, 3], decimetres.

    ``body`` [V, 3] is the person on the base mesh, ``is_flesh`` [V] tells the skin from its helpers.
    """
    folder = ingredients.face_units
    units = np.stack([load_target(folder / f"{name}.target", len(body)) for name in NAMES])
    units *= np.array([GAIN.get(name, 1.0) * person.gain.get(name, 1.0) for name in NAMES])[:, None, None]
    _carry_lids(units, person.lids_follow)
    _round_mouth(units, body, is_flesh)
    _bare_teeth(units, body, person)
    # before smiles are stretched: at rest the corners are lifted, not drawn apart
    rest = sum((weight * units[NAMES.index(name)] for name, weight in person.rest.items()), np.zeros_like(body))
    _stretch_smiles(units)
    return units, rest


def _carry_lids(units: Floats, down: float) -> None:
    """Lids follow the eyes, ``down`` in [0, 1] as far as people's, in place."""
    for side in SIDES:
        for name, borrowed, follow in (("eyeLookUp", LIDS_UP, 1.0), ("eyeLookDown", LIDS_DOWN, down)):
            for lent, share in borrowed.items():
                units[NAMES.index(name + side)] += follow * share * units[NAMES.index(lent + side)]


def _round_mouth(units: Floats, body: Floats, is_flesh: NDArray[np.bool_]) -> None:
    """An open mouth is an arch and a pursed one is narrow, in place."""
    jaw_open = units[NAMES.index("jawOpen")]
    arch = np.where(is_flesh[:, None], arching(body, jaw_open), 0)
    jaw_open += arch
    units[NAMES.index("mouthClose")] -= arch
    for name, shape in PURSES.items():
        unit = units[NAMES.index(name)]
        units[NAMES.index(name)] = np.where(is_flesh[:, None], pursed(shape, unit, body, jaw_open), unit)


def _stretch_smiles(units: Floats) -> None:
    """Smiles draw the corners apart, in place."""
    for side in SIDES:
        units[NAMES.index(f"mouthSmile{side}")] = sum(
            share * units[NAMES.index(name + side)] for name, share in SMILE.items()
        )


def _bare_teeth(units: Floats, body: Floats, person: Person) -> None:
    """Lips that part are round, and a lower one goes down without the chin, in place."""
    for side in SIDES:
        units[NAMES.index(f"mouthUpperUp{side}")] *= level(body, person.round_grin)[:, None]
        lower = lip_alone(body, person.chin_follows) * bowl(body, person.round_grin)
        units[NAMES.index(f"mouthLowerDown{side}")] *= lower[:, None]
