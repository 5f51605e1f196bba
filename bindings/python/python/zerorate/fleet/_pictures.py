"""Pictures of a population, as SVG."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ._population import OUTLIER, Numbers, robust_z

COLOUR, MARKED, LIMIT = "#3366aa", "#cc3311", "#ee7733"


def distribution(values: Numbers, label: str, limits: Sequence[float]) -> str:
    """Plots a histogram, with the data sheet's typical value or range if `limits` has one."""
    figure, ax = _figure()
    bins = int(np.clip(np.ceil(2 * np.cbrt(len(values))), 5, 60))  # Rice's rule
    ax.hist(values, bins=bins, color=COLOUR)
    if len(limits) == 2:
        ax.axvspan(*limits, color=LIMIT, alpha=0.15, label="data sheet, typical ± 2 σ", zorder=0)
    elif limits:
        ax.axvline(limits[0], color=LIMIT, label="data sheet, typical")
    if limits:
        ax.legend(loc="upper right")
    ax.set(xlabel=label, ylabel="captures")
    ax.locator_params("y", integer=True)
    return _svg(figure)


def over_order(rows: list[dict[str, Any]], values: Numbers, days: Optional[Numbers], unit: str) -> str:
    """Plots the values over time, or in order of the serial numbers if a capture has no date."""
    figure, ax = _figure()
    order = np.argsort(days) if days is not None else np.array(_by_serial(rows))
    x = days[order] if days is not None else np.arange(len(order), dtype=np.float64)
    is_far = np.abs(robust_z(values[order])) > OUTLIER
    ax.plot(x[~is_far], values[order][~is_far], ".", color=COLOUR)
    ax.plot(x[is_far], values[order][is_far], "o", color=MARKED, label="outliers")
    if is_far.any():
        ax.legend(loc="upper right")
    if days is None:
        ax.locator_params("x", integer=True)
    ax.set_xlabel("days since the first capture" if days is not None else "place in the order of serial numbers")
    ax.set_ylabel(unit)
    return _svg(figure)


def _by_serial(rows: list[dict[str, Any]]) -> list[int]:
    """The order of the rows by serial number, with all digits in a row as one number: A1-05, A1-9, A2-1, A10-1."""

    def key(index: int) -> list[str | int]:
        pieces = re.split(r"(\d+)", str(rows[index]["serial"] or ""))
        return [int(piece) if place % 2 else piece for place, piece in enumerate(pieces)]

    return sorted(range(len(rows)), key=key)


def by_group(groups: dict[str, Numbers], unit: str) -> str:
    """Plots a box for each group: quartiles, median, whiskers to the last value within 1.5 interquartile ranges."""
    figure, ax = _figure()
    ax.boxplot(list(groups.values()), orientation="horizontal")
    ax.set_yticks(range(1, len(groups) + 1), [f"{name} ({len(values)})" for name, values in groups.items()])
    ax.set(xlabel=unit)
    return _svg(figure)


def _figure() -> tuple[Figure, Axes]:
    figure = Figure(figsize=(5.6, 3.2), layout="constrained")
    ax = figure.add_subplot()
    ax.spines[["top", "right"]].set_visible(False)
    # a small number such as K has a power of ten at the end of the axis, and not in each label
    ax.ticklabel_format(scilimits=(-3, 4), useMathText=True)
    ax.locator_params("x", nbins=6)
    return figure, ax


def _svg(figure: Figure) -> str:
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None}, transparent=True)
    return text.getvalue()[text.getvalue().index("<svg") :]
