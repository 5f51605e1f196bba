"""Quantities with their units and uncertainties, as a certificate states them."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal

COVERAGE_FACTOR = 2
"""k of the expanded uncertainty U = k · u (JCGM 100:2008, 6.2.1)."""

COVERAGE_PROBABILITY = 0.9545
"""Probability of ± 2 u for a normal distribution."""


@dataclass(frozen=True)
class Unit:
    """A unit for readers, and the same unit as D-SI writes it (BIPM names, SI Brochure, 9th edition)."""

    text: str
    dsi: str


DPS = Unit("°/s", r"\degree\second\tothe{-1}")
DPS_PER_C = Unit("°/s/°C", r"\degree\second\tothe{-1}\kelvin\tothe{-1}")
DPS_PER_C2 = Unit("°/s/°C²", r"\degree\second\tothe{-1}\kelvin\tothe{-2}")
DPS_PER_C3 = Unit("°/s/°C³", r"\degree\second\tothe{-1}\kelvin\tothe{-3}")
DPS_PER_RT_HZ = Unit("°/s/√Hz", r"\degree\second\tothe{-1}\hertz\tothe{-0.5}")
DPS_PER_RT_S = Unit("°/s/√s", r"\degree\second\tothe{-1.5}")
CELSIUS = Unit("°C", r"\degreecelsius")
SECOND = Unit("s", r"\second")

CONDITION_UNITS = {
    unit.text: unit
    for unit in (
        CELSIUS,
        DPS,
        SECOND,
        Unit("K", r"\kelvin"),
        Unit("%", r"\percent"),
        Unit("1", r"\one"),
        Unit("Pa", r"\pascal"),
        Unit("hPa", r"\hecto\pascal"),
        Unit("kPa", r"\kilo\pascal"),
        Unit("V", r"\volt"),
        Unit("mV", r"\milli\volt"),
        Unit("A", r"\ampere"),
        Unit("mA", r"\milli\ampere"),
        Unit("Hz", r"\hertz"),
        Unit("m/s²", r"\metre\second\tothe{-2}"),
        Unit("µT", r"\micro\tesla"),
        Unit("°", r"\degree"),
    )
}
"""Units in which ``lab.toml`` may state a condition."""


def covariance_unit(power: int) -> Unit:
    """The unit (°/s)²/°Cⁿ, where n is ``power``."""
    digits = str(power).translate(str.maketrans("123456", "\u00b9\u00b2\u00b3\u2074\u2075\u2076"))
    kelvin = rf"\kelvin\tothe{{-{power}}}"
    return Unit(f"(°/s)²/°C{digits if power > 1 else ''}", rf"\degree\tothe{{2}}\second\tothe{{-2}}{kelvin}")


@dataclass(frozen=True)
class Quantity:
    """A value with its standard uncertainty ``u`` in the same unit; ``u`` is None if none is stated."""

    name: str
    value: float
    unit: Unit
    u: float | None = None
    decimals: int | None = None
    """Decimals for readers if there is no uncertainty; None for four significant digits."""

    @property
    def expanded(self) -> float | None:
        """U = k · u with k = 2."""
        return None if self.u is None else COVERAGE_FACTOR * self.u

    @property
    def shown(self) -> str:
        """The value for readers, rounded to the decimal place of U, or without U as `decimals` says."""
        if self.expanded is not None:
            return typeset(plain(self.value, place_of(self.expanded, digits=2)))
        place = place_of(self.value, digits=4) if self.decimals is None else -self.decimals
        return typeset(plain(self.value, place))

    @property
    def as_given(self) -> str:
        """The value with the digits that a person wrote."""
        return typeset(repr(self.value))

    @property
    def shown_expanded(self) -> str:
        """U for readers, with two digits (JCGM 100:2008, 7.2.6)."""
        return "" if self.expanded is None else typeset(plain(self.expanded, place_of(self.expanded, digits=2)))


def place_of(value: float, digits: int) -> int:
    """The power of ten of the last of ``digits`` significant digits, after rounding (0.0996 is 0.10)."""
    return int(f"{value:.{digits - 1}e}".partition("e")[2]) - digits + 1


def plain(value: float, place: int) -> str:
    """The value, rounded to this power of ten, without an exponent."""
    # rounds the shortest decimal form, so 2.675 becomes 2.68; format() would give 2.67, as the float is below 2.675
    return format(Decimal(repr(value)).quantize(Decimal(1).scaleb(place)), "f")


def typeset(number: str) -> str:
    """A number with a minus sign instead of a hyphen, and without a sign where it is zero."""
    return number.lstrip("-") if float(number) == 0 else number.replace("-", "\u2212")
