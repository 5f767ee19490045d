"""Opening a capture, whoever made it: everything is checked first, then read picture by picture."""

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gem import Viewing
from ..picturefile import MAX_PIXELS
from .layout import (
    SPLITS,
    TEMPLATE,
    TRUTH,
    WHITE,
    CaptureError,
    Shot,
    Template,
    Tracked,
    mesh_name,
    transforms_name,
)
from .meshes import check_tracked, read_template, read_tracked, read_vertices
from .pictures import picture_size, read_mask, read_pixels
from .transforms import Transforms, read_transforms

KEPT_MOMENTS = 16
"""Tracked meshes that stay in memory: those of the pictures a training step looks at."""


@dataclass
class Capture:
    """A capture whose files have all been found sound. Pictures and meshes are read when they are asked for."""

    folder: Path
    subject: str
    """What the capture calls the person; the folder's name where it says nothing."""
    background: tuple[float, float, float]
    """sRGB in 0..1 of what is behind the person in training pictures, and where nothing else is stated; white unless
    the capture says otherwise."""
    template: Template
    train: tuple[Shot, ...]
    val: tuple[Shot, ...]
    test: tuple[Shot, ...]
    meshes: Mapping[int, Path]
    """Timestep -> file of its tracked mesh."""
    about: Mapping[str, Any]
    """What transforms_train.json says beside its frames."""
    _moments: OrderedDict[int, Tracked] = field(default_factory=OrderedDict, repr=False)

    def shots(self, split: str) -> tuple[Shot, ...]:
        """The pictures of ``train``, ``val`` or ``test``. Raises KeyError for another word."""
        return {"train": self.train, "val": self.val, "test": self.test}[split]

    def timesteps(self, split: str) -> tuple[int, ...]:
        """The moments of a split, in order."""
        return tuple(sorted({shot.timestep for shot in self.shots(split)}))

    def tracked(self, timestep: int) -> Tracked:
        """The mesh of one moment, its head pose taken out. Raises CaptureError, and KeyError for no such moment."""
        if timestep not in self._moments:
            self._moments[timestep] = read_tracked(self.meshes[timestep], self.template)
            while len(self._moments) > KEPT_MOMENTS:
                self._moments.popitem(last=False)
        self._moments.move_to_end(timestep)
        return self._moments[timestep]

    def truth(self, timestep: int) -> NDArray[np.float32] | None:
        """[V, 3] where the vertices really were, head pose and all, for judging; None where nobody knows."""
        path = self.folder / TRUTH / mesh_name(timestep)
        return read_vertices(path, self.template) if path.is_file() else None

    def ground(self, shot: Shot) -> tuple[float, float, float]:
        """sRGB in 0..1 of what is behind the person in one picture: what its list states, else the capture's."""
        return self.background if shot.background is None else shot.background

    def over_background(self, shot: Shot) -> NDArray[np.uint8]:
        """A picture [H, W, 3] over its background: as it was taken, where that is known.

        Raises CaptureError like ``read``.
        """
        rgba = self.read(shot).astype(np.float32)
        share = rgba[..., 3:] / 255
        ground = 255 * np.array(self.ground(shot), np.float32)
        return np.round(rgba[..., :3] * share + ground * (1 - share)).astype(np.uint8)

    def read(self, shot: Shot) -> NDArray[np.uint8]:
        """A picture as straight RGBA [H, W, 4], sRGB; alpha is 255 everywhere without a mask.

        Where its background is stated, that is taken out of the edges: over it, the answer is the picture.
        Raises CaptureError where the file changed since the capture was opened.
        """
        width, height = shot.camera.width, shot.camera.height
        pixels = read_pixels(shot.picture, width, height)
        alpha = pixels[..., 3] if pixels.shape[2] == 4 else np.full((height, width), 255, np.uint8)
        own_alpha = shot.mask is None
        if shot.mask is not None:
            alpha = read_mask(shot.mask, width, height)
        rgba = np.dstack([pixels[..., :3], alpha])
        if not own_alpha and (shot.background is not None or "background" in self.about):
            _take_out(rgba, self.ground(shot))
        return rgba

    def viewing(self) -> Viewing:
        """How a portrait of the person is framed: as the capture says, else by the head of the template."""
        stated = self.about.get("viewing")
        if isinstance(stated, dict):
            x, y, z = stated["target"]
            return Viewing((float(x), float(y), float(z)), float(stated["head_height"]))
        return self._measured

    @cached_property
    def _measured(self) -> Viewing:
        """Chin to crown: the vertices that follow the head entirely."""
        follows = self.template.neck_weights > 0.9
        head = self.template.vertices[follows if follows.sum() > 3 else slice(None)]
        low, high = head.min(0), head.max(0)
        return Viewing((float((low[0] + high[0]) / 2), float((low[1] + high[1]) / 2), 0.02), float(high[1] - low[1]))


def open_capture(folder: Path) -> Capture:
    """A capture, after every picture's size, every camera and every mesh has been checked.

    Raises CaptureError: it names the file, what is wrong with it, and the cure.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise CaptureError(folder, "is no folder", "name a capture's folder (make one: gemheads capture FOLDER)")
    splits = {"train": read_transforms(folder / transforms_name("train"))}
    for split in SPLITS[1:]:
        path = folder / transforms_name(split)
        splits[split] = read_transforms(path) if path.exists() else Transforms({}, (), {})
    if not splits["train"].shots:
        raise CaptureError(folder / transforms_name("train"), "lists no pictures", "a capture needs some to learn from")
    template = read_template(folder / TEMPLATE)
    meshes = _joined(folder, splits)
    _check_held_out(folder, splits)
    for split in splits.values():
        for shot in split.shots:
            _check_pictures(shot)
    for path in meshes.values():
        check_tracked(path, template)
    about = splits["train"].about
    _check_about(folder / transforms_name("train"), about)
    return Capture(
        folder=folder,
        subject=str(about.get("subject") or folder.name),
        background=splits["train"].shots[0].background or WHITE,
        template=template,
        train=splits["train"].shots,
        val=splits["val"].shots,
        test=splits["test"].shots,
        meshes=meshes,
        about=about,
    )


def _joined(folder: Path, splits: Mapping[str, Transforms]) -> dict[int, Path]:
    meshes: dict[int, Path] = {}
    for name, split in splits.items():
        for timestep, path in split.meshes.items():
            if meshes.setdefault(timestep, path) != path:
                what = f"timestep {timestep} is another moment than in {transforms_name('train')}"
                raise CaptureError(folder / transforms_name(name), what, "number timesteps uniquely over all splits")
    return meshes


def _check_held_out(folder: Path, splits: Mapping[str, Transforms]) -> None:
    """What judges was never learned from: no view of a moment and no picture is in two splits, and no moment of test in
    train."""
    seen: dict[object, str] = {}
    for split in SPLITS:
        for shot in splits[split].shots:
            for known in (shot.picture, (shot.timestep, shot.camera_index)):
                if (other := seen.setdefault(known, split)) != split:
                    would = "would judge what it taught" if other == "train" else "would count twice"
                    what = f"{shot.picture.name} is in {transforms_name(other)} too, and {would}"
                    raise CaptureError(folder / transforms_name(split), what, "take it out of one of the two")
    learned = {shot.timestep for shot in splits["train"].shots}
    for shot in splits["test"].shots:
        if shot.timestep in learned:
            what = f"timestep {shot.timestep} is in {transforms_name('train')} too, so its expression is not held out"
            cure = f"list a camera that is held out in {transforms_name('val')}"
            raise CaptureError(folder / transforms_name("test"), what, cure)


def _check_pictures(shot: Shot) -> None:
    wanted = shot.camera.width, shot.camera.height
    for path in (shot.picture, shot.mask):
        if path is None:
            continue
        size = picture_size(path)
        if size[0] * size[1] > MAX_PIXELS:
            what = f"is {size[0]}x{size[1]}, more than the {MAX_PIXELS} pixels that are read"
            raise CaptureError(path, what, "scale the picture down, and its camera's w, h, fl_x, fl_y, cx, cy")
        if size != wanted:
            what = f"is {size[0]}x{size[1]}, its camera {wanted[0]}x{wanted[1]}"
            raise CaptureError(path, what, "scale the picture, or the camera's w, h, fl_x, fl_y, cx, cy")


def _check_about(path: Path, about: Mapping[str, Any]) -> None:
    viewing = about.get("viewing")
    if viewing is None:
        return
    try:
        numbers = np.array([*viewing["target"], viewing["head_height"]], np.float64)
    except (TypeError, KeyError, ValueError, OverflowError):
        numbers = np.zeros(0)
    if numbers.shape != (4,) or not np.isfinite(numbers).all() or numbers[3] <= 0:
        raise CaptureError(path, "has a viewing that is none", "give target [3] and head_height in metres, or neither")


def _take_out(rgba: NDArray[np.uint8], background: tuple[float, float, float]) -> None:
    """Soft edges, which hold a share of the background, get the person's own colour."""
    alpha = rgba[..., 3]
    edge = (alpha > 0) & (alpha < 255)
    share = alpha[edge, None].astype(np.float32) / 255
    behind = np.array(background, np.float32) * 255
    own = (rgba[edge, :3] - behind * (1 - share)) / share
    rgba[edge, :3] = np.clip(np.round(own), 0, 255).astype(np.uint8)
