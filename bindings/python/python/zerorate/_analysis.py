"""Analyses records of any form with the same options, for `allan` and `imu`."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union

import numpy as np

from . import _log, _records, _zerorate
from ._capture import Capture
from ._model import cleaned, detrended, fitted
from ._result import Allan, Unavailable
from ._settling import Settling

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._settling import Temperature

Stat = Literal["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]
"""The deviations. Use `oadev` unless you have a reason for another."""

Taus = Union[str, Sequence[float], "NDArray[np.float64]"]
"""Averaging times: ``octave``, ``fine``, ``decade``, ``all``, ``log:N``, or seconds."""

LONG = 50_000
"""Number of samples above which an analysis takes much longer than starting the thread that watches for Ctrl-C."""

_Of = TypeVar("_Of")
_To = TypeVar("_To")


def side_by_side(work: Callable[[_Of], _To], all_of: Sequence[_Of]) -> list[_To]:
    """Runs work that releases the GIL, on at most as many threads as there are processors. After Ctrl-C, no further
    task begins."""
    pool = ThreadPoolExecutor(max_workers=max(1, min(len(all_of), os.cpu_count() or 1)))
    try:
        return [begun.result() for begun in [pool.submit(work, one) for one in all_of]]
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


@dataclass(frozen=True)
class AnalysisOptions:
    stat: str
    taus: Taus
    is_phase: bool
    confidence: float
    asked_fit: tuple[bool, bool, float | None] | None
    settling: Settling | None = None

    @classmethod
    def of(
        cls,
        stat: str,
        taus: Taus,
        data: str,
        confidence: float,
        fit: bool,
        glitches: str,
        steps: str,
        max_freq_hz: float | None,
    ) -> AnalysisOptions:
        asked_fit = (*_cleaning(glitches, steps), _max_freq(max_freq_hz)) if fit else None
        return cls(stat, taus, _is_phase(data), confidence, asked_fit)

    def read(self, source: _records.Source, column: _log.Column | None, given: _zerorate._Options) -> list[Allan]:
        label = given["unit"]
        is_other = label is not None and not isinstance(source, str) and _zerorate.unit_kind(label) is None
        if is_other:
            # for a table in memory, a unit of any other quantity is just a name
            given = {**given, "unit": None, "scale": given["scale"] or 1.0}
        found = _log.columns_of(source, column, self.is_phase, given)
        temperature = None if self.settling is None or self.is_phase else self.settling.of_source(source, given)
        if label is not None:
            scales = [given["scale"] or 1.0 if is_other else one["scale"] for one in found]
            found = [{**one, "unit": label, "scale": scale} for one, scale in zip(found, scales)]
        for text in (text for one in found for text in one["warnings"]):
            warnings.warn(text, stacklevel=4)
        return side_by_side(lambda of: self.of_column(of, temperature), found)

    def of_column(self, column: _zerorate._Column, temperature: Temperature | None = None) -> Allan:
        found = self.analysed(
            column["values"],
            column["rate_hz"],
            column["gaps"],
            column["scale"],
            column["name"],
            column["unit"] or "unit",
            column["warnings"],
            temperature,
        )
        return replace(found, skipped_s=column["skipped_s"])

    def analysed(
        self,
        values: NDArray[Any],
        rate_hz: float | None,
        gaps: list[tuple[int, int]],
        scale: float | None,
        name: str,
        unit: str,
        said: list[str] | None = None,
        temperature: Temperature | None = None,
    ) -> Allan:
        """Analyses a record in the form that the extension takes."""
        if rate_hz is None:
            raise ValueError("the record does not state its sample rate: give rate_hz=, samples per second")
        taus = self.taus
        found = _zerorate.analyse(
            name,
            values,
            self.is_phase,
            gaps,
            float(rate_hz),
            self.stat,
            taus if isinstance(taus, str) else np.asarray(taus, dtype=np.float64).reshape(-1).tolist(),
            float(self.confidence),
            (1.0 if scale is None else float(scale), unit),
            self.asked_fit,
            None if self.settling is None else self.settling.asked(name, temperature),
        )
        model, taken_out, core = (found.pop(key, None) for key in ("fit", "cleaned", "core"))
        polynomial, warned, of_fit = (found.pop(key, None) for key in ("detrended", "warnings", "fit_warnings"))
        unavailable = [Unavailable(*point) for point in found.pop("unavailable")]
        if len(found["dev"]) == 0 and np.count_nonzero(np.isfinite(values)) < 2:
            raise ValueError(f"{name}: fewer than 2 of its samples are numbers ({found['samples']} in all)")
        return Allan(
            **found,
            unavailable=unavailable,
            confidence=self.confidence,
            fit=None if model is None else fitted(model, of_fit, unit),
            cleaned=None if taken_out is None else cleaned(taken_out),
            name=name,
            unit=unit,
            detrended=None if polynomial is None else detrended(polynomial),
            warnings=(said or []) + warned,
            _core=core,
        )

    def checked(self, name: str, values: NDArray[Any], stacklevel: int) -> tuple[NDArray[Any], list[str]]:
        """Checks values that no reader of logs has seen. Returns them, with their sign again if it was lost, and what
        was said of them."""
        signed, said = (None, []) if self.is_phase else _zerorate.check_record(name, values)
        for text in said:
            warnings.warn(text, stacklevel=stacklevel + 1)
        return values if signed is None else signed, said

    def capture(self, capture: Capture, at: int, rate_hz: float | None, scale: float | None, unit: str) -> Allan:
        codes, gaps = capture._codes(at)
        step = capture._dps_per_code(at) if scale is None else scale
        hz = capture.rate_hz if rate_hz is None else rate_hz
        temperature = None if self.settling is None or self.is_phase else self.settling.of_capture(capture, at)
        return self.analysed(codes, hz, gaps, step, capture.axes[at], unit, None, temperature)


def warn_of_frozen(found: Iterable[Allan], stacklevel: int) -> None:
    """Warns of records that never change, whose deviations of zero are no noise of a sensor."""
    for text in (text for axis in found for text in axis.warnings if text.startswith("frozen: ")):
        warnings.warn(text, stacklevel=stacklevel + 1)


def _cleaning(glitches: str, steps: str) -> tuple[bool, bool]:
    if glitches not in ("cut", "keep"):
        raise ValueError(f"glitches={glitches!r}: give 'cut' or 'keep'")
    if steps not in ("remove", "keep"):
        raise ValueError(f"steps={steps!r}: give 'remove' or 'keep'")
    return glitches == "cut", steps == "remove"


def _max_freq(max_freq_hz: float | None) -> float | None:
    if max_freq_hz is not None and not 0 < max_freq_hz < float("inf"):
        raise ValueError(f"max_freq_hz={max_freq_hz!r}: give a frequency above zero, Hz")
    return max_freq_hz


def _is_phase(data: str) -> bool:
    if data not in ("rate", "phase"):
        raise ValueError(f"data={data!r}: give 'rate', or 'phase' for the integral of the rate")
    return data == "phase"
