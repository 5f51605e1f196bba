"""The tables of the record, as the newest migration leaves them. No row is ever changed or removed.

Times are texts, RFC 3339 in UTC: both databases give them back as they were written, so that a digest holds for ever.
Units are in the names; ``n`` is in °/√s, ``b`` in °/s, ``k`` in °/s/√s; ``u_…`` is a standard uncertainty.
"""

from __future__ import annotations

from sqlalchemy import Boolean, Column, Double, ForeignKey, Integer, MetaData, String, Table, Text, UniqueConstraint

METADATA = MetaData()

COEFFICIENTS = ("pbc_dps", "btc_dps_per_c", "t3_c")
NOISE = ("n", "b", "k")
QUANTITIES = COEFFICIENTS + NOISE
"""The quantities of a result. Each has a limit, a chart and a standard uncertainty of its own."""

NUMBERS = tuple(name for quantity in QUANTITIES for name in (quantity, f"u_{quantity}"))
NUMBERS += ("cov_pbc_btc_dps2_per_c", "temp_min_c", "temp_max_c")
"""The columns of a result that are numbers."""

UNIT = Table(
    "unit",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("part", String(40), nullable=False),
    Column("serial", String(80), nullable=False),
    UniqueConstraint("part", "serial", name="unit_once"),
)

RUN = Table(
    "run",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("unit", ForeignKey("unit.id"), nullable=False),
    Column("identity", String(64), nullable=False),
    Column("state", String(8), nullable=False),
    Column("simulated", Boolean(create_constraint=False), nullable=False),
    Column("code", Text),
    Column("error", Text),
    Column("measured", String(40)),
    Column("entered", String(40), nullable=False),
    Column("method", Text),
    Column("program", Text),
    Column("device", Text),
    Column("station", Text),
    Column("operator", Text),
    Column("warnings", Text, nullable=False),
    Column("capture", Text),
    Column("capture_sha256", String(64)),
    Column("calibration", Text),
    Column("calibration_sha256", String(64)),
    UniqueConstraint("unit", "identity", name="run_once"),
)

RESULT = Table(
    "result",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("run", ForeignKey("run.id"), nullable=False),
    Column("axis", String(40), nullable=False),
    Column("calibration_id", Text),
    *(Column(name, Double) for name in NUMBERS),
    Column("toml", Text),
    Column("supersedes", ForeignKey("result.id"), unique=True),
    UniqueConstraint("run", "axis", name="result_once"),
)

VERDICT = Table(
    "verdict",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("result", ForeignKey("result.id"), nullable=False),
    Column("quantity", String(40), nullable=False),
    Column("value", Double),
    Column("u", Double),
    Column("lower", Double),
    Column("upper", Double),
    Column("rule", String(16), nullable=False),
    Column("verdict", String(16), nullable=False),
    Column("simulated", Boolean(create_constraint=False), nullable=False),
    Column("limits_version", Text, nullable=False),
    UniqueConstraint("result", "quantity", "limits_version", name="verdict_once"),
)

CERTIFICATE = Table(
    "certificate",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("number", String(80), nullable=False, unique=True),
    Column("result", ForeignKey("result.id"), nullable=False),
    Column("dcc_sha256", String(64)),
    Column("pdf_sha256", String(64)),
    Column("issued", String(40), nullable=False),
    Column("issuer", Text, nullable=False),
    Column("replaces", ForeignKey("certificate.id"), unique=True),
    Column("reason", Text),
)

ENTRY = Table(
    "entry",
    METADATA,
    Column("id", Integer, primary_key=True),
    Column("at", String(40), nullable=False),
    Column("who", Text, nullable=False),
    Column("what", Text, nullable=False),
    Column("chain", String(64), nullable=False),
)

ENTERED = (UNIT, RUN, RESULT, VERDICT, CERTIFICATE)
"""The tables whose rows an entry names with their digests."""
