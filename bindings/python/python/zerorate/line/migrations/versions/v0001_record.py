"""The first tables, and the triggers that keep their rows as they are."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None

TABLES = ("unit", "run", "result", "verdict", "certificate", "entry")


def upgrade() -> None:
    """Makes the tables and their triggers."""
    create_measurements()
    create_statements()
    if op.get_bind().dialect.name == "sqlite":
        keep_in_sqlite()
    else:
        keep_in_postgresql()


def create_measurements() -> None:
    """Units, runs and their results."""
    op.create_table(
        "unit",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("part", sa.String(40), nullable=False),
        sa.Column("serial", sa.String(80), nullable=False),
        sa.UniqueConstraint("part", "serial", name="unit_once"),
    )
    texts = ["code", "error", "method", "program", "device", "station", "operator", "capture", "calibration"]
    op.create_table(
        "run",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("unit", sa.Integer, sa.ForeignKey("unit.id"), nullable=False),
        sa.Column("identity", sa.String(64), nullable=False),
        sa.Column("state", sa.String(8), nullable=False),
        sa.Column("simulated", sa.Boolean(create_constraint=False), nullable=False),
        sa.Column("measured", sa.String(40)),
        sa.Column("entered", sa.String(40), nullable=False),
        sa.Column("warnings", sa.Text, nullable=False),
        *(sa.Column(name, sa.Text) for name in texts),
        sa.Column("capture_sha256", sa.String(64)),
        sa.Column("calibration_sha256", sa.String(64)),
        sa.UniqueConstraint("unit", "identity", name="run_once"),
    )
    quantities = ["pbc_dps", "btc_dps_per_c", "t3_c", "n", "b", "k"]
    numbers = quantities + [f"u_{name}" for name in quantities]
    op.create_table(
        "result",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("run", sa.Integer, sa.ForeignKey("run.id"), nullable=False),
        sa.Column("axis", sa.String(40), nullable=False),
        sa.Column("calibration_id", sa.Text),
        *(sa.Column(name, sa.Double) for name in [*numbers, "cov_pbc_btc_dps2_per_c", "temp_min_c", "temp_max_c"]),
        sa.Column("toml", sa.Text),
        sa.Column("supersedes", sa.Integer, sa.ForeignKey("result.id"), unique=True),
        sa.UniqueConstraint("run", "axis", name="result_once"),
    )


def create_statements() -> None:
    """What is said of results: verdicts, certificates, and the chain of entries."""
    op.create_table(
        "verdict",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("result", sa.Integer, sa.ForeignKey("result.id"), nullable=False),
        sa.Column("quantity", sa.String(40), nullable=False),
        *(sa.Column(name, sa.Double) for name in ["value", "u", "lower", "upper"]),
        sa.Column("rule", sa.String(16), nullable=False),
        sa.Column("verdict", sa.String(16), nullable=False),
        sa.Column("simulated", sa.Boolean(create_constraint=False), nullable=False),
        sa.Column("limits_version", sa.Text, nullable=False),
        sa.UniqueConstraint("result", "quantity", "limits_version", name="verdict_once"),
    )
    op.create_table(
        "certificate",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("number", sa.String(80), nullable=False, unique=True),
        sa.Column("result", sa.Integer, sa.ForeignKey("result.id"), nullable=False),
        sa.Column("dcc_sha256", sa.String(64)),
        sa.Column("pdf_sha256", sa.String(64)),
        sa.Column("issued", sa.String(40), nullable=False),
        sa.Column("issuer", sa.Text, nullable=False),
        sa.Column("replaces", sa.Integer, sa.ForeignKey("certificate.id"), unique=True),
        sa.Column("reason", sa.Text),
    )
    op.create_table(
        "entry",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("at", sa.String(40), nullable=False),
        sa.Column("who", sa.Text, nullable=False),
        sa.Column("what", sa.Text, nullable=False),
        sa.Column("chain", sa.String(64), nullable=False),
    )


def keep_in_sqlite() -> None:
    """Refuses changes. INSERT OR REPLACE removes a row without a DELETE, so a second row of an id is refused too."""
    for table in TABLES:
        refuse = f"BEGIN SELECT RAISE(ABORT, '{table}: append only'); END"
        op.execute(f"CREATE TRIGGER {table}_update BEFORE UPDATE ON {table} {refuse}")
        op.execute(f"CREATE TRIGGER {table}_delete BEFORE DELETE ON {table} {refuse}")
        there = f"WHEN EXISTS (SELECT 1 FROM {table} WHERE id = NEW.id)"
        op.execute(f"CREATE TRIGGER {table}_replace BEFORE INSERT ON {table} {there} {refuse}")


def keep_in_postgresql() -> None:
    """Refuses changes, and emptying a table."""
    op.execute(
        "CREATE FUNCTION line_append_only() RETURNS trigger LANGUAGE plpgsql AS "
        "$$ BEGIN RAISE EXCEPTION '%: append only', TG_TABLE_NAME; END $$"
    )
    for table in TABLES:
        op.execute(
            f"CREATE TRIGGER {table}_kept BEFORE UPDATE OR DELETE OR TRUNCATE ON {table} "
            "FOR EACH STATEMENT EXECUTE FUNCTION line_append_only()"
        )
