"""Who ships: each person is a recipe of MakeHuman targets, a skin, and a look."""

from dataclasses import dataclass, field

Rgb = tuple[float, float, float]


@dataclass(frozen=True)
class Hair:
    """Hair of one of the CC0 proxies, recoloured."""

    proxy: str
    """Folder of the proxy in proxies/hair."""
    color: Rgb
    """Mean colour, sRGB."""
    tip: Rgb
    """Colour of light strands, sRGB."""
    gloss: float = 0.5
    """Strength of the highlight, 0..1."""
    grow: float = 0.0
    """Metres by which the card is lifted off the scalp."""


@dataclass(frozen=True)
class Person:
    """One identity."""

    name: str
    targets: dict[str, float]
    """Target path below mpfb2/targets (without .target.gz) -> weight."""
    skin: str
    """Diffuse map below makehuman/skins."""
    eye: str
    """Iris map of proxies/eyes/HighPolyEyes."""
    brow: str
    """Folder of the brow proxy in proxies/eyebrows."""
    brow_color: Rgb
    hair: Hair
    seed: int
    skin_gain: Rgb = (1.0, 1.0, 1.0)
    """Factor on the diffuse map, linear light."""
    lip: Rgb = (0.72, 0.40, 0.38)
    """Lip colour, sRGB."""
    freckles: float = 0.0
    """0..1"""
    stubble: float = 0.0
    """0..1"""
    wrinkles: float = 0.0
    """0..1"""
    shirt: Rgb = (0.13, 0.14, 0.16)
    """Colour of the T-shirt, sRGB."""
    rest: dict[str, float] = field(default_factory=dict)
    """ARKit weights that belong to the neutral face: a relaxed, friendly look."""


def _both(path: str, weight: float) -> dict[str, float]:
    """The same target on the left and on the right."""
    folder, name = path.split("/")
    return {f"{folder}/l-{name}": weight, f"{folder}/r-{name}": weight}


def _macro(race: dict[str, float], sex: dict[str, float], age: dict[str, float]) -> dict[str, float]:
    """MakeHuman's macro targets of a mixture of races, sexes and ages (each sums to 1)."""
    macro: dict[str, float] = {}
    for s, sex_share in sex.items():
        for a, age_share in age.items():
            macro[f"macrodetails/universal-{s}-{a}-averagemuscle-averageweight"] = sex_share * age_share
            for r, race_share in race.items():
                macro[f"macrodetails/{r}-{s}-{a}"] = sex_share * age_share * race_share
    return macro


FRIENDLY = {"browInnerUp": 0.10, "eyeWideLeft": 0.12, "eyeWideRight": 0.12, "mouthSmileLeft": 0.06, "mouthSmileRight": 0.06}

MARA = Person(
    name="mara",
    targets=_macro({"caucasian": 0.8, "asian": 0.2}, {"female": 0.95, "male": 0.05}, {"young": 1.0}),
    skin="young_caucasian_female/textures/young_lightskinned_female_diffuse.png",
    eye="green",
    brow="eyebrow001",
    brow_color=(0.36, 0.215, 0.145),
    hair=Hair("long01", (0.30, 0.155, 0.09), (0.56, 0.32, 0.18), gloss=0.6),
    seed=11,
    freckles=0.6,
    rest=FRIENDLY,
)

THEO = Person(
    name="theo",
    targets=_macro({"caucasian": 1.0}, {"male": 1.0}, {"young": 0.35, "old": 0.65}),
    skin="middleage_caucasian_male/textures/middleage_lightskinned_male_diffuse.png",
    eye="lightblue",
    brow="eyebrow006",
    brow_color=(0.40, 0.36, 0.33),
    hair=Hair("short04", (0.46, 0.45, 0.44), (0.72, 0.71, 0.69), gloss=0.35),
    seed=23,
    stubble=0.5,
    wrinkles=0.8,
    rest=FRIENDLY,
)

JONAH = Person(
    name="jonah",
    targets=_macro({"african": 1.0}, {"male": 1.0}, {"young": 1.0}),
    skin="young_african_male/textures/young_darkskinned_male_diffuse.png",
    eye="brown",
    brow="eyebrow001",
    brow_color=(0.07, 0.05, 0.045),
    hair=Hair("short01", (0.06, 0.05, 0.045), (0.16, 0.13, 0.11), gloss=0.25),
    seed=37,
    stubble=0.35,
    rest=FRIENDLY,
)

LIN = Person(
    name="lin",
    targets=_macro({"asian": 1.0}, {"female": 1.0}, {"young": 1.0}),
    skin="young_asian_female/textures/young_lightskinned_female_diffuse3.png",
    eye="brown",
    brow="eyebrow012",
    brow_color=(0.12, 0.09, 0.08),
    hair=Hair("ponytail01", (0.09, 0.07, 0.065), (0.22, 0.17, 0.14), gloss=0.8),
    seed=51,
    rest=FRIENDLY,
)

AVATARS = (MARA, THEO, JONAH)
"""The identities that ship as avatars."""
DRIVER = LIN
"""The fourth, who acts in the demo clip."""
