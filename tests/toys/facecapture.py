"""A capture of a shipped avatar: a person that the face tracker sees, whose coefficients are known."""

from pathlib import Path

import numpy as np
from gemheads.models.arkit import NAMES
from gemheads.models.captures.layout import Template
from gemheads.models.captures.reader import Capture, open_capture
from gemheads.models.captures.writer import CaptureWriter
from gemheads.models.gem import Gem
from gemheads.models.gemfile import load_gem
from gemheads.render.camera import orbit
from gemheads.render.compositing import over
from gemheads.render.software import SoftwareEngine

MARA = Path(__file__).parents[2] / "assets" / "avatars" / "mara.gem"
SIZE = 192
YAWS = (-15.0, 0.0, 15.0)
PARTS = ("jawOpen", "mouthSmileLeft", "mouthSmileRight", "browInnerUp", "eyeBlinkLeft", "eyeBlinkRight")


def person() -> Gem:
    """Mara, with few components."""
    return load_gem(MARA).truncated(8)


def write_capture(
    folder: Path, gem: Gem, train: int = 20, test: int = 6, held_out: tuple[int, ...] = ()
) -> tuple[Capture, dict[int, np.ndarray]]:
    """A capture of so many moments, and the coefficients of each; the first moment is the neutral. ``held_out``: which
    of the cameras."""
    rng = np.random.default_rng(0)
    writer = CaptureWriter(folder)
    writer.begin(_template())
    engine, coefficients = SoftwareEngine(), {}
    shots: dict[str, list] = {"train": [], "val": [], "test": []}
    for timestep in range(train + test):
        weights = np.zeros(len(NAMES), np.float32)
        if timestep:
            weights[[NAMES.index(name) for name in PARTS]] = rng.uniform(0, 0.8, len(PARTS))
            weights[NAMES.index("mouthSmileRight")] = weights[NAMES.index("mouthSmileLeft")]
            weights[NAMES.index("eyeBlinkRight")] = weights[NAMES.index("eyeBlinkLeft")]
        coefficients[timestep] = gem.clamped(gem.arkit_coefficients(weights))
        raw = gem.compose(coefficients[timestep])
        vertices = _template().vertices + np.float32([0, -0.004, 0]) * weights.sum()
        writer.write_mesh(timestep, vertices, np.zeros(3), np.zeros(3), weights)
        for index, yaw in enumerate(YAWS):
            camera = orbit(gem.viewing.target, 1.1, yaw, 0, 20, SIZE, SIZE)
            shot = writer.shot(timestep, index, camera)
            image = engine.draw(raw, camera)
            alpha = np.round(255 * np.clip(image[..., 3], 0, 1)).astype(np.uint8)
            writer.write_picture(shot, over(image, (1, 1, 1)), alpha)
            split = "test" if timestep >= train else "val" if index in held_out else "train"
            shots[split].append(shot)
    viewing = {"target": list(gem.viewing.target), "head_height": gem.viewing.head_height}
    writer.finish(shots, {"subject": "Mara", "viewing": viewing, "background": [1, 1, 1]})
    return open_capture(folder), coefficients


def _template() -> Template:
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-0.08, 0.08, 4), np.linspace(-0.1, 0.1, 4)))
    corner = np.arange(16).reshape(4, 4)[:-1, :-1].ravel()
    triangles = np.stack([corner, corner + 1, corner + 4, corner + 1, corner + 5, corner + 4], 1).reshape(-1, 3)
    uv = np.stack([x, y], 1) * 4 + 0.5
    return Template(
        np.stack([x, y, 0.1 - 4 * x * x], 1).astype(np.float32),
        triangles.astype(np.int32),
        uv.astype(np.float32),
        triangles.astype(np.int32),
        np.ones(16, np.float32),
        np.float32([0, -0.075, -0.02]),
        np.zeros(len(triangles), np.uint8),
        ("skin",),
    )
