"""Makes DataFrames with pandas or polars, which need not be installed."""

from __future__ import annotations

import importlib
from typing import Any


def frame(columns: dict[str, Any], library: str) -> Any:
    if library not in ("pandas", "polars"):
        raise ValueError(f"library={library!r}: give 'pandas' or 'polars'")
    return needed(library, "to_frame()").DataFrame(columns)


def needed(module: str, what: str) -> Any:
    """Imports an optional module."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise ImportError(f"{what} needs {package}, which is not installed: pip install {package}") from error
