"""The digital certificate of a calibration, as far as a record keeps it."""

from __future__ import annotations

import hashlib
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path

from ._errors import LineError

DCC = "{https://ptb.de/dcc}"
CALIBRATION_ID = "Calibration id"
"""The name by which `zerorate certificate` states the calibration."""


@dataclass(frozen=True)
class Certificate:
    """What a certificate states of itself."""

    number: str
    """Its number."""
    calibration_id: str
    """The calibration that it certifies."""
    replaces: str | None
    """The number of the certificate that it replaces."""
    sha256: str
    """Hash of its file."""


def read_certificate(path: Path) -> Certificate:
    """Reads the XML of a certificate of ``zerorate certificate``."""
    data = read_bytes(path)
    try:
        core = ElementTree.fromstring(data).find(f"{DCC}administrativeData/{DCC}coreData")
    except ElementTree.ParseError as error:
        raise LineError(f"{path} is not XML: {error}") from None
    number = None if core is None else core.findtext(f"{DCC}uniqueIdentifier")
    if core is None or not number:
        raise LineError(f"{path} is not a digital calibration certificate (DCC)")
    replaces = core.findtext(f".//{DCC}replacedUniqueIdentifier")
    return Certificate(number, calibration_id(core, path), replaces, hashlib.sha256(data).hexdigest())


def calibration_id(core: ElementTree.Element, path: Path) -> str:
    """The id of the calibration, by its name among the identifications."""
    for one in core.iter(f"{DCC}identification"):
        value = one.findtext(f"{DCC}value")
        if value and one.findtext(f"{DCC}name/{DCC}content") == CALIBRATION_ID:
            return value
    raise LineError(f"{path} states no calibration: take the XML that `zerorate certificate` wrote")


def read_bytes(path: Path) -> bytes:
    """The content of a file."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise LineError(f"cannot read {path}: {error.strerror}") from None
