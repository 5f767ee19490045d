"""The driver's face at rest: ``auto``, ``first``, ``frame=N``, ``time=S``, ``image=PATH`` or ``profile=NAME``."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from ...models.driver.face import LOOKS_APART, FaceObservation, FaceTracker, looked
from ...models.driver.neutral import NeutralChoice, choose_neutral, neutral_of
from ...models.wholefile import file_sha256
from ..errors import InputError, NoFaceError, UsageError
from ..files.frames import Frame
from ..files.pictures import write_png
from ..files.sources import IMAGE_SUFFIXES, Source, read_image
from .contact import contact_sheet
from .hints import DARK
from .profiles import kept_cameras, load_profile, profile_path

SAMPLES = 32
"""Frames that ``auto`` looks at."""


@dataclass(frozen=True)
class NeutralRule:
    """How the neutral is to be found."""

    kind: Literal["auto", "first", "frame", "time", "image", "profile"]
    value: str = ""
    sheet: Path | None = None
    """Where ``auto`` puts a contact sheet (PNG) of what it chose from: it shows the driver's face."""

    @property
    def picture(self) -> Path | None:
        """The one that it is read from, if it is."""
        return Path(self.value) if self.kind == "image" else None

    def settled(self) -> str:
        """The rule as it decides what a result shows: by what is in a picture or a kept neutral, not by its name.

        Raises OSError where that cannot be read.
        """
        file = self.picture or (profile_path(self.value) if self.kind == "profile" else None)
        return f"{self.kind} {self.value if file is None else file_sha256(file)}"


AUTO = NeutralRule("auto")
MOST_DIGITS = 12
"""Of the number of a frame."""


def read_rule(text: str, sheet: Path | None = None) -> NeutralRule:
    """The rule behind the word after ``--neutral``, and where the contact sheet goes. Raises UsageError."""
    kind, _, value = text.partition("=")
    if sheet is not None and text != "auto":
        raise UsageError(f"--neutral-sheet shows what --neutral auto chose from; leave it out with --neutral {text}")
    if sheet is not None and sheet.suffix.lower() in IMAGE_SUFFIXES - {".png"}:
        raise UsageError(f"--neutral-sheet {sheet}: a PNG is written; end it in .png")
    if kind in ("auto", "first") and not value:
        return NeutralRule(kind, sheet=sheet)  # pyright: ignore[reportArgumentType]
    if kind == "frame" and value.isdecimal() and len(value) <= MOST_DIGITS:
        return NeutralRule("frame", value)
    if kind == "time" and _seconds(value) is not None:
        return NeutralRule("time", value)
    if kind == "image" and value:
        return NeutralRule("image", value)
    if kind == "profile" and value:
        return NeutralRule("profile", value)
    raise UsageError(
        f"--neutral {text}: not understood; use auto, first, frame=N (from 0), time=S (seconds), image=PATH"
        " or profile=NAME (a neutral taken in the live window, by its camera's name)"
    )


def find_neutral(rule: NeutralRule, source: Source, tracker: FaceTracker) -> NeutralChoice:
    """The neutral of a driver, whoever the tracker followed before. Leaves the tracker as new.

    Raises NoFaceError when nobody is in the frames that the rule points at, InputError when there is no such frame,
    OutputError when the contact sheet that it asks for cannot be written.
    """
    tracker.reset()
    try:
        if rule.kind == "auto":
            return _chosen(source, tracker, rule.sheet)
        if rule.kind == "image":
            face = tracker.track(read_image(Path(rule.value)))
            if face is None:
                raise NoFaceError(f"{rule.value}: no face in this picture; give one that shows the face from the front")
            return neutral_of(face, 0, 0.0, f"the picture {rule.value}")
        if rule.kind == "profile":
            return _kept(rule.value)
        return _given(rule, source, tracker)
    finally:
        tracker.reset()


def said(choice: NeutralChoice, rule: NeutralRule) -> str:
    """Which neutral it is and why, and where the others can be seen."""
    if rule.kind != "auto" or not choice.candidates:
        return choice.reason if rule.sheet is None else f"{choice.reason} (so there is no contact sheet)"
    if rule.sheet is None:
        return f"{choice.reason} (--neutral-sheet FILE.png shows the best {len(choice.candidates)})"
    return f"{choice.reason} (the best {len(choice.candidates)}: {rule.sheet}, which shows the driver's face)"


def _kept(camera: str) -> NeutralChoice:
    """The neutral that was taken in the live window with this camera."""
    profile = load_profile(camera)
    if profile is None:
        names = ", ".join(kept_cameras()) or "none yet: press N in `gemheads live`"
        raise InputError(f"--neutral profile={camera}: no neutral was taken with this camera (there are: {names})")
    if profile.choice is None:
        raise InputError(f"--neutral profile={camera}: {profile.warning}")
    return replace(profile.choice, reason=f"{camera}, {profile.choice.reason} {profile.warning}".strip())


def _chosen(source: Source, tracker: FaceTracker, sheet: Path | None) -> NeutralChoice:
    frames = source.samples(SAMPLES)
    faces = [looked(tracker, frame.rgb, LOOKS_APART) for frame in frames]
    if not any(faces):
        frames, faces = _between(source, tracker)
    choice = choose_neutral(faces, [frame.seconds for frame in frames], [frame.number for frame in frames])
    if sheet is not None:
        write_png(contact_sheet(choice.candidates, frames, faces), sheet)
    return choice


def _between(source: Source, tracker: FaceTracker) -> tuple[list[Frame], list[FaceObservation | None]]:
    """The first frames with a face, for somebody who comes and goes between samples; up to SAMPLES, each with its
    number."""
    frames: list[Frame] = []
    faces: list[FaceObservation | None] = []
    lumas: list[float] = []
    for number, frame in enumerate(source.frames()):
        lumas.append(frame.luma)
        if (face := tracker.track(frame.rgb)) is not None:
            frames.append(replace(frame, number=number))
            faces.append(face)
            if len(faces) == SAMPLES:
                break
    if not faces:
        if lumas and np.median(lumas) < DARK:
            raise NoFaceError(
                f"{source.path}: no face in the whole clip, which is dark (luma {np.median(lumas):.2f} of 1, needed"
                f" {DARK}); film with a lamp in front of the face, or brighten it"
            )
        raise NoFaceError(
            f"{source.path}: no face in the whole clip; give one where a face is at least as high as an eighth of the"
            " picture's longer side, or show less of the picture (--crop)"
        )
    return frames, faces


def _given(rule: NeutralRule, source: Source, tracker: FaceTracker) -> NeutralChoice:
    """The first face at or after the frame the rule names."""
    reached = False
    for index, frame in enumerate(source.frames()):
        reached = {
            "first": True,
            "frame": rule.kind == "frame" and index >= int(rule.value),
            "time": rule.kind == "time" and frame.seconds >= float(rule.value),
        }[rule.kind]
        if not reached:
            continue
        face = tracker.track(frame.rgb)
        if face is not None:
            return neutral_of(face, index, frame.seconds, f"frame {index} at {frame.seconds:.2f} s, as asked for")
        if rule.kind != "first":
            raise NoFaceError(
                f"{source.path}: no face in frame {index} ({frame.seconds:.2f} s), the neutral asked for;"
                " choose another, or --neutral auto"
            )
    if reached:
        raise NoFaceError(f"{source.path}: no face in the whole clip; give one that shows a face")
    raise InputError(f"{source.path}: the clip ends before --neutral {rule.kind}={rule.value}; choose an earlier one")


def _seconds(text: str) -> float | None:
    try:
        seconds = float(text)
    except ValueError:
        return None
    return seconds if 0 <= seconds < float("inf") else None
