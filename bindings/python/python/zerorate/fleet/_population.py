"""Statistics of many calibrations, as pure functions of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]

# Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993: a robust z beyond ±3.5 is an outlier.
OUTLIER = 3.5
# The standard deviation of a normal distribution over its median absolute deviation.
SIGMA_PER_MAD = 1.4826


def robust_z(values: Numbers) -> Numbers:
    """The robust z of each value, (x − median) / (1.4826 · MAD); all 0 if more than half of the values are equal."""
    deviation = values - np.median(values)
    scale = SIGMA_PER_MAD * np.median(np.abs(deviation))
    return np.zeros_like(values) if scale == 0 else deviation / scale


@dataclass(frozen=True)
class Trend:
    """The slope of a straight line, fitted to values over time."""

    slope: float
    u_slope: float

    @property
    def is_seen(self) -> bool:
        return abs(self.slope) > 1.96 * self.u_slope


def trend(x: Numbers, y: Numbers) -> Trend | None:
    """The least-squares line of y over x; None for fewer than eight points, or if all x are equal."""
    spread = float(np.sum((x - x.mean()) ** 2)) if len(x) else 0.0
    if len(x) < 8 or spread == 0:
        return None
    slope = float(np.sum((x - x.mean()) * (y - y.mean())) / spread)
    rest = y - y.mean() - slope * (x - x.mean())
    return Trend(slope, float(np.sqrt(np.sum(rest**2) / (len(x) - 2) / spread)))


@dataclass(frozen=True)
class Disagreement:
    """Two calibrations of one sensor that differ by more than their uncertainty."""

    serial: str
    axis: Optional[str]
    """The name of the axis; None for a part with only one axis."""
    urls: tuple[str, str]
    temp_c: float
    difference_dps: float
    """Second correction minus first, at `temp_c`, °/s."""
    limit_dps: float
    """95 % of the differences are within ± this limit if the sensor did not change, °/s."""


def disagreements(rows: Sequence[dict[str, Any]]) -> list[Disagreement]:
    """Finds pairs of calibrations of one axis, from two recordings, whose corrections at a temperature T disagree.

    The correction at T is c = PBC + d · BTC with d = T − T3, and its variance u²(PBC) + d² u²(BTC) + 2 d cov(PBC, BTC)
    (JCGM 100:2008, 5.2.2). T is the middle of the temperatures that both calibrations cover. If they have none in
    common, T is the middle of the gap between their temperatures.
    """
    by_axis: dict[tuple[str, str, Optional[str]], list[dict[str, Any]]] = {}
    for row in rows:
        if row["state"] == "ok" and row["serial"] and row["pbc_dps"] is not None:
            by_axis.setdefault((row["part"], row["serial"], row.get("axis")), []).append(row)
    pairs = (pair for axis in by_axis.values() for pair in combinations(axis, 2))
    compared = (_compare(*pair) for pair in pairs if pair[0]["capture_sha256"] != pair[1]["capture_sha256"])
    return [found for found in compared if abs(found.difference_dps) > found.limit_dps]


def _compare(first: dict[str, Any], second: dict[str, Any]) -> Disagreement:
    low = max(first["temp_min_c"], second["temp_min_c"])
    high = min(first["temp_max_c"], second["temp_max_c"])
    temp_c = (low + high) / 2
    values, variances = zip(_correction(first, temp_c), _correction(second, temp_c))
    limit = 1.96 * float(np.sqrt(sum(variances)))
    urls = (first["url"], second["url"])
    return Disagreement(first["serial"], first.get("axis"), urls, temp_c, values[1] - values[0], limit)


def _correction(row: dict[str, Any], temp_c: float) -> tuple[float, float]:
    """The correction at a temperature and its variance."""
    d = temp_c - row["t3_c"]
    covariance = row["cov_pbc_btc_dps2_per_c"] or 0.0
    variance = row["u_pbc_dps"] ** 2 + (d * row["u_btc_dps_per_c"]) ** 2 + 2 * d * covariance
    return row["pbc_dps"] + d * row["btc_dps_per_c"], max(variance, 0.0)
