"""Reading TOML with every supported Python."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from ._errors import LineError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def read_toml(path: Path) -> dict[str, Any]:
    """The content of a TOML file; where it cannot be read, an error that names the file and the place."""
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise LineError(f"{path}: {error.strerror or error}") from None
    except ValueError as error:
        raise LineError(f"{path} is not TOML in UTF-8: {error}") from None
