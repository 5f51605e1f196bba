"""Degrees of freedom, confidence limits and noise types."""

from __future__ import annotations

from math import erf, exp, log, sqrt
from typing import Any

import numpy as np

from .. import _zerorate

ONE_SIGMA_CI = erf(1 / sqrt(2))
"""Probability of ± one standard deviation: 0.683."""


def confidence_interval(dev: float, edf: float, ci: float = ONE_SIGMA_CI) -> tuple[float, float]:
    """Limits (low, high) of a deviation with `edf` degrees of freedom, NIST SP 1065 equation 45.

    `ci` is the probability; as in allantools, `ci` and 1 − `ci` are the same.
    """
    confidence = max(abs(ci), abs(ci - 1))
    return _zerorate.interval(float(dev), float(edf), float(confidence))


def edf_greenhall(
    alpha: float, d: int, m: float, N: int, overlapping: bool = False, modified: bool = False, verbose: bool = False
) -> float:
    """Equivalent degrees of freedom of Greenhall and Riley, PTTI 2003.

    Parameters
    ----------
    alpha
        Noise exponent, 2 … −4, with alpha + 2 d > 1.
    d
        Order of the difference: 1, 2 (Allan), 3 (Hadamard).
    m
        Samples in each average.
    N
        Phase points.
    overlapping
        For oadev, ohdev.
    modified
        For mdev, tdev.
    verbose
        Print the result.

    Raises
    ------
    NotImplementedError
        For other exponents.
    """
    if not alpha + 2 * d > 1:
        raise NotImplementedError(f"alpha = {alpha}: the variance of differences of order {d} does not converge")
    edf = _zerorate.finite_difference_edf(int(d), bool(overlapping), bool(modified), int(alpha), int(m), int(N))
    if verbose:
        print(f"edf_greenhall: alpha = {alpha}, d = {d}, m = {m}, N = {N}: {edf}")
    return edf


def edf_totdev(N: float, m: float, alpha: float) -> float:
    """Equivalent degrees of freedom of TOTDEV: b N/m − c, NIST SP 1065 table 7; `edf_simple` for phase noise."""
    table = {0: (1.50, 0.0), -1: (1.17, 0.22), -2: (0.93, 0.36)}
    if int(alpha) not in table:
        return edf_simple(N, m, alpha)
    b, c = table[int(alpha)]
    return b * N / m - c


def edf_simple(N: float, m: float, alpha: float) -> float:
    """Approximate degrees of freedom of OADEV for N phase points, NIST SP 1065 table 5; N − 1 for other exponents than
    2 … −2."""
    if alpha == 2:
        return (N + 1) * (N - 2 * m) / (2 * (N - m))
    if alpha == 1:
        return exp(sqrt(log((N - 1) / (2 * m)) * log((2 * m + 1) * (N - 1) / 4)))
    if alpha == 0:
        return (3 * (N - 1) / (2 * m) - 2 * (N - 2) / N) * 4 * m**2 / (4 * m**2 + 5)
    if alpha == -1:
        return 2 * (N - 2) / (2.3 * N - 4.9) if m == 1 else 5 * N**2 / (4 * m * (N + 3 * m))
    if alpha == -2:
        return (N - 2) / (m * (N - 3) ** 2) * ((N - 1) ** 2 - 3 * m * (N - 1) + 4 * m**2)
    return N - 1.0


def autocorr_noise_id(
    x: Any, af: int, data_type: str = "phase", dmin: int = 0, dmax: int = 2
) -> tuple[int, float, int, float]:
    """Noise type by the lag-1 autocorrelation (Riley and Greenhall, EFTF 2004).

    With r1 of the record at every τ, its trend removed, and ρ = r1/(1 + r1): differenced d times until ρ < 1/4 (at
    least `dmin`, at most `dmax` times); then α = −2 (ρ + d), and 2 more for phase.

    Parameters
    ----------
    x
        Phase or frequency.
    af
        Samples in each average.
    data_type
        ``phase`` or ``freq``.
    dmin, dmax
        Fewest and most differences; `dmax` is 2 for Allan and 3 for Hadamard deviations.

    Returns
    -------
    (alpha_int, alpha, d, rho)

    Raises
    ------
    NotImplementedError
        Below 30 averages. `zerorate.allan` identifies the noise there too.
    """
    values = np.asarray(x, dtype=np.float64)
    is_phase = data_type == "phase"
    if is_phase:
        series = values[::af]
    else:
        series = values[: len(values) // af * af].reshape(-1, af).mean(axis=1)
    if len(series) < 30:
        raise NotImplementedError(f"{len(series)} averages are too few to identify the noise: 30 are needed")
    at = np.linspace(-1.0, 1.0, len(series))
    degree = 2 if is_phase else 1
    series = series - np.polynomial.polynomial.polyval(at, np.polynomial.polynomial.polyfit(at, series, degree))
    d = 0
    while True:
        deviation = series - series.mean()
        r1 = float(deviation[1:] @ deviation[:-1] / (deviation @ deviation))
        rho = r1 / (1 + r1)
        if d >= dmin and (rho < 0.25 or d >= dmax):
            shift = 2 if is_phase else 0
            return int(-round(2 * rho) - 2 * d + shift), -2 * (rho + d) + shift, d, rho
        series, d = np.diff(series), d + 1


def confidence_interval_noiseID(
    x: Any, dev: float, af: int, dev_type: str = "adev", data_type: str = "phase", ci: float = ONE_SIGMA_CI
) -> tuple[float, float]:
    """Limits (low, high) of a deviation of the record `x` at `af` samples: noise type, degrees of freedom, χ².

    `dev_type` is ``adev``, ``oadev``, ``mdev``, ``tdev``, ``hdev`` or ``ohdev``.

    Raises
    ------
    NotImplementedError
        For other deviations, and below 30 averages.
    """
    kinds = {name: difference for name, _, difference in _zerorate.statistics() if difference}
    if dev_type not in kinds:
        raise NotImplementedError(f"dev_type = {dev_type!r}: give one of {', '.join(kinds)}")
    d, overlapping, modified = kinds[dev_type]
    alpha = autocorr_noise_id(x, int(af), data_type=data_type, dmax=d)[0]
    edf = edf_greenhall(alpha, d, af, len(x), overlapping=overlapping, modified=modified)
    return confidence_interval(dev, edf, ci)
