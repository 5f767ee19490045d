"""MakeHuman's eyes, teeth, tongue, lashes and hair, put on a body."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..arkit import NAMES
from .body import Body
from .ingredients import Ingredients
from .maps import load_map, sample_map
from .people import Person
from .proxies import Proxy, load_proxy
from .soup import EYES, HAIR, LASHES, TEETH, TONGUE, Surface
from .teeth import carried, make_arches

UPPER_TEETH_DROP, LOWER_TEETH_DROP = 0.034, 0.042
TONGUE_SHIFT = np.array([0.0, -0.05, -0.03])
"""Decimetres: MakeHuman's teeth hide behind the upper lip; incisors should reach just below where the lips meet."""


def fitted_surfaces(body: Body, person: Person, ingredients: Ingredients) -> Iterator[Surface]:
    """Everything on and in the head but its skin, the eyes first."""
    root = ingredients.makehuman / "proxies"
    hair = person.hair.proxy
    yield _fitted(EYES, _without_cornea(load_proxy(root / "eyes/HighPolyEyes/HighPolyEyes.json"), root), body)
    yield _with_arches(_fitted(TEETH, load_proxy(root / "teeth/Teeth_Base/Teeth_Base.json"), body))
    tongue = _fitted(TONGUE, load_proxy(root / "tongue/tongue01/tongue01.json"), body)
    yield replace(tongue, vertices=tongue.vertices + TONGUE_SHIFT)
    yield _fitted(LASHES, load_proxy(root / "eyelashes/eyelashes02/eyelashes02.json"), body)
    yield _fitted(HAIR, load_proxy(root / f"hair/{hair}/{hair}.json"), body)


def _fitted(part: int, proxy: Proxy, body: Body) -> Surface:
    """A proxy on the body; eyes and hair do not move with the face."""
    rigid = part in (EYES, HAIR)
    binding = proxy.binding(len(body.vertices))
    return Surface(
        part,
        vertices=proxy.fit(body.vertices if rigid else body.flesh),
        deltas=np.zeros((len(NAMES), len(proxy.refs), 3)) if rigid else np.stack([binding @ u for u in body.units]),
        average=proxy.fit(body.base.vertices),
        triangles=proxy.triangles,
        texture=proxy.texture,
    )


def _with_arches(teeth: Surface) -> Surface:
    """Teeth of our own where MakeHuman's are."""
    jaw = np.linalg.norm(teeth.deltas[NAMES.index("jawOpen")], axis=1) > 1e-3
    guide = teeth.vertices.copy()
    guide[:, 1] -= np.where(jaw, LOWER_TEETH_DROP, UPPER_TEETH_DROP)
    arches = make_arches(guide, jaw)
    return Surface(
        TEETH,
        vertices=arches.vertices,
        deltas=carried(guide, teeth.deltas, jaw, arches),
        average=make_arches(teeth.average, jaw).vertices,
        triangles=arches.triangles,
        texture=arches.texture,
    )


def _without_cornea(eyes: Proxy, root: Path) -> Proxy:
    """The eye proxy without its clear outer shell, whose texture is transparent."""
    alpha = sample_map(load_map(root / "eyes/HighPolyEyes/textures/brown_eye.png"), eyes.texture.mean(1))[:, 3]
    return replace(eyes, triangles=eyes.triangles[alpha > 0.5], texture=eyes.texture[alpha > 0.5])
