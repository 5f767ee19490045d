"""What belongs to one source: another one begins with another of these, and nothing can be left over."""

from dataclasses import dataclass, field

from ...models.driver.face import FaceObservation
from ..inputs.source import PoseFrame, WeightsFrame
from ..person.hints import HARD_TO_READ, Hints
from ..person.settling import Settling


@dataclass(frozen=True)
class OneSource:
    """What is known of a source so far."""

    failed_before: int = 0
    """How often regressors had failed when it began."""
    settling: Settling = field(default_factory=Settling)
    """The neutral."""
    hints: Hints = field(default_factory=Hints)
    found: bool = False
    """Whether it has shown a face, or what one does."""
    secs: float | None = None
    """Its own time at the last moment; None where that moment had none, or where its time may begin anew."""
    face: FaceObservation | None = None
    """The last one, unless something else came after it."""
    weights: WeightsFrame | None = None
    """The last ones, unless something else came after them."""
    posed: PoseFrame | None = None
    """The last moment of a track, whichever avatar it is for."""
    relock: bool = False
    """Whether from the next picture on the next face to the right is to be followed."""

    @property
    def hard_to_read(self) -> bool:
        """Whether its pictures show the driver badly."""
        return not HARD_TO_READ.isdisjoint(self.hints.shown)
