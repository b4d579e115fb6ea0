"""The materials by name, and where each of their constants is from.

Published moduli of one and the same silicone differ by a factor of two, with curing and with the
stretch they were fitted to. E is therefore always the design's; only constants that shape the
curve are taken from publications.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from beamopt.errors import InputError
from femcheck.material.gent import Gent
from femcheck.material.isotropic import Isotropic
from femcheck.material.law import Law
from femcheck.material.mooney_rivlin import MooneyRivlin
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.material.yeoh import Yeoh

__all__ = ["LAWS", "MATERIALS", "Constant", "Material", "constants_of", "law_by_name"]

DESIGN, GIVEN, FOLLOWS = "the design", "given", "of E and ν"

GENT = (
    "Gent, Rubber Chem. Technol. 69 (1996) 59: vulcanised rubber in simple extension, "
    "limiting stretch 10"
)
HOLZAPFEL = (
    "Holzapfel, Nonlinear Solid Mechanics (Wiley 2000), section 6.5, rubber balloon: "
    "c1 = 0.4375 μ, c2 = 0.0625 μ"
)
MOSADEGH = (
    "Mosadegh et al., Adv. Funct. Mater. 24 (2014) 2163, Elastosil M4601: "
    "C1 = 0.11 MPa, C2 = 0.02 MPa, no C3"
)


@dataclass(frozen=True, slots=True)
class Constant:
    """A constant of a law, as reports print it.

    Parameters
    ----------
    name : as files, options and the law's fields have it.
    value : in `unit`.
    unit : "kPa", or what a share is of, or "".
    source : a publication, "the design" or "given".
    """

    name: str
    value: float
    unit: str
    source: str


@dataclass(frozen=True, slots=True)
class Material:
    """A law and its constants of shape, which are fields of the law.

    Parameters
    ----------
    law : its class.
    shape : constants beside E and ν, with the values taken if none are given.
    """

    law: Callable[..., Isotropic]
    shape: tuple[Constant, ...] = ()


LAWS: Mapping[str, Material] = {
    "neo-hookean": Material(NeoHookean),
    "gent": Material(Gent, (Constant("Jm", 97.2, "", GENT),)),
    "mooney-rivlin": Material(
        MooneyRivlin, (Constant("C2_share", 0.125, "of C1 + C2", HOLZAPFEL),)
    ),
    "yeoh": Material(
        Yeoh,
        (
            Constant("C2_ratio", 0.02 / 0.11, "of C1", MOSADEGH),
            Constant("C3_ratio", 0.0, "of C1", MOSADEGH),
        ),
    ),
}

MATERIALS = tuple(LAWS)
"""Names of the laws that are materials; rigid-section, a check of the beam, is none."""

NO_CONSTANTS: Mapping[str, float] = {}


def law_by_name(
    name: str,
    youngs_modulus: float,
    poisson_ratio: float = 0.5,
    constants: Mapping[str, float] = NO_CONSTANTS,
) -> Law:
    """A material by its name; `constants` take the place of published ones.

    Parameters
    ----------
    youngs_modulus : E [kPa].
    poisson_ratio : ν, 0 … 0.5.

    Raises
    ------
    InputError : an unknown name or constant, or a value that can not be used.
    """
    if name not in LAWS:
        raise InputError("", "law", name, f"a material is one of {', '.join(MATERIALS)}")
    known = {constant.name: constant.value for constant in LAWS[name].shape}
    for key, value in constants.items():
        if key not in known:
            takes = " and ".join(known) if known else "no constants beside E and ν"
            raise InputError("", key, value, f"{name} takes {takes}")
    return LAWS[name].law(youngs_modulus, poisson_ratio, **known | dict(constants))


def constants_of(law: Law) -> tuple[Constant, ...]:
    """Every constant of a law with its source; λ and Λ unless they are infinite or the same."""
    if isinstance(law, RigidSection):
        return (
            Constant("E", law.youngs_modulus, "kPa", DESIGN),
            Constant("G", law.rigidity, "kPa", "cE/2" if law.shear_modulus is None else GIVEN),
            Constant("c", law.penalty, "", GIVEN),
        )
    if not isinstance(law, Isotropic):
        raise TypeError(f"{law.name} is not in the catalogue")
    moduli = [
        Constant("E", law.youngs_modulus, "kPa", DESIGN),
        Constant("ν", law.poisson_ratio, "", GIVEN),
        Constant("μ", law.shear_modulus, "kPa", FOLLOWS),
    ]
    if law.poisson_ratio < 0.5:
        moduli.append(Constant("λ", law.lame_modulus, "kPa", FOLLOWS))
        if law.volumetric_modulus != law.lame_modulus:
            moduli.append(Constant("Λ", law.volumetric_modulus, "kPa", FOLLOWS))
    return (*moduli, *(_used(law, published) for published in LAWS[law.name].shape))


def _used(law: Isotropic, published: Constant) -> Constant:
    value = float(getattr(law, published.name))
    source = published.source if value == published.value else GIVEN
    return Constant(published.name, value, published.unit, source)
