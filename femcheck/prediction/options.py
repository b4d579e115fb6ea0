"""What is asked of a prediction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from beamopt.base.brief import changed_fields
from beamopt.base.errors import InputError
from beamopt.scene.actuator import Actuator
from femcheck.material.catalogue import law_by_name, modulus_of
from femcheck.material.fibre import Thread
from femcheck.material.law import Law
from femcheck.solid.elements import ELEMENTS
from femcheck.solid.winding import Wound
from femcheck.solved.solid_options import SolidOptions

__all__ = ["WOUND", "PredictionOptions"]

WOUND = "wound"
"""The law of a name that says what is wound too."""

SAME = 5e-3  # share by which a shear modulus may differ from E/(2(1 + ν)), which files round


@dataclass(frozen=True, slots=True)
class PredictionOptions(SolidOptions):
    """Of which material the solid is made.

    Parameters
    ----------
    law : name of a material; "wound" is neo-hookean with every chamber wound, unless `wound` says
        otherwise.
    poisson_ratio : ν; ½ is incompressible.
    constants : in place of the law's published ones.
    wound : which surfaces are wound with thread; None where none is.
    thread : what they are wound with.

    Raises
    ------
    InputError : a value that can not be used, with what is allowed.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.PredictionOptions(law="wound").title
    'neo-hookean, ν = 0.5, chambers wound'
    """

    law: str = "neo-hookean"
    poisson_ratio: float = 0.5
    constants: Mapping[str, float] = field(default_factory=dict)
    wound: Wound | None = None
    thread: Thread = field(default_factory=lambda: Thread(1e5))

    __repr__ = changed_fields

    def __post_init__(self) -> None:
        SolidOptions.__post_init__(self)
        if self.law == WOUND:
            object.__setattr__(self, "law", "neo-hookean")
            object.__setattr__(self, "wound", self.wound or Wound.CHAMBERS)
        E = modulus_of(self.law, self.poisson_ratio, self.constants) or 1.0
        law = law_by_name(self.law, E, self.poisson_ratio, self.constants)
        if law.volumetric_compliance is not None and not ELEMENTS[self.element].has_pair:
            paired = ", ".join(name for name, choice in ELEMENTS.items() if choice.has_pair)
            said = f"has no stable pair for ν = {self.poisson_ratio:g}; one of {paired}"
            raise InputError("", "element", self.element, said)

    def law_for(self, actuator: Actuator) -> Law:
        """The law of an actuator's material.

        A design without a shear modulus has E/3, which goes with every ν: what was not given
        contradicts nothing.

        Raises
        ------
        InputError : a shear modulus that contradicts E and ν.
        """
        E, G = actuator.youngs_modulus, actuator.shear_modulus
        wanted = {nu: E / (2 * (1 + nu)) for nu in (0.5, self.poisson_ratio)}
        if all(abs(G - right) > SAME * right for right in wanted.values()):
            right = wanted[self.poisson_ratio]
            said = (
                f"contradicts E = {E:g} kPa and ν = {self.poisson_ratio:g}: "
                f"E/(2(1 + ν)) = {right:.4g} kPa"
            )
            raise InputError("", "actuator.shear_modulus", G, said)
        return law_by_name(self.law, E, self.poisson_ratio, self.constants)

    @property
    def title(self) -> str:
        """The law and the winding in a few words."""
        wound = {None: "unreinforced", Wound.CHAMBERS: "chambers wound"}.get(self.wound)
        if wound is None:
            wound = "wound outside" if self.wound is Wound.OUTER else "chambers and outside wound"
        return f"{self.law}, ν = {self.poisson_ratio:g}, {wound}"

    @property
    def question(self) -> dict[str, object]:
        """What must be the same for kept results to be gone on with."""
        wound = None
        if self.wound is not None:
            thread = self.thread
            wound = {"where": self.wound.value, "N_per_m": thread.stiffness, "toe": thread.toe}
        return {
            "law": self.law,
            "poisson_ratio": self.poisson_ratio,
            "constants": dict(self.constants),
            "wound": wound,
            **self.solid_question,
        }
