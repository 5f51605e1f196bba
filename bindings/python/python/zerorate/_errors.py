"""The exceptions of the package."""

from __future__ import annotations


class ZerorateError(Exception):
    """A device cannot be opened, does not answer, or shows a fault. The text says what to do."""


class Refused(ZerorateError, ValueError):
    """The measurement was refused: there are numbers, but they must not become a result. The text says why and what
    to do."""
