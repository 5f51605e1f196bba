"""The pictures of the report's page: the correction of each axis over temperature."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from zerorate import Calibration

_SVG = re.compile(r"<svg\b.*?</svg>", re.DOTALL)


def pictures_of(calibration: Calibration) -> list[str]:
    """One SVG for each axis, as ``zerorate report`` draws it."""
    with tempfile.TemporaryDirectory() as folder:
        # the text that was checked, not the file, which may have changed since
        source, page = Path(folder, "unit.toml"), Path(folder, "page.html")
        source.write_text(calibration.text, encoding="utf-8")
        command = [sys.executable, "-m", "zerorate", "report", str(source), "-o", str(page)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise ValueError(f"`zerorate report` failed: {done.stderr.strip() or done.returncode}")
        pictures = _SVG.findall(page.read_text(encoding="utf-8"))
    if len(pictures) != len(calibration.axes):
        raise ValueError(f"`zerorate report` drew {len(pictures)} pictures for {len(calibration.axes)} axes")
    return pictures
