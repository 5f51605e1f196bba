"""Draws pictures with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from . import _frame, _zerorate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ._model import Fit
    from ._result import Allan
    from ._tempcal import BiasAxis

_FLOOR_PER_B = np.sqrt(2 * np.log(2) / np.pi)
"""The floor of the Allan deviation in units of B, IEEE Std 952-1997 C.1.3."""

_BAND = 1.96
"""Half width of a 95 % band in standard uncertainties."""

_TITLES = dict(_zerorate.statistics())


def curves(axes: Sequence[Allan], ax: Axes | None) -> Figure:
    """Draws several deviations in one plot, each with its limits and its model."""
    _check(axes)
    if ax is not None:
        _draw(axes, ax)
        return ax.figure  # type: ignore[return-value]
    figure = _frame.needed("matplotlib.pyplot", "plot()").figure(figsize=(7.5, 5.0), layout="constrained")
    ax = figure.add_subplot()
    _draw(axes, ax)
    _settle(axes, ax)
    return figure  # type: ignore[no-any-return]


def kinds(groups: Sequence[Sequence[Allan]]) -> Figure:
    """Draws a plot for each kind of axis, side by side."""
    for group in groups:
        _check(group)
    pyplot = _frame.needed("matplotlib.pyplot", "plot()")
    figure = pyplot.figure(figsize=(6.5 * max(len(groups), 1), 5.0), layout="constrained")
    for at, group in enumerate(groups, start=1):
        ax = figure.add_subplot(1, len(groups), at)
        _draw(group, ax)
        _settle(group, ax)
        ax.set_title(group[0].kind or "")
    return figure  # type: ignore[no-any-return]


def biases(axes: Sequence[BiasAxis]) -> Figure:
    """Draws the bias of each axis over temperature, a row for each sensor."""
    pyplot = _frame.needed("matplotlib.pyplot", "plot()")
    sensors: dict[str, list[BiasAxis]] = {}
    for axis in axes:
        sensors.setdefault(axis.sensor, []).append(axis)
    wide = max(map(len, sensors.values()), default=1)
    figure = pyplot.figure(figsize=(4.5 * wide, 3.5 * max(len(sensors), 1)), layout="constrained")
    for row, of_sensor in enumerate(sensors.values()):
        for at, axis in enumerate(of_sensor):
            _bias(figure.add_subplot(len(sensors), wide, row * wide + at + 1), axis)
    return figure  # type: ignore[no-any-return]


def _bias(ax: Axes, axis: BiasAxis) -> None:
    means, curve = axis.means, axis.curve
    for name, of, colour in (("warming", means.is_warming, "C3"), ("cooling", ~means.is_warming, "C0")):
        if of.any():
            ax.plot(means.temp_c[of], means.bias[of], ".", color=colour, markersize=2, alpha=0.5, label=name)
    ax.plot(curve.temp_c, curve.bias, color="0.1", linewidth=1.2, label="curve, and its 95 % band")
    half = _BAND * curve.u
    ax.fill_between(curve.temp_c, curve.bias - half, curve.bias + half, color="0.1", alpha=0.15, linewidth=0)
    ax.set_title(axis.name)
    ax.set_xlabel("temperature / °C")
    ax.set_ylabel(f"bias / {axis.unit}")
    ax.grid(True, alpha=0.35)
    ax.legend(fontsize="small", framealpha=0.85)


def _check(axes: Sequence[Allan]) -> None:
    """Checks that the axes have one unit and that some deviation is above zero, before a figure is opened."""
    units = sorted({axis.unit for axis in axes})
    if len(units) > 1:
        told = ", ".join(units)
        raise ValueError(f"the units differ ({told}), so they cannot share a picture: draw each by itself")
    if not any((axis.dev > 0).any() for axis in axes):
        whose = ", ".join(axis.name for axis in axes)
        raise ValueError(f"there is nothing to draw: no deviation of {whose} is above zero")


def _draw(axes: Sequence[Allan], ax: Axes) -> None:
    for axis in axes:
        _curve(ax, axis, len(axes) == 1)
    stats = {axis.stat for axis in axes}
    unit = axes[0].unit + ("·s" if stats == {"tdev"} else "")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("averaging time τ / s")
    ax.set_ylabel(f"{_TITLES[next(iter(stats))] if len(stats) == 1 else 'deviation'} / {unit}")
    ax.grid(True, which="major", alpha=0.35)
    ax.grid(True, which="minor", alpha=0.12)
    drawn, labels = ax.get_legend_handles_labels()
    # curves come before their models
    order = sorted(range(len(drawn)), key=lambda at: not isinstance(drawn[at], tuple))
    title = None if len(axes) == 1 else "points: measured, lines: models, bands: 95 % of other records expected"
    ax.legend(
        [drawn[at] for at in order], [labels[at] for at in order], fontsize="small", title=title,
        title_fontsize="small", framealpha=0.85, loc=_free_corner(axes),
    )


def _settle(axes: Sequence[Allan], ax: Axes) -> None:
    """Sets the limits of the vertical axis by the measured points, since a band may reach down to zero."""
    points = [axis for axis in axes if len(axis.dev) and (axis.dev > 0).all()]
    if points:
        ax.set_ylim(min(axis.lo.min() for axis in points) / 1.8, max(axis.hi.max() for axis in points) * 1.8)


def _free_corner(axes: Sequence[Allan]) -> Literal["lower left", "upper left"]:
    """The corner for the legend: below the start of falling curves, or above the start of rising curves."""
    falling = sum(float(np.sign(axis.dev[0] - np.median(axis.dev))) for axis in axes if len(axis.dev))
    return "lower left" if falling >= 0 else "upper left"


def _curve(ax: Axes, axis: Allan, is_alone: bool) -> None:
    percent = f"{100 * axis.confidence:.4g} %"
    label = f"{axis.name}, limits of {percent}" if is_alone else axis.name
    errors = np.array([axis.dev - axis.lo, axis.hi - axis.dev])
    drawn = ax.errorbar(
        axis.tau_s, axis.dev, yerr=errors, fmt="o", markersize=3.5, capsize=2, linewidth=1, label=label
    )
    colour = drawn.lines[0].get_color()
    if axis.model is None or axis.predicted_lo is None or axis.predicted_hi is None or axis.fit is None:
        return
    name = "model, REJECTED" if axis.fit.rejected else "model"
    label = f"{name}, and where it expects 95 % of other records" if is_alone else ""
    ax.plot(axis.tau_s, axis.model, color=colour, linewidth=1.2, label=label or None)
    alpha = 0.15 if is_alone else 0.08
    ax.fill_between(axis.tau_s, axis.predicted_lo, axis.predicted_hi, color=colour, alpha=alpha, linewidth=0)
    if is_alone and not axis.fit.rejected:
        _coefficients(ax, axis, axis.fit)


def _coefficients(ax: Axes, axis: Allan, fit: Fit) -> None:
    """Draws the lines of N, B and K that are identified."""
    tau = axis.tau_s
    lines = [
        ("N", fit.n, fit.n.value / np.sqrt(tau), "N/√τ"),
        ("B", fit.b, np.full(len(tau), _FLOOR_PER_B * fit.b.value), "0.664·B"),
        ("K", fit.k, fit.k.value * np.sqrt(tau / 3), "K·√(τ/3)"),
    ]
    for (name, coefficient, line, formula), style in zip(lines, ("--", ":", "-.")):
        if coefficient.identified:
            inside = (line >= axis.lo.min() / 2) & (line <= axis.hi.max() * 2)
            text = f"{formula}, {name} = {coefficient.value:.3g} {coefficient.unit}"
            ax.plot(tau[inside], line[inside], style, color="0.35", linewidth=1, label=text)
