"""The compiled part of zerorate. Use the package `zerorate`."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import Any, Literal, TypedDict, Union, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import NotRequired

__all__ = [
    "Calibration",
    "Corrector",
    "Model",
    "Stream",
    "analyse",
    "calibrate",
    "capture",
    "check_record",
    "column_unit",
    "correct",
    "deviations",
    "imu_file",
    "is_time",
    "main",
    "motion",
    "rate_dps",
    "read_capture",
    "read_columns",
    "read_imu",
    "read_temperature",
    "save_text",
    "statistics",
    "temp_c",
    "tempcal",
    "temperatures",
    "twin_device",
    "twin_keys",
    "unit_kind",
]

@final
class Calibration:
    def __new__(cls, text: str) -> Calibration: ...
    @property
    def text(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def id(self) -> str: ...
    @property
    def fields(self) -> dict[str, Any]: ...
    def extrapolation(self, low_c: float, high_c: float) -> str | None: ...
    def pictures(self) -> list[str]: ...

@final
class Corrector:
    def __new__(cls, calibration: Calibration, axes: list[str]) -> Corrector: ...
    def take(
        self, rates_dps: NDArray[np.float64], temps_c: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]: ...
    def warning(self) -> str | None: ...

@final
class Model:
    def __copy__(self) -> Model: ...
    def __deepcopy__(self, _memo: Any) -> Model: ...
    def __reduce__(self) -> tuple[type[None], tuple[()]]: ...

@final
class Stream:
    def __new__(
        cls,
        device: _Device,
        calibration: Calibration,
        serial: str | None,
        rate_hz: float | None,
        duration: float | str | None,
    ) -> Stream: ...
    @property
    def axes(self) -> list[str]: ...
    def next(self) -> tuple[float, list[float], float, int, str] | None: ...
    def close(self) -> None: ...

class _Device(TypedDict):
    device: str
    part: str | None
    every_temp: int | None
    divider: int | None
    realtime: bool

_Cells = Union[NDArray[np.int32], NDArray[np.float64], NDArray[np.int64], int]
_Source = Union[str, tuple[str, list[tuple[str, _Cells]]]]

class _Options(TypedDict):
    topic: str | None
    where: str | None
    rate_hz: float | None
    time_column: str | None
    time_unit: str | None
    unit: str | None
    scale: float | None
    increments: bool | None
    force_unit: bool
    decimal: str | None
    raw: str | None
    max_bad: float | None
    skip: str | None
    until: str | None

class _Column(TypedDict):
    name: str
    values: NDArray[np.float64] | NDArray[np.int32]
    gaps: list[tuple[int, int]]
    rate_hz: float
    skipped_s: float
    unit: str | None
    scale: float
    warnings: list[str]

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

_Fit = dict[str, Any]
"""The ``fit`` of ``zerorate allan --json``."""

class _Settling(TypedDict):
    temps_c: NDArray[np.float64] | None
    detrend: int | None
    skip: str

class _Tempcal(TypedDict):
    axes: list[dict[str, Any]]
    warnings: list[str]
    calibration: tuple[Calibration | None, str | None]
    px4: tuple[str | None, str | None]
    ardupilot: tuple[str | None, str | None]

def analyse(
    name: str,
    record: NDArray[np.float64] | NDArray[np.int32],
    phase: bool,
    gaps: list[tuple[int, int]],
    rate_hz: float,
    stat: str,
    taus: str | list[float],
    confidence: float,
    scaled: tuple[float, str],
    asked: tuple[bool, bool, float | None] | None,
    settling: _Settling | None,
) -> dict[str, Any]: ...
def check_record(
    name: str, record: NDArray[np.float64] | NDArray[np.int32]
) -> tuple[NDArray[np.float64] | NDArray[np.int32] | None, list[str]]: ...
def deviations(
    numbers: NDArray[np.float64], phase: bool, rate_hz: float, stat: str, m: list[int]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]: ...
def read_columns(
    source: _Source, names: list[str] | None, every: bool, points: bool, options: _Options
) -> list[_Column]: ...
def read_temperature(
    source: _Source, name: str | None, options: _Options
) -> tuple[str, NDArray[np.float64]] | None: ...
def temperatures() -> list[str]: ...
def read_imu(
    source: _Source,
    names: list[str] | None,
    gyro: tuple[list[str], str | None, float | None],
    accel: tuple[list[str], str | None, float | None],
    codes: tuple[str | None, float | None, float | None],
    options: _Options,
) -> tuple[list[_Column], str | None, list[str]]: ...
def tempcal(
    sources: list[_Source],
    names: list[str] | None,
    gyro: tuple[list[str], str | None, float | None],
    accel: tuple[list[str], str | None, float | None],
    codes: tuple[str | None, float | None, float | None],
    temp_column: str | None,
    reference_c: float | None,
    max_u_dps: float | None,
    serial: str | None,
    options: _Options,
) -> _Tempcal: ...
def imu_file(
    format: str,
    axes: list[tuple[str, str, Model]],
    log: str,
    topic: str | None,
    combine: str,
    horizon_s: float | None,
    as_fitted: bool,
    inflate: float,
    accept_rejected: bool,
    warnings: list[str],
) -> tuple[str, list[str]]: ...
def motion(axes: list[tuple[str, Model]], skipped_s: float) -> list[str]: ...
def unit_kind(unit: str) -> Literal["gyroscope", "accelerometer"] | None: ...
def column_unit(name: str) -> str | None: ...
def is_time(name: str) -> bool: ...
def statistics() -> list[tuple[str, str]]: ...
def main(args: list[str]) -> int: ...
def twin_device(keys: str) -> str: ...
def twin_keys() -> list[tuple[str, str, str, str]]: ...
def calibrate(
    device: _Device, options: Mapping[str, object], progress: Callable[[str, float, float], Any] | None
) -> tuple[dict[str, Any], Calibration]: ...
def capture(
    device: _Device, options: Mapping[str, object], progress: Callable[[str, float, float], Any] | None
) -> dict[str, Any]: ...
def save_text(path: str | os.PathLike[str], text: str, force: bool) -> None: ...
def correct(
    rate_dps: NDArray[np.float64],
    temp_c: NDArray[np.float64],
    coefficients: tuple[float, float, float, float, float],
) -> NDArray[np.float64]: ...
def read_capture(path: str | os.PathLike[str]) -> _Columns: ...
def rate_dps(codes: NDArray[np.uint32], width_bits: int) -> NDArray[np.float64]: ...
def temp_c(codes: NDArray[np.int32], width_bits: int) -> NDArray[np.float64]: ...
