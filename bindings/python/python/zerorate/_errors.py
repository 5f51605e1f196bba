"""The exceptions of the package."""

from __future__ import annotations


class ZerorateError(Exception):
    """A device cannot be opened, does not answer, or shows a fault. The text says what to do."""


class Refused(ZerorateError, ValueError):
    """The measurement was refused: its numbers are not a valid result. The text says why and what to do."""
