"""Statistics of a process: pure functions of values in the order of their production.

Sources: NIST/SEMATECH e-Handbook of Statistical Methods, 6.3.2.2 (individuals chart), 6.1.6 (indices) and 6.3.2
(Western Electric rules); A. F. Bissell, "How reliable is your capability index?", Applied Statistics 39 (1990)
331-340; J. D. Cryer and T. P. Ryan, "The estimation of sigma for an X chart: MR/d2 or S/c4?", Journal of Quality
Technology 22 (1990) 187-192.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

D2 = 1.128
"""Mean range of two normal values, in standard deviations."""
D4 = 3.267
"""Upper limit of the chart of moving ranges, in mean moving ranges."""
MOVING_RANGE_EFFICIENCY = 0.605
"""Variance of s over the variance of the mean moving range / d2, for many values (Cryer and Ryan)."""
RULES = ((1, 1, 1, 3.0), (2, 2, 3, 2.0), (3, 4, 5, 1.0), (4, 8, 8, 0.0))
"""Western Electric rules: number, how many, of how many values, beyond how many standard deviations on one side."""


@dataclass(frozen=True)
class Individuals:
    """A chart of individual values and of their moving ranges, in the unit of the values."""

    mean: float
    """Mean, the centre line."""
    mean_range: float
    """Mean moving range of two successive values."""
    sigma: float
    """Standard deviation within: mean moving range / d2."""
    lcl: float
    """Lower control limit: mean − 3 sigma."""
    ucl: float
    """Upper control limit: mean + 3 sigma."""
    range_ucl: float
    """Upper control limit of the moving ranges: D4 × mean moving range."""


@dataclass(frozen=True)
class Signal:
    """A sign that the process is not in control."""

    rule: int
    """Western Electric rule, 1 to 4."""
    index: int
    """Index of the last value of the pattern."""


@dataclass(frozen=True)
class Capability:
    """Indices of a process against its limits. An index is None where a limit is missing, or all values are equal."""

    cp: float | None
    """(upper − lower) / 6 sigma within."""
    cpk: float | None
    """Distance of the mean from the nearer limit / 3 sigma within."""
    cpk_lower: float | None
    """Lower confidence bound of Cpk."""
    pp: float | None
    """(upper − lower) / 6 sigma overall."""
    ppk: float | None
    """Distance of the mean from the nearer limit / 3 sigma overall."""
    ppk_lower: float | None
    """Lower confidence bound of Ppk."""
    sigma_overall: float
    """Standard deviation of all values, in their unit."""
    confidence: float
    """One-sided probability of the bounds."""


def moving_ranges(values: Sequence[float]) -> list[float]:
    """The differences of successive values, without sign."""
    return [abs(after - before) for before, after in zip(values, values[1:])]


def individuals(values: Sequence[float]) -> Individuals:
    """The chart of at least two values.

    Raises
    ------
    ValueError
        If there are fewer.
    """
    if len(values) < 2:
        raise ValueError(f"a chart needs two values or more, and there are {len(values)}")
    mean = math.fsum(values) / len(values)
    mean_range = math.fsum(moving_ranges(values)) / (len(values) - 1)
    sigma = mean_range / D2
    return Individuals(mean, mean_range, sigma, mean - 3 * sigma, mean + 3 * sigma, D4 * mean_range)


def capability(
    values: Sequence[float], lower: float | None, upper: float | None, confidence: float = 0.95
) -> Capability:
    """Cp, Cpk, Pp and Ppk, with one-sided lower confidence bounds by Bissell's formula.

    The bound of Ppk has n − 1 degrees of freedom. Sigma within, from moving ranges, is less certain for as many
    values: the bound of Cpk has 0.605 (n − 1).

    Raises
    ------
    ValueError
        If there are fewer than two values.
    """
    chart, count = individuals(values), len(values)
    overall = math.sqrt(math.fsum((value - chart.mean) ** 2 for value in values) / (count - 1))
    cp, cpk = indices(chart.mean, chart.sigma, lower, upper)
    pp, ppk = indices(chart.mean, overall, lower, upper)
    within = MOVING_RANGE_EFFICIENCY * (count - 1)
    return Capability(
        cp=cp,
        cpk=cpk,
        cpk_lower=None if cpk is None else bissell(cpk, count, within, confidence),
        pp=pp,
        ppk=ppk,
        ppk_lower=None if ppk is None else bissell(ppk, count, count - 1, confidence),
        sigma_overall=overall,
        confidence=confidence,
    )


def indices(mean: float, sigma: float, lower: float | None, upper: float | None) -> tuple[float | None, float | None]:
    """Cp and Cpk of a mean and a standard deviation; None where they are not defined."""
    if sigma == 0 or (lower is None and upper is None):
        return None, None
    above = math.inf if upper is None else upper - mean
    below = math.inf if lower is None else mean - lower
    both = None if lower is None or upper is None else (upper - lower) / (6 * sigma)
    return both, min(above, below) / (3 * sigma)


def bissell(index: float, count: int, freedom: float, confidence: float = 0.95) -> float:
    """Lower bound of Cpk or Ppk: index − z √(1 / 9n + index² / 2ν), z the one-sided quantile of ``confidence``."""
    z = NormalDist().inv_cdf(confidence)
    return index - z * math.sqrt(1 / (9 * count) + index**2 / (2 * freedom))


def western_electric(values: Sequence[float], mean: float, sigma: float) -> list[Signal]:
    """The signals of rules 1 to 4, in the order of the values.

    Rule 1: one value beyond 3 sigma. Rule 2: two of three beyond 2 sigma. Rule 3: four of five beyond 1 sigma. Rule 4:
    eight in a row on one side. Each counts one side of the mean, and the last value belongs to the pattern.
    """
    return [
        Signal(rule, index)
        for index in range(len(values))
        for rule, count, span, limit in RULES
        for window in [values[max(0, index - span + 1) : index + 1]]
        if any(completes([side * (value - mean) - limit * sigma for value in window], count) for side in (1, -1))
    ]


def completes(beyond: Sequence[float], count: int) -> bool:
    """Whether the last of some values is beyond, and makes it ``count`` or more. Positive is beyond."""
    return beyond[-1] > 0 and sum(value > 0 for value in beyond) >= count
