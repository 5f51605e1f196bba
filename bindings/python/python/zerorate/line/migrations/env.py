"""Runs the migrations on the connection that the program hands over. Alembic loads this file."""

from __future__ import annotations

from alembic import context

from zerorate.line._store import VERSION_TABLE

context.configure(connection=context.config.attributes["connection"], version_table=VERSION_TABLE)
with context.begin_transaction():
    context.run_migrations()
