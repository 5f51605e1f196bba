"""The record of a production line: units, measurements, verdicts and certificates that are never changed.

``zerorate line`` is its command line; ``pip install 'zerorate[line]'`` installs what it needs.

>>> from zerorate.line import Limits, open_record
>>> record = open_record("sqlite:///line.db")
>>> record.add_calibration("unit.toml", capture="unit.arrows", limits=Limits.load("limits.toml"))  # doctest: +SKIP
"""

from __future__ import annotations

from ._chain import Finding, Verification
from ._checks import Checked, Named
from ._entering import Added
from ._errors import LineError
from ._limits import Limit, Limits
from ._measurement import AxisResult, Measurement
from ._reading import Result, Verdict
from ._record import Imported, Record, open_record
from ._statistics import Capability, Individuals, Signal, capability, individuals, western_electric

__all__ = [
    "Added",
    "AxisResult",
    "Capability",
    "Checked",
    "Finding",
    "Imported",
    "Individuals",
    "Limit",
    "Limits",
    "LineError",
    "Measurement",
    "Named",
    "Record",
    "Result",
    "Signal",
    "Verdict",
    "Verification",
    "capability",
    "individuals",
    "open_record",
    "western_electric",
]
