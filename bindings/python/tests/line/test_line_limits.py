"""Verdicts on the boundary, computed by hand, and files of limits."""

from __future__ import annotations

from pathlib import Path

import pytest
from line_helpers import LIMITS, LIMITS_TOML

from zerorate.line import Limit, Limits, LineError

# All numbers are exact in binary: a boundary is then a boundary.
GUARDED = Limit(-2.0, 2.0, "guarded")
SIMPLE = Limit(-2.0, 2.0, "simple")


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("value", "verdict"),
    [
        (0.0, "pass"),
        (1.5, "pass"),  # the acceptance limit 2 − 2 · 0.25 belongs to the acceptance interval
        (1.5 + 2**-40, "conditionalPass"),
        (2.0, "conditionalPass"),  # the limit itself conforms
        (2.0 + 2**-40, "conditionalFail"),
        (2.5, "conditionalFail"),
        (2.5 + 2**-40, "fail"),
    ],
)
def test_guarded_acceptance_with_u_of_a_quarter(value: float, verdict: str, sign: int) -> None:
    assert GUARDED.judge(sign * value, 0.25) == verdict


@pytest.mark.parametrize(("value", "verdict"), [(1.99, "pass"), (2.0, "pass"), (2.0 + 2**-40, "fail"), (-2.5, "fail")])
def test_simple_acceptance_ignores_the_uncertainty(value: float, verdict: str) -> None:
    assert SIMPLE.judge(value, 0.25) == verdict
    assert SIMPLE.judge(value, None) == verdict


def test_a_band_wider_than_the_tolerance_never_passes() -> None:
    assert GUARDED.judge(0.0, 1.5) == "conditionalPass"


def test_one_limit_has_no_other_side() -> None:
    assert Limit(None, 1.0, "guarded").judge(-1e9, 0.25) == "pass"
    assert Limit(1.0, None, "simple").judge(0.5, None) == "fail"


def test_what_is_not_known_does_not_pass() -> None:
    assert GUARDED.judge(0.0, None) == "undecided"
    assert SIMPLE.judge(None, 0.1) == "undecided"


def test_without_uncertainty_guarded_is_simple() -> None:
    assert GUARDED.judge(2.0, 0.0) == "pass"
    assert GUARDED.judge(2.5, 0.0) == "fail"


def test_a_file_of_limits(limits: Path) -> None:
    assert Limits.load(limits) == LIMITS


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("version = ", "versoin = "), "`version` is missing"),
        (('"test-1"', "1"), "`version` is missing"),
        (("[pbc_dps]", "[pbc]"), r"\[pbc\]: unknown quantity; there are pbc_dps, "),
        (("lower", "lowest"), "keys lower, upper and rule"),
        (('"guarded"', '"strict"'), "rule must be one of simple, guarded"),
        (('rule = "simple"', ""), "rule must be one of"),
        (("-1.0", "2.0"), "lower must be below upper"),
        (("-1.0", "inf"), "lower must be a finite number"),
        (("-1.0", "true"), "lower must be a finite number"),
        (("-1.0", '"-1"'), "lower must be a finite number"),
        (("upper = 0.1", ""), "give lower, upper or both"),
        (("-1.0", "-1,0"), "is not TOML"),
    ],
)
def test_a_wrong_file_of_limits_is_explained(change: tuple[str, str], said: str, limits: Path) -> None:
    limits.write_text(LIMITS_TOML.replace(*change))
    with pytest.raises(LineError, match=said):
        Limits.load(limits)


def test_limits_that_limit_nothing_are_refused(limits: Path) -> None:
    limits.write_text('version = "1"')
    with pytest.raises(LineError, match="limits no quantity"):
        Limits.load(limits)
