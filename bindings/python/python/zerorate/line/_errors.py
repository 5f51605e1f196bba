"""What can go wrong with a record."""

from __future__ import annotations


class LineError(Exception):
    """The record, or what is entered into it, is not usable. The text says what is wrong and what to do."""
