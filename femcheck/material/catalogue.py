"""The materials by name, and where each of their constants is from.

Published moduli of one and the same silicone differ by a factor of two, with curing and with the
stretch they were fitted to. E is therefore always the design's; only constants that shape the
curve are taken from publications.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from beamopt.base.errors import InputError
from femcheck.material.gent import Gent
from femcheck.material.isotropic import Isotropic
from femcheck.material.law import Law
from femcheck.material.mooney_rivlin import MooneyRivlin
from femcheck.material.neo_hookean import NeoHookean
from femcheck.material.rigid_section import RigidSection
from femcheck.material.yeoh import Yeoh

__all__ = [
    "LAWS",
    "MATERIALS",
    "Constant",
    "Material",
    "constants_of",
    "law_by_name",
    "modulus_of",
]

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
    fitted : names of the constants [kPa] that a test curve gives in place of `shape`; those after
        the first may be left out, and are 0 then.
    shape_of : the constants of shape of those, and the shear modulus at rest [kPa].
    """

    law: Callable[..., Isotropic]
    shape: tuple[Constant, ...] = ()
    fitted: tuple[str, ...] = ()
    shape_of: Callable[..., tuple[Mapping[str, float], float]] | None = None


def _of_mooney_rivlin(C1: float, C2: float) -> tuple[Mapping[str, float], float]:
    both = C1 + C2
    return {"C2_share": C2 / both if both else math.nan}, 2 * both


def _of_yeoh(C1: float, C2: float, C3: float) -> tuple[Mapping[str, float], float]:
    ratios = {"C2_ratio": C2, "C3_ratio": C3}
    return {name: value / C1 if C1 else math.nan for name, value in ratios.items()}, 2 * C1


LAWS: Mapping[str, Material] = {
    "neo-hookean": Material(NeoHookean),
    "gent": Material(Gent, (Constant("Jm", 97.2, "", GENT),)),
    "mooney-rivlin": Material(
        MooneyRivlin,
        (Constant("C2_share", 0.125, "of C1 + C2", HOLZAPFEL),),
        ("C1", "C2"),
        _of_mooney_rivlin,
    ),
    "yeoh": Material(
        Yeoh,
        (
            Constant("C2_ratio", 0.02 / 0.11, "of C1", MOSADEGH),
            Constant("C3_ratio", 0.0, "of C1", MOSADEGH),
        ),
        ("C1", "C2", "C3"),
        _of_yeoh,
    ),
}

MATERIALS = tuple(LAWS)
"""Names of the laws that are materials; rigid-section, a check of the beam, is none."""

NO_CONSTANTS: Mapping[str, float] = {}
SAME = 5e-3  # share by which E may differ from that of constants in kPa, which tables round


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
    constants : of shape; or those of a test curve in kPa, whose E must be this one.

    Raises
    ------
    InputError : an unknown name or constant, a value that can not be used, or constants in kPa of
        another E.

    Examples
    --------
    >>> import femcheck
    >>> femcheck.law_by_name("gent", 300.0, constants={"Jm": 30.0}).name
    'gent'
    """
    shape = _shape(name, constants)
    given = modulus_of(name, poisson_ratio, constants)
    if given is not None and abs(given - youngs_modulus) > SAME * youngs_modulus:
        key = LAWS[name].fitted[0]
        ratios = " and ".join(f"{one}={value:.6g}" for one, value in shape.items())
        said = (
            f"these constants have E = {given:.4g} kPa, and the design {youngs_modulus:g} kPa: "
            f"give it that E, or {ratios} for a curve of this shape at its own"
        )
        raise InputError("", key, constants[key], said)
    known = {constant.name: constant.value for constant in LAWS[name].shape}
    return LAWS[name].law(youngs_modulus, poisson_ratio, **known | shape)


def modulus_of(name: str, poisson_ratio: float, constants: Mapping[str, float]) -> float | None:
    """E [kPa] of constants in kPa; None where none are, and every E goes with them.

    Raises
    ------
    InputError : see `law_by_name`.
    """
    _shape(name, constants)
    fitted = _fitted(name, constants)
    return None if fitted is None else 2 * (1 + poisson_ratio) * fitted[1]


def _shape(name: str, constants: Mapping[str, float]) -> dict[str, float]:
    """Constants of shape, whichever were given."""
    if name not in LAWS:
        raise InputError("", "law", name, f"a material is one of {', '.join(MATERIALS)}")
    material = LAWS[name]
    own = {constant.name for constant in material.shape}
    fitted = _fitted(name, constants)
    if fitted is not None:
        return dict(fitted[0])
    for key, value in constants.items():
        if key not in own:
            raise InputError("", key, value, f"{name} takes {_taken(material)}")
    return dict(constants)


def _taken(material: Material) -> str:
    shape = " and ".join(one.name for one in material.shape)
    if not shape:
        return "no constants beside E and ν"
    return f"{shape}, or {', '.join(material.fitted)} in kPa" if material.fitted else shape


def _fitted(name: str, constants: Mapping[str, float]) -> tuple[Mapping[str, float], float] | None:
    """Constants of shape and μ [kPa] of those that a test curve gives; None where none are."""
    material = LAWS[name]
    if material.shape_of is None or not set(constants) & set(material.fitted):
        return None
    for key, value in constants.items():
        if key not in material.fitted or not math.isfinite(value):
            raise InputError("", key, value, f"a number of {', '.join(material.fitted)} in kPa")
    first = material.fitted[0]
    if first not in constants:
        raise InputError("", first, None, f"must be given with {', '.join(constants)}")
    shape, mu = material.shape_of(*(constants.get(key, 0.0) for key in material.fitted))
    if not mu > 0:
        given = ", ".join(f"{key} = {value:g}" for key, value in constants.items())
        said = f"with {given} kPa the shear modulus at rest is {mu:.4g} kPa: must be above 0"
        raise InputError("", first, constants[first], said)
    return shape, mu


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
