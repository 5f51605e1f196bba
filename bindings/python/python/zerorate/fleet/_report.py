"""``zerorate fleet report``: one page about a population of sensors."""

from __future__ import annotations

import io
import os
from collections import Counter
from dataclasses import dataclass
from datetime import datetime
from importlib.resources import files
from typing import Any, Optional

import jinja2
import numpy as np
import pyarrow.parquet as pq
from markupsafe import Markup

from .. import _zerorate
from . import _population, _program, _store
from ._plain import plain
from ._population import Numbers
from ._table import TABLE

# Largest number of rows of a list on the page. Except for warnings, the page states the number of further rows.
MOST_LISTED = 50
MOST_GROUPS = 12


@dataclass(frozen=True)
class Quantity:
    """A column of the table, with its name and unit on the page."""

    column: str
    name: str
    unit: str
    scale: float = 1.0
    of: str = "°/s"
    """The unit of the records to which the quantity applies."""


ACCELERATION = "m/s²"
QUANTITIES = [
    Quantity("pbc_dps", "Bias correction PBC", "°/s"),
    Quantity("btc_dps_per_c", "Temperature coefficient BTC", "°/s/°C"),
    Quantity("n", "Angle random walk N", "°/√h", 60.0),
    Quantity("b", "Bias instability B", "°/h", 3600.0),
    Quantity("k", "Rate random walk K", "°/s/√s"),
    Quantity("n", "Velocity random walk N", "m/s/√h", 60.0, ACCELERATION),
    Quantity("b", "Bias instability B of acceleration", "mg", 1000.0 / 9.80665, ACCELERATION),
    Quantity("k", "Acceleration random walk K", "m/s²/√s", 1.0, ACCELERATION),
]


@dataclass(frozen=True)
class Outlier:
    serial: str
    url: str
    quantity: str
    value: str
    z: str


def write(table: str, output: str, *, group: Optional[str] = None, force: bool = False) -> None:
    """Writes the page about a table, or about the table in a folder.

    Raises ValueError if there is no usable table or the page exists (without `force`), and OSError if a file cannot be
    read or written.
    """
    if os.path.exists(output) and not force:
        raise ValueError(f"{output} exists; give another name, or --force")
    rows = _rows(table)
    if group is not None and group not in rows[0]:
        raise ValueError(f"the table has no column {group}; it has {', '.join(rows[0])}")
    _zerorate.save_text(output, _page(rows, table, group), force)


def _rows(table: str) -> list[dict[str, Any]]:
    """The newest row of each file."""
    url = table if table.endswith(".parquet") else f"{table.rstrip('/')}/{TABLE}"
    try:
        found = pq.read_table(io.BytesIO(_store.read(url))).to_pylist()
    except FileNotFoundError as error:
        raise ValueError(f"there is no {url}; `zerorate fleet table` makes it") from error
    newest: dict[str, dict[str, Any]] = {}
    for row in sorted(found, key=lambda row: row["ended"]):
        newest[row["url"]] = row
    if not newest:
        raise ValueError(f"{url} has no rows")
    return list(newest.values())


def _page(rows: list[dict[str, Any]], table: str, group: Optional[str]) -> str:
    good, copies = _apart([row for row in rows if row["state"] == "ok"])
    axes = _axes(good)
    pairs = _population.disagreements(axes)
    text = files(__package__).joinpath("report.html.jinja").read_text(encoding="utf-8")
    template = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, finalize=_shown).from_string(text)
    outliers = _outliers(axes)
    return template.render(
        table=table,
        rows=len(rows),
        units=len({(row["part"], row["serial"]) for row in rows if row["serial"]}),
        nameless=sum(1 for row in rows if not row["serial"]),
        simulated=sum(1 for row in rows if row["simulated"]),
        programs=sorted({row["program"] for row in rows}),
        states=_states(rows),
        warnings=Counter(_codes(good)).most_common(MOST_LISTED),
        good=len(good),
        copies=copies[:MOST_LISTED],
        more_copies=max(len(copies) - MOST_LISTED, 0),
        outliers=outliers[:MOST_LISTED],
        more_outliers=max(len(outliers) - MOST_LISTED, 0),
        disagreements=pairs[:MOST_LISTED],
        more_disagreements=max(len(pairs) - MOST_LISTED, 0),
        pictures=[found for found in (_pictures(axes, quantity, group) for quantity in QUANTITIES) if found],
        group=group,
    )


def _states(rows: list[dict[str, Any]]) -> list[tuple[str, str, int, str]]:
    """The states with their reasons: state, reason, count, and the error of an example; the most frequent first."""
    counts = Counter((row["state"], row["code"] or "") for row in rows)
    errors = {(row["state"], row["code"] or ""): row["error"] or "" for row in reversed(rows)}
    # the code of a command that gave no reason of its own is its exit code
    words = {code: code.replace("exit-", "exit code ") for _, code in counts}
    return [(state, words[code], count, errors[state, code]) for (state, code), count in counts.most_common()]


def _shown(value: Any) -> Any:
    """Escapes a text for the page, except our own markup (pictures)."""
    return plain(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _apart(rows: list[dict[str, Any]]) -> tuple[list[dict[str, Any]], list[tuple[str, str]]]:
    """Removes rows of copied recordings. Returns the other rows, and for each copy its address and the original's."""
    first: dict[str, dict[str, Any]] = {}
    kept, copies = [], []
    for row in rows:
        samples = row["capture_sha256"] or row["url"]
        if first.setdefault(samples, row) is row:
            kept.append(row)
        else:
            copies.append((row["url"], first[samples]["url"]))
    return kept, copies


def _axes(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Splits rows into a row for each axis. The unit of a calibrated axis is °/s."""

    def unit(axis: dict[str, Any]) -> Optional[str]:
        return axis["unit"] if axis["pbc_dps"] is None else "°/s"

    of_axis = (
        {**row, **axis, "axis": axis["name"], "unit": unit(axis)} for row in rows for axis in row["axes"] or []
    )
    return [*(row for row in rows if not row["axes"]), *of_axis]


def _codes(rows: list[dict[str, Any]]) -> list[str]:
    """The codes of the warnings of all rows. A code that a row has several times counts once."""
    return [code for row in rows for code in {warning.split(":")[0] for warning in row["warnings"] or []}]


def _values(rows: list[dict[str, Any]], quantity: Quantity) -> tuple[list[dict[str, Any]], Numbers]:
    """The rows that have a quantity, and its values. A noise whose interval contains zero is left out."""
    lowest = f"{quantity.column}_lo"
    of_unit = (row for row in rows if row.get("unit", "°/s") == quantity.of)
    having = [row for row in of_unit if row[quantity.column] is not None and row.get(lowest, 1.0) > 0]
    return having, np.array([row[quantity.column] * quantity.scale for row in having], dtype=np.float64)


def _outliers(rows: list[dict[str, Any]]) -> list[Outlier]:
    """The axes with a robust z beyond ±3.5 in any quantity, the farthest first. An axis is compared with at least four
    axes of the same name in sensors of the same type."""
    found: list[tuple[float, Outlier]] = []

    def kind(row: dict[str, Any]) -> tuple[str, str]:
        return row["part"] or "", row.get("axis") or ""

    for part, axis in sorted({kind(row) for row in rows}):
        alike = [row for row in rows if kind(row) == (part, axis)]
        for quantity in QUANTITIES:
            having, values = _values(alike, quantity)
            z = _population.robust_z(values) if len(values) >= 5 else np.zeros(len(values))
            for row, value, distance in zip(having, values, z):
                if abs(distance) > _population.OUTLIER:
                    text = f"{value:.4g} {quantity.unit}"
                    name = f"{quantity.name}, axis {axis}" if axis else quantity.name
                    outlier = Outlier(row["serial"] or "?", row["url"], name, text, f"{distance:+.1f}")
                    found.append((abs(distance), outlier))
    return [outlier for _, outlier in sorted(found, key=lambda pair: -pair[0])]


def _limits(part: Optional[str]) -> dict[str, tuple[float, ...]]:
    """Typical values of the data sheet, in the units of the pictures: one value, or both ends of a range."""
    answer = _program.asked_for_part(part) if part else None
    if answer is None:
        return {}
    limits: dict[str, tuple[float, ...]] = {}
    bias = answer.get("bias", {})
    for column, name in (("pbc_dps", "initial_dps"), ("btc_dps_per_c", "tempco_dps_per_c")):
        if name in bias:
            # A correction is minus the bias that it removes; two standard deviations hold 95 %.
            value, u = -float(bias[name]["value"]), float(bias[name].get("u", 0.0))
            limits[column] = (value - 2 * u, value + 2 * u)
    noise = answer.get("noise", {})
    if "white_dps_per_rt_hz" in noise:  # N² is half of a one-sided density
        limits["n"] = (60.0 * float(noise["white_dps_per_rt_hz"]["value"]) / float(np.sqrt(2)),)
    if "flicker_floor_dps" in noise:  # the floor of the Allan deviation is 0.664 B, IEEE Std 952-1997, C.1.3
        limits["b"] = (3600.0 * float(noise["flicker_floor_dps"]["value"]) / 0.664,)
    return limits


def _pictures(rows: list[dict[str, Any]], quantity: Quantity, group: Optional[str]) -> Optional[dict[str, str]]:
    """The pictures of a quantity as SVG, with a summary and a sentence about the drift; None if no row has it."""
    from . import _pictures as pictures

    having, values = _values(rows, quantity)
    if not len(values):
        return None
    parts = {row["part"] for row in having}
    is_typical = len(parts) == 1 and quantity.of != ACCELERATION
    limits = _limits(parts.pop()).get(quantity.column, ()) if is_typical else ()
    days = _days(having)
    found = {
        "name": quantity.name,
        "unit": quantity.unit,
        "summary": _summary(values),
        "distribution": pictures.distribution(values, f"{quantity.name}, {quantity.unit}", limits),
        "order": pictures.over_order(having, values, days, quantity.unit),
        "drift": _drift(days, values, quantity.unit),
    }
    if group:
        found["groups"] = pictures.by_group(_grouped(having, values, group), quantity.unit)
    return found


def _summary(values: Numbers) -> str:
    low, middle, high = np.percentile(values, [2.5, 50, 97.5])
    count = "1 value" if len(values) == 1 else f"{len(values)} values"
    return f"{count}; median {middle:.4g}, 95 % between {low:.4g} and {high:.4g}"


def _days(rows: list[dict[str, Any]]) -> Optional[Numbers]:
    """Days since the first capture; None if any capture has no date, such as one of a simulated sensor."""
    try:
        times = [datetime.fromisoformat(row["created"].replace("Z", "+00:00")).timestamp() for row in rows]
    except (AttributeError, ValueError):
        return None
    return (np.array(times) - min(times)) / 86_400.0


def _drift(days: Optional[Numbers], values: Numbers, unit: str) -> str:
    found = _population.trend(days, values) if days is not None else None
    if found is None:
        return ""
    text = f"{found.slope:+.3g} ± {1.96 * found.u_slope:.2g} {unit} a day"
    return f"Drift over time: {text}." if found.is_seen else f"No drift over time is seen ({text})."


def _grouped(rows: list[dict[str, Any]], values: Numbers, group: str) -> dict[str, Numbers]:
    """The values of the `MOST_GROUPS` largest groups, the largest first."""
    names = [str(row[group]) for row in rows]
    common = [name for name, _ in Counter(names).most_common(MOST_GROUPS)]
    return {name: values[[index for index, own in enumerate(names) if own == name]] for name in common}
