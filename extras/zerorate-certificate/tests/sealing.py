"""Makes the check lines of a calibration file, as docs/formats/calibration.md describes them."""

from __future__ import annotations

import hashlib
import re


def sealed(text: str) -> str:
    """The text of a calibration with new check lines."""
    rows = [line for line in text.splitlines() if not line.startswith(("checksum =", "line_checks ="))]
    lines = [line.rstrip() for line in rows if line.strip()]
    checks = "".join(_sha256(line)[:4] for line in lines)
    checksum = _sha256("\n".join([checks, *lines]))
    top = f'checksum = "sha256:{checksum}"\nline_checks = "{checks}"\n'
    return top + "\n".join(rows) + "\n"


def as_measured(text: str) -> str:
    """Edits a calibration of the twin so that it looks like that of a real part, which a test cannot measure."""
    text = text.replace('created = "SIMULATED"', 'created = "2026-02-27T23:58:30Z"')
    text = re.sub(r'device = "twin:[^"]*"', 'device = "spi:/dev/spidev0.0?rdy=gpiochip0:25"', text)
    return sealed(text)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
