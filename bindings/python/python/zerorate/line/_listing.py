"""Listings of the record as plain text."""

from __future__ import annotations

import unicodedata
from collections import Counter
from collections.abc import Sequence

from ._checks import Checked
from ._chain import Verification
from ._reading import Result, Verdict
from ._spc import LABELS, Chart
from ._statistics import moving_ranges
from ._tables import QUANTITIES

WORDS = {"conditionalPass": "conditional pass", "conditionalFail": "conditional fail"}
RULE_TEXTS = {
    1: "one value beyond 3 sigma",
    2: "two of three beyond 2 sigma",
    3: "four of five beyond 1 sigma",
    4: "eight in a row on one side",
}


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns of text, as wide as their widest cell."""
    cells = [list(head), *([printable(cell) for cell in row] for row in rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(head))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in cells)


def printable(text: str) -> str:
    """A text of foreign origin in one line, without what a terminal would obey."""
    return "".join(" " if unicodedata.category(letter)[0] in "CZ" else letter for letter in text)


def number(value: float | None) -> str:
    """A number with six digits, or a dash."""
    return "-" if value is None else f"{value:.6g}"


def word(verdict: str | None, simulated: bool) -> str:
    """A verdict in words."""
    text = "not judged" if verdict is None else WORDS.get(verdict, verdict)
    return f"{text} (simulated)" if simulated else text


def outcome(one: Result) -> str:
    """The verdict of a result, or the state of a run without one."""
    if one.state == "ok":
        return word(one.verdict, one.simulated)
    text = printable(f"{one.state}: {one.fields['code'] or one.fields['error'] or 'no reason given'}")
    return f"{text} (simulated)" if one.simulated else text


def time_of(one: Result) -> str:
    """When a unit was measured; for a simulated one, when it was entered."""
    return str(one.fields["measured"] or one.fields["entered"])[:19].replace("T", " ")


HEAD = ["serial", "part", "axis", "measured (UTC)", "outcome", "PBC, °/s", "BTC, °/s/°C", "T3, °C", "calibration"]


def listing(results: Sequence[Result], marks: bool = False) -> str:
    """A line for each result. With ``marks``, also its id and what superseded it."""
    superseded = {one.supersedes: one.result for one in results if one.supersedes is not None}
    rows = [line(one) + ([mark(one, superseded)] if marks else []) for one in results]
    return table([*HEAD, "result"] if marks else HEAD, rows)


def line(one: Result) -> list[str]:
    """The cells of one result."""
    numbers = [number(one.numbers.get(name)) for name in ("pbc_dps", "btc_dps_per_c", "t3_c")]
    return [one.serial, one.part, one.axis or "-", time_of(one), outcome(one), *numbers, one.calibration_id or "-"]


def mark(one: Result, superseded: dict[int, int | None]) -> str:
    """The id of a result, and whether another one superseded it."""
    if one.result is None:
        return "-"
    if one.current:
        return f"{one.result}, current"
    by = superseded.get(one.result)
    return f"{one.result}, superseded by {by}" if by is not None else f"{one.result}, entered late"


def detail(one: Result) -> str:
    """All of one result."""
    lines = [f"{one.serial}, {one.part}, axis {one.axis or '-'}: {outcome(one)}"]
    for name in QUANTITIES:
        if name in one.numbers:
            u = number(one.numbers.get(f"u_{name}"))
            lines.append(f"  {LABELS[name]:<14} {number(one.numbers[name])}, u = {u}")
    for verdict in one.verdicts:
        lines.append(f"  {judged(verdict)}")
    fields = {**one.fields, "calibration id": one.calibration_id, "certificates": ", ".join(one.certificates)}
    for name, value in fields.items():
        if value and name != "warnings":
            lines.append(f"  {name:<18} {printable(str(value))}")
    return "\n".join([*lines, *(f"  warning: {printable(text)}" for text in one.fields["warnings"])])


def judged(one: Verdict) -> str:
    """A verdict with its limits."""
    limits = f"{number(one.lower)} to {number(one.upper)}, {one.rule}, limits {one.limits_version}"
    return f"{LABELS[one.quantity]:<14} {word(one.verdict, one.simulated)}: {limits}"


def spc(chart: Chart) -> str:
    """A chart as text."""
    known = chart.chart
    simulated = "SIMULATED " if chart.simulated else ""
    lines = [f"{simulated}{LABELS[chart.quantity]} of {chart.part}, axis {chart.axis}: {len(chart.values)} units"]
    lines += [f"  {count} {text}" for count, text in left_out(chart) if count]
    lines += [
        f"  mean                {number(known.mean)}",
        f"  sigma within        {number(known.sigma)} (mean moving range {number(known.mean_range)} / 1.128)",
        f"  control limits      {number(known.lcl)} to {number(known.ucl)}",
        f"  moving range up to  {number(known.range_ucl)}",
        *capability_lines(chart),
        *(signal_line(chart, index) for index in range(len(chart.signals))),
        *(["  no signal by the Western Electric rules"] if not chart.signals else []),
    ]
    return "\n".join([*lines, "", points(chart)])


def left_out(chart: Chart) -> list[tuple[int, str]]:
    """What is not in the chart."""
    simulated = (chart.simulated_left_out, "simulated left out (--simulated takes them)")
    return [simulated, (chart.without_value, "without this quantity left out")]


def capability_lines(chart: Chart) -> list[str]:
    """The indices, if there are limits."""
    if chart.limit is None or chart.capability is None:
        return ["  no limit for this quantity (--limits), so no capability"]
    known, limit = chart.capability, chart.limit
    sure = f"with {known.confidence:.0%} confidence"
    return [
        f"  limits              {number(limit.lower)} to {number(limit.upper)}",
        f"  Cp {number(known.cp)}, Cpk {number(known.cpk)}: at least {number(known.cpk_lower)} {sure} (sigma within)",
        f"  Pp {number(known.pp)}, Ppk {number(known.ppk)}: at least {number(known.ppk_lower)} {sure} (sigma overall)",
    ]


def signal_line(chart: Chart, index: int) -> str:
    """A signal with its rule."""
    signal = chart.signals[index]
    serial = printable(chart.points[signal.index].serial)
    return f"  signal: {serial} (unit {signal.index + 1}), rule {signal.rule}: {RULE_TEXTS[signal.rule]}"


def points(chart: Chart) -> str:
    """A line for each value."""
    changes = [None, *moving_ranges(chart.values)]
    rows = [
        [str(index + 1), one.serial, time_of(one), number(value), number(change), "simulated" if one.simulated else ""]
        for index, (one, value, change) in enumerate(zip(chart.points, chart.values, changes))
    ]
    return table(["unit", "serial", "measured (UTC)", LABELS[chart.quantity], "moving range", ""], rows)


def verification(found: Verification, checked: Sequence[Checked]) -> str:
    """What `verify` found."""
    lines = [f"wrong: {printable(finding.where)} {printable(finding.text)}" for finding in found.findings]
    for one in checked:
        if one.state != "same":
            file = f"{one.named.kind} of {one.named.serial}, {printable(one.named.file)}"
            lines.append(f"{one.state}: {file}: {printable(one.text)}")
    state = "whole" if not found.findings else f"{len(found.findings)} things are wrong"
    lines.append(f"{found.entries} entries, {found.rows} rows: {state}")
    if checked:
        counts = Counter(one.state for one in checked)
        lines.append(f"{len(checked)} files: " + ", ".join(f"{count} {name}" for name, count in counts.items()))
    lines.append(f"head {found.head or '-'}")
    return "\n".join(lines)
