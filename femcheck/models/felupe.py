"""FElupe's elements in our equilibrium, where it is installed: a comparator, never an answer."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec

from femcheck.models.question import Question
from femcheck.models.reply import Reply, nothing

__all__ = ["FelupeModel"]


@dataclass(frozen=True, slots=True)
class FelupeModel:
    """27-node hexahedra assembled by FElupe.

    layers : along the actuator. size : of the triangles that the hexahedra are cut from.
    """

    layers: int
    size: float

    @property
    def family(self) -> str:
        """Its name."""
        return "felupe"

    @property
    def resolution(self) -> str:
        """Layers and size."""
        return f"{self.layers} layers, size {self.size:g}"

    def refuses(self, question: Question) -> str | None:
        """Why it can not be asked."""
        if find_spec("felupe") is None:
            return "FElupe is not installed"
        return "not there yet"

    def reply(self, question: Question, workers: int = 0) -> Reply:
        """Nothing yet."""
        return nothing(question, "not there yet")
