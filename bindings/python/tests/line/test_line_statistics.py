"""Statistics against published examples, and against what simulated processes do."""

from __future__ import annotations

import random

import pytest

from zerorate.line import capability, individuals, western_electric
from zerorate.line._statistics import bissell, indices

# NIST/SEMATECH e-Handbook of Statistical Methods, 6.3.2.2: flow rate of ten batches.
FLOW = [49.6, 47.6, 49.9, 51.3, 47.8, 51.2, 52.6, 52.4, 53.6, 52.1]


def test_the_individuals_chart_of_the_handbook() -> None:
    chart = individuals(FLOW)
    assert chart.mean == pytest.approx(50.81, abs=5e-5)
    assert chart.mean_range == pytest.approx(1.8778, abs=5e-5)
    assert chart.ucl == pytest.approx(55.8041, abs=5e-5)
    assert chart.lcl == pytest.approx(45.8159, abs=5e-5)
    assert chart.range_ucl == pytest.approx(3.267 * 16.9 / 9)
    assert western_electric(FLOW, chart.mean, chart.sigma) == []


def test_the_indices_of_the_handbook() -> None:
    """6.1.6: limits 8 and 20, mean 16, standard deviation 2."""
    assert indices(16.0, 2.0, 8.0, 20.0) == pytest.approx((1.0, 0.6667), abs=5e-5)


def test_one_limit_gives_cpk_without_cp() -> None:
    assert indices(16.0, 2.0, None, 20.0) == (None, 4 / 6)
    assert indices(16.0, 2.0, 8.0, None) == (None, 8 / 6)
    assert indices(16.0, 2.0, None, None) == (None, None)


def test_bissell_bound_of_a_published_interval() -> None:
    """Quality Digest, May 2000, "Last Word": Cpk 1.15 of 45 values lies between 0.89 and 1.41 with 95 % confidence."""
    low = bissell(1.15, 45, 44, confidence=0.975)
    assert low == pytest.approx(0.89, abs=0.005)
    assert 2 * 1.15 - low == pytest.approx(1.41, abs=0.005)


@pytest.mark.parametrize("name", ["cpk", "ppk"])
def test_lower_bounds_hold_as_often_as_they_say(name: str) -> None:
    """1000 processes with Cpk 1.2: the bound lies below in 95 %, ± 3 standard deviations and the formula's error."""
    source, held = random.Random(16130), 0
    for _ in range(1000):
        values = [source.gauss(0.0, 1.0) for _ in range(50)]
        bound = getattr(capability(values, -3.6, 4.2), f"{name}_lower")
        held += bound <= 1.2
    assert 0.92 <= held / 1000 <= 0.98


def test_equal_values_have_no_indices_and_no_signals() -> None:
    known = capability([2.0] * 10, 1.0, 3.0)
    assert (known.cp, known.cpk, known.ppk, known.cpk_lower) == (None, None, None, None)
    assert western_electric([2.0] * 10, 2.0, 0.0) == []


def test_one_value_has_no_chart() -> None:
    with pytest.raises(ValueError, match="two values or more, and there are 1"):
        individuals([1.0])


@pytest.mark.parametrize(
    ("values", "signals"),
    [
        ([0.0, 3.1, 0.0], [(1, 1)]),
        ([0.0, -3.1, 0.0], [(1, 1)]),
        ([0.0, 3.0, 0.0], []),
        ([2.1, 0.0, 2.1, 0.0], [(2, 2)]),
        ([2.1, 0.0, 0.0, 2.1], []),
        ([2.1, 0.0, -2.1], []),
        ([2.0, 2.0, 0.0], []),
        ([1.1, 1.1, 0.0, 1.1, 1.1], [(3, 4)]),
        ([1.1, 1.1, 0.0, 0.0, 1.1, 1.1], []),
        ([-0.1] * 8, [(4, 7)]),
        ([0.1] * 7 + [-0.1], []),
        ([0.1] * 9, [(4, 7), (4, 8)]),
    ],
)
def test_western_electric_rules_by_hand(values: list[float], signals: list[tuple[int, int]]) -> None:
    """Mean 0, standard deviation 1."""
    assert [(one.rule, one.index) for one in western_electric(values, 0.0, 1.0)] == signals


def test_false_signals_are_as_rare_as_published() -> None:
    """A process in control has its first signal after 91.75 values on average (Champ and Woodall 1987).

    2500 runs: the average varies by 1.8.
    """
    source, total, runs = random.Random(1042), 0, 2500
    for _ in range(runs):
        total += first_signal(source)
    assert total / runs == pytest.approx(91.75, abs=6)


def first_signal(source: random.Random) -> int:
    """How many values it takes to the first signal."""
    values = [source.gauss(0.0, 1.0) for _ in range(8)]
    signals = western_electric(values, 0.0, 1.0)
    count = len(values)
    while not signals:
        values = values[-7:] + [source.gauss(0.0, 1.0) for _ in range(60)]
        signals = [one for one in western_electric(values, 0.0, 1.0) if one.index >= 7]
        first = signals[0].index if signals else len(values) - 1
        count += first - 6
    return count if count > 8 else signals[0].index + 1
