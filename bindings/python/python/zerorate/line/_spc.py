"""The control chart of a quantity: the units' current results, in the order in which they were measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ._errors import LineError
from ._limits import Limit
from ._reading import Result
from ._statistics import (
    Capability,
    Individuals,
    Signal,
    capability,
    individuals,
    moving_ranges,
    western_electric,
)

LABELS = {"pbc_dps": "PBC, °/s", "btc_dps_per_c": "BTC, °/s/°C", "t3_c": "T3, °C"}
LABELS.update(n="N, °/√s", b="B, °/s", k="K, °/s/√s")
"""What listings and charts call a quantity, with its unit."""


@dataclass(frozen=True)
class Chart:
    """Values with their chart, indices and signals."""

    quantity: str
    """Name of the quantity, with the unit."""
    part: str
    """Kind of the parts."""
    axis: str
    """Their axis."""
    points: list[Result]
    """The results."""
    values: list[float]
    """Their values."""
    chart: Individuals
    """Centre lines and control limits."""
    limit: Limit | None
    """The limits of the product; None if none were given."""
    capability: Capability | None
    """The indices against these limits."""
    signals: list[Signal]
    """Western Electric signals."""
    simulated: bool
    """Whether simulated units are among the values."""
    simulated_left_out: int
    """Simulated results that were left out."""
    without_value: int
    """Results that do not have the quantity."""


def make_chart(
    results: Sequence[Result], quantity: str, limit: Limit | None, *, axis: str | None = None, simulated: bool = False
) -> Chart:
    """The chart of one quantity of one axis of one kind of part.

    Raises
    ------
    LineError
        If there are fewer than two values, or results of several kinds of parts or axes.
    """
    current = [one for one in results if one.current and axis in (None, one.axis)]
    kept = [one for one in current if simulated or not one.simulated]
    points = [one for one in kept if quantity in one.numbers]
    left_out = len(current) - len(kept)
    if len(points) < 2:
        hint = f"; {left_out} simulated left out, --simulated takes them" if left_out else ""
        raise LineError(f"a chart needs two results with {quantity}, and the record has {len(points)}{hint}")
    part = only("--part", {one.part for one in points})
    name = only("--axis", {one.axis or "" for one in points})
    values = [float(one.numbers[quantity] or 0) for one in points]
    chart = individuals(values)
    return Chart(
        quantity=quantity,
        part=part,
        axis=name,
        points=points,
        values=values,
        chart=chart,
        limit=limit,
        capability=None if limit is None else capability(values, limit.lower, limit.upper),
        signals=western_electric(values, chart.mean, chart.sigma),
        simulated=any(one.simulated for one in points),
        simulated_left_out=left_out,
        without_value=len(kept) - len(points),
    )


def only(option: str, names: set[str]) -> str:
    """The only name of a set."""
    if len(names) > 1:
        raise LineError(f"the record has results of {', '.join(sorted(names))}: choose one by {option}")
    return names.pop()


def to_json(chart: Chart) -> dict[str, Any]:
    """The chart as values of JSON."""
    points = [
        {
            "serial": one.serial,
            "result": one.result,
            "simulated": one.simulated,
            "value": value,
            "moving_range": change,
        }
        for one, value, change in zip(chart.points, chart.values, [None, *moving_ranges(chart.values)])
    ]
    signals = [{**asdict(signal), "serial": chart.points[signal.index].serial} for signal in chart.signals]
    kept = ("quantity", "part", "axis", "simulated", "simulated_left_out", "without_value")
    return {
        **{name: getattr(chart, name) for name in kept},
        "chart": asdict(chart.chart),
        "limit": None if chart.limit is None else asdict(chart.limit),
        "capability": None if chart.capability is None else asdict(chart.capability),
        "signals": signals,
        "points": points,
    }
