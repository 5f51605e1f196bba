"""The compiled part of zerorate. Use the package `zerorate`."""

from __future__ import annotations

import os
from typing import Any, TypedDict, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import NotRequired

__all__ = [
    "Corrector",
    "Refused",
    "analyse",
    "calibrate",
    "correct",
    "deviations",
    "edf",
    "extrapolation",
    "finite_difference_edf",
    "interval",
    "main",
    "parse_calibration",
    "rate_dps",
    "read_capture",
    "save_calibration",
    "statistics",
    "temp_c",
    "twin_device",
    "twin_keys",
]

class Refused(ValueError): ...

@final
class Corrector:
    def __new__(cls, text: str, axes: list[str]) -> Corrector: ...
    def take(
        self, rates_dps: NDArray[np.float64], temps_c: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]: ...
    def warning(self) -> str | None: ...

class _Columns(TypedDict):
    axes: tuple[str, ...]
    rate_scales: NotRequired[tuple[tuple[float, int], ...]]
    temp_scale: NotRequired[tuple[float, int, float]]
    t_ns: NDArray[np.uint64]
    edge_seq: NDArray[np.uint32]
    rate_code: NDArray[np.uint32] | NDArray[np.int64]
    status: NDArray[np.int16] | NDArray[np.int64]
    temp_code: NDArray[np.int32] | NDArray[np.int64]
    lost: NDArray[np.uint32]
    flags: NDArray[np.uint8]
    width_bits: int
    metadata: dict[str, str]
    calibration_id: str | None
    warning: str | None

class _Coefficient(TypedDict):
    value: float
    lo: float
    hi: float
    identified: bool
    needed_s: float | None

class _Fit(TypedDict):
    n: _Coefficient
    b: _Coefficient
    k: _Coefficient
    q: _Coefficient | None
    r: _Coefficient | None
    model_error: float
    p_value: float
    rejected: bool
    terms: list[dict[str, Any]]
    warnings: list[str]

def analyse(
    record: NDArray[np.float64] | NDArray[np.int32],
    phase: bool,
    gaps: list[tuple[int, int]],
    rate_hz: float,
    stat: str,
    taus: str | list[float],
    confidence: float,
    scale: float,
    cleaning: tuple[bool, bool] | None,
) -> dict[str, Any]: ...
def deviations(
    numbers: NDArray[np.float64], phase: bool, rate_hz: float, stat: str, m: list[int]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]: ...
def edf(stat: str, alpha: int, m: int, phase_points: int) -> float: ...
def finite_difference_edf(
    order: int, overlapped: bool, modified: bool, alpha: int, m: int, phase_points: int
) -> float: ...
def statistics() -> list[tuple[str, tuple[int, bool, bool] | None]]: ...
def interval(dev: float, edf: float, confidence: float) -> tuple[float, float]: ...
def main(args: list[str]) -> int: ...
def twin_device(keys: str) -> str: ...
def twin_keys() -> list[tuple[str, str, str, str]]: ...
def calibrate(options: list[str]) -> tuple[str, str]: ...
def save_calibration(path: str | os.PathLike[str], text: str, force: bool) -> None: ...
def parse_calibration(text: str) -> tuple[str, str, list[str]]: ...
def extrapolation(text: str, low_c: float, high_c: float) -> str | None: ...
def correct(
    rate_dps: NDArray[np.float64],
    temp_c: NDArray[np.float64],
    pbc_dps: float,
    btc_dps_per_c: float,
    t3_c: float,
) -> NDArray[np.float64]: ...
def read_capture(path: str | os.PathLike[str]) -> _Columns: ...
def rate_dps(codes: NDArray[np.uint32], width_bits: int) -> NDArray[np.float64]: ...
def temp_c(codes: NDArray[np.int32], width_bits: int) -> NDArray[np.float64]: ...
