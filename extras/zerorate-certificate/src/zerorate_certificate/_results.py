"""The results of an axis: coefficients, covariances, the correction over temperature, and measured noise."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from zerorate import CalibratedAxis, Correction, NoiseRecord, Validity

from ._quantity import (
    CELSIUS,
    DPS,
    DPS_PER_C,
    DPS_PER_C2,
    DPS_PER_C3,
    DPS_PER_RT_HZ,
    DPS_PER_RT_S,
    Quantity,
    covariance_unit,
)

COEFFICIENTS = (("PBC", DPS), ("BTC", DPS_PER_C), ("BTC2", DPS_PER_C2), ("BTC3", DPS_PER_C3))
POINTS = 9
"""Number of temperatures in the table, spread evenly over the measured span as in ``zerorate calibrate --json``."""


@dataclass(frozen=True)
class Point:
    temp: Quantity
    correction: Quantity


@dataclass(frozen=True)
class AxisResult:
    name: str | None
    """None for the only axis of a part."""
    coefficients: list[Quantity]
    t3: Quantity
    """The temperature at which PBC holds. The calibration file defines it, so it has no uncertainty of its own."""
    covariances: list[Quantity]
    curve: list[Point]
    noise: list[Quantity]
    """Noise that this measurement found; no uncertainty is stated."""

    @property
    def formula(self) -> str:
        """The formula of the corrected rate, with the coefficients of this axis."""
        terms = ["PBC", "d · BTC", "d² · BTC2", "d³ · BTC3"][: len(self.coefficients)]
        return f"corrected rate = rate + {' + '.join(terms)}, with d = temperature − T3"


def axis_result(axis: CalibratedAxis, validity: Validity, *, alone: bool) -> AxisResult:
    """Collects the results of an axis. ``alone`` is True for the only axis of a part."""
    covariance = _covariance(axis)
    values = _polynomial(axis.correction)
    # a curve averaged over several orders states an uncertainty even for a term that is zero
    known = [k for k in range(4) if k == 0 or values[k] or covariance[k, k]]
    count = known[-1] + 1
    temps_c = np.linspace(validity.temp_min_c, validity.temp_max_c, POINTS)
    return AxisResult(
        name=None if alone else axis.name,
        coefficients=[_coefficient(k, float(values[k]), covariance[k, k], axis.name) for k in range(count)],
        t3=Quantity("T3", axis.correction.t3_c, CELSIUS, decimals=2),
        covariances=[
            _covariance_of(i, j, float(covariance[i, j])) for i in range(count) for j in range(i + 1, count)
        ],
        curve=[_point(float(temp_c), axis.correction, covariance) for temp_c in temps_c],
        noise=_measured_noise(axis.noise),
    )


def _coefficient(k: int, value: float, variance: float, axis: str) -> Quantity:
    name, unit = COEFFICIENTS[k]
    if not variance > 0:
        raise ValueError(f"axis {axis}: the uncertainty of {name} is not a positive number")
    return Quantity(name, value, unit, math.sqrt(variance))


def _covariance_of(i: int, j: int, value: float) -> Quantity:
    return Quantity(f"Covariance of {COEFFICIENTS[i][0]} and {COEFFICIENTS[j][0]}", value, covariance_unit(i + j))


def _polynomial(correction: Correction) -> NDArray[np.float64]:
    terms = (correction.pbc_dps, correction.btc_dps_per_c, correction.btc2_dps_per_c2, correction.btc3_dps_per_c3)
    return np.array(terms)


def _covariance(axis: CalibratedAxis) -> NDArray[np.float64]:
    """Covariance of PBC, BTC, BTC2 and BTC3."""
    if axis.curve is not None:
        return np.array(axis.curve.covariance)
    if axis.uncertainty is None:
        raise ValueError(f"axis {axis.name}: no uncertainty is stated. A certificate needs one")
    u, covariance = axis.uncertainty, np.zeros((4, 4))
    covariance[0, 0], covariance[1, 1] = u.u_pbc_dps**2, u.u_btc_dps_per_c**2
    covariance[0, 1] = covariance[1, 0] = u.cov_pbc_btc_dps2_per_c
    return covariance


def _point(temp_c: float, correction: Correction, covariance: NDArray[np.float64]) -> Point:
    """The correction and its standard uncertainty: u² is the sum of cov[i, j] · dⁱ⁺ʲ with d = T − T3.

    First-order propagation, JCGM 100:2008, equation 13. T3 is a number in the file and has no further error.
    """
    powers = (temp_c - correction.t3_c) ** np.arange(4)
    variance = float(powers @ covariance @ powers)
    value = float(powers @ _polynomial(correction))
    if not variance > 0:
        raise ValueError(f"the uncertainty of the correction at {temp_c:.2f} °C is not a positive number")
    return Point(
        temp=Quantity("Temperature", temp_c, CELSIUS, decimals=2),
        correction=Quantity("Correction", value, DPS, math.sqrt(variance)),
    )


def _noise_rows(noise: NoiseRecord) -> list[tuple[str, float, str]]:
    return [
        ("White noise, one-sided density", noise.white_dps_per_rt_hz, noise.white_source),
        ("Flicker floor of the Allan deviation", noise.flicker_floor_dps, noise.flicker_source),
        ("Rate random walk", noise.rate_random_walk_dps_per_rt_s, noise.rate_random_walk_source),
    ]


def _measured_noise(noise: NoiseRecord | None) -> list[Quantity]:
    if noise is None:
        return []
    rows = zip(_noise_rows(noise), (DPS_PER_RT_HZ, DPS, DPS_PER_RT_S))
    return [Quantity(name, value, unit) for (name, value, source), unit in rows if source == "measured"]


def typical_noise(noise: NoiseRecord | None) -> list[str]:
    """Kinds of noise that were not measured, with the source of each value. The uncertainties include them."""
    if noise is None:
        return []
    return [f"{name}: {source}" for name, _, source in _noise_rows(noise) if source != "measured"]
