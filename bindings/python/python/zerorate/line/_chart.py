"""The control chart as a picture."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from ._errors import LineError
from ._listing import printable
from ._spc import LABELS, Chart
from ._statistics import moving_ranges

KINDS = (".svg", ".png")


def save_chart(chart: Chart, path: Path, *, force: bool = False) -> None:
    """Writes the chart of the values and of their moving ranges; it gets its name only when it is complete."""
    if path.suffix.lower() not in KINDS:
        raise LineError(f"{path}: a chart is written as {' or '.join(KINDS)}")
    if path.exists() and not force:
        raise LineError(f"{path} exists; give another name, or --force")
    part = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        draw(chart).savefig(part, dpi=150)
        os.replace(part, path)
    except OSError as error:
        with suppress(OSError):
            part.unlink()
        raise LineError(f"{path}: {error.strerror or error}") from None


def draw(chart: Chart) -> Any:
    """The figure."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 6), layout="constrained")
    values, ranges = figure.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    draw_values(values, chart)
    ranges.plot(range(2, len(chart.values) + 1), moving_ranges(chart.values), "o-", color="C0", markersize=4)
    draw_lines(ranges, {"mean": (chart.chart.mean_range, "C2"), "UCL": (chart.chart.range_ucl, "C3")})
    ranges.set_ylim(bottom=0)
    ranges.set_ylabel("moving range")
    ranges.set_xlabel("unit, in the order of measurement")
    return figure


def draw_values(axes: Any, chart: Chart) -> None:
    """The upper panel: values, control limits, limits of the product, and signals."""
    known = chart.chart
    count = len(chart.values)
    axes.plot(range(1, count + 1), chart.values, "o-", color="C0", markersize=4)
    signals = sorted({signal.index for signal in chart.signals})
    axes.plot([index + 1 for index in signals], [chart.values[index] for index in signals], "o", color="C3")
    draw_lines(axes, {"mean": (known.mean, "C2"), "UCL": (known.ucl, "C3"), "LCL": (known.lcl, "C3")})
    if chart.limit is not None:
        limits = {"upper limit": chart.limit.upper, "lower limit": chart.limit.lower}
        draw_lines(axes, {name: (value, "0.4") for name, value in limits.items() if value is not None})
    if count <= 30:
        serials = [printable(one.serial) for one in chart.points]
        axes.set_xticks(range(1, count + 1), serials, rotation=60, fontsize=7, parse_math=False)
    axes.set_ylabel(LABELS[chart.quantity])
    simulated = "SIMULATED: " if chart.simulated else ""
    axes.set_title(f"{simulated}{chart.part}, axis {chart.axis}: {count} units", parse_math=False)


def draw_lines(axes: Any, lines: dict[str, tuple[float, str]]) -> None:
    """Horizontal lines with their names at the right edge."""
    for name, (value, color) in lines.items():
        axes.axhline(value, color=color, linewidth=1)
        axes.text(1.005, value, name, color=color, fontsize=8, va="center", transform=axes.get_yaxis_transform())
