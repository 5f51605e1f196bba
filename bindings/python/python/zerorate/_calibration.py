"""A calibration of one sensor. The file is specified in docs/formats/calibration.md of the project."""

from __future__ import annotations

import os
import warnings
from dataclasses import astuple, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from . import _html, _zerorate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Correction:
    """The coefficients of a correction over temperature.

    corrected rate = RATE + PBC + d · (BTC + d · (BTC2 + d · BTC3)) with d = TEMP − T3.
    """

    pbc_dps: float
    """PBC, °/s: the negative of the bias at T3."""
    btc_dps_per_c: float
    """BTC, °/s/°C: the change of the correction with the temperature at T3."""
    t3_c: float
    """T3, °C: the temperature at which the correction is PBC."""
    btc2_dps_per_c2: float = 0.0
    """Quadratic term BTC2, °/s/°C²; 0 for a line."""
    btc3_dps_per_c3: float = 0.0
    """Cubic term BTC3, °/s/°C³; 0 for a line."""

    def _told(self) -> str:
        curve = ", a curve" if self.btc2_dps_per_c2 or self.btc3_dps_per_c3 else ""
        return f"PBC {self.pbc_dps:+.5g} °/s, BTC {self.btc_dps_per_c:+.4g} °/s/°C at {self.t3_c:.2f} °C{curve}"


@dataclass(frozen=True)
class Measured:
    """The means of steps 4 and 6 of AN-1042."""

    b1_dps: float
    """Mean rate of step 4, °/s."""
    t1_c: float
    """Mean temperature of step 4, °C."""
    b2_dps: float
    """Mean rate of step 6, °/s."""
    t2_c: float
    """Mean temperature of step 6, °C."""


@dataclass(frozen=True)
class Uncertainties:
    """Standard uncertainties and covariances.

    value ± ``coverage_factor`` × u covers the truth with the probability ``coverage``.
    """

    coverage: float
    """Probability with which the stated intervals contain the true value."""
    coverage_factor: float
    """Half width of the stated intervals in standard uncertainties."""
    u_pbc_dps: float
    """Standard uncertainty of PBC, °/s."""
    u_btc_dps_per_c: float
    """Standard uncertainty of BTC, °/s/°C."""
    u_t3_c: float
    """Standard uncertainty of T3, °C."""
    cov_pbc_btc_dps2_per_c: float
    """Covariance of PBC and BTC, (°/s)²/°C."""
    cov_pbc_t3_dps_c: float
    """Covariance of PBC and T3, °/s·°C."""
    cov_btc_t3_dps: float
    """Covariance of BTC and T3, °/s."""
    u_curvature_dps_per_c: float
    """The part of the uncertainty of BTC that allows for curvature and hysteresis, °/s/°C."""
    u_b1_dps: float
    """Standard uncertainty of B1, °/s."""
    u_t1_c: float
    """Standard uncertainty of T1, °C."""
    u_b2_dps: float
    """Standard uncertainty of B2, °/s."""
    u_t2_c: float
    """Standard uncertainty of T2, °C."""
    drift_dps: float | None = None
    """A part of `u_pbc_dps` with a known sign, °/s: PBC is this much above its value at T3, because it belongs to the
    mean temperature of step 8."""


@dataclass(frozen=True)
class CurveRecord:
    """The uncertainty of a curve over temperature, and its basis."""

    coverage: float
    """Probability with which the stated intervals contain the true value."""
    coverage_factor: float
    """Half width of the stated intervals in standard uncertainties."""
    order: int
    """Order of the polynomial."""
    order_weights: list[float]
    """Posterior probability of the orders 0 to 3."""
    covariance: list[list[float]]
    """Covariance of PBC, BTC, BTC2 and BTC3, each in its own unit: °/s, °/s/°C, °/s/°C², °/s/°C³."""
    lag_s: float
    """Time by which the bias lags behind the temperature sensor, s."""
    play_c: float
    """Half width of the backlash between temperature and bias, °C."""
    steps: list[list[float]]
    """Steps of the rate that were removed before the fit: time, s, and size, °/s."""
    sources: dict[str, float] | None = None
    """Parts of the uncertainties of PBC and BTC that are not noise, as ``curve.sources`` of the file."""


@dataclass(frozen=True)
class NoiseRecord:
    """The noise behind the uncertainties. A source is ``measured`` or ``typical (M-04)``."""

    white_dps_per_rt_hz: float
    """One-sided density of the white noise, °/s/√Hz."""
    white_source: str
    """Source of `white_dps_per_rt_hz`."""
    flicker_floor_dps: float
    """Floor of the Allan deviation, °/s: 0.664 times the bias instability."""
    flicker_cutoff_hz: float
    """Frequency below which the spectrum of the flicker noise is flat, Hz."""
    flicker_source: str
    """Source of `flicker_floor_dps` and `flicker_cutoff_hz`."""
    rate_random_walk_dps_per_rt_s: float
    """Rate random walk, °/s/√s."""
    rate_random_walk_source: str
    """Source of `rate_random_walk_dps_per_rt_s`."""


@dataclass(frozen=True)
class Validity:
    """The range of temperatures in which the calibration was measured. Outside, the correction is extrapolated."""

    temp_min_c: float
    """Lowest temperature, °C."""
    temp_max_c: float
    """Highest temperature, °C."""
    margin_c: float = 0.5
    """Distance by which a temperature may leave the range without a warning, °C."""


@dataclass(frozen=True)
class Scale:
    """Converts codes to values: value = (code − ``zero_code``) / ``lsb_per_unit`` + ``zero_value``."""

    lsb_per_unit: float
    """Codes per °/s, or per °C."""
    zero_code: int
    """The code of ``zero_value``."""
    zero_value: float
    """The value at ``zero_code``, °/s or °C."""
    width_bits: int
    """Number of bits of a code."""
    signed: bool
    """True if codes are two's complement; otherwise they begin at 0."""


@dataclass(frozen=True)
class CalibratedAxis:
    """The results of one axis. Only name and correction are always present."""

    name: str
    """The name of the axis; an ADIS16130 has only ``rate``."""
    correction: Correction
    """PBC, BTC and T3, and the further terms of a curve."""
    warnings: list[str] = field(default_factory=list)
    """Warnings that concern this axis alone."""
    rate: Scale | None = None
    """The scale of the axis's rate codes."""
    measured: Measured | None = None
    """The means from which AN-1042 computes the correction; None unless the file has them."""
    uncertainty: Uncertainties | None = None
    """The uncertainties of the result of AN-1042; None unless the file has them."""
    curve: CurveRecord | None = None
    """The uncertainty of the result of any other method than AN-1042; None unless the file has it."""
    noise: NoiseRecord | None = None
    """The noise behind the uncertainty; None unless the file has it."""

    def __repr__(self) -> str:
        return f"<CalibratedAxis {self.name}: {self.correction._told()}>"


@dataclass(frozen=True)
class Run:
    """Facts about the measurement: durations, rates, losses, limits and assumptions."""

    duration_s: float
    """Time from the first sample to the last, s."""
    rate_hz: float
    """Rate samples read per second, without lost ones."""
    rdy_hz: float
    """Data-ready edges per second."""
    samples: int
    """Number of rate samples read."""
    lost_samples: int
    """Number of rate samples lost."""
    average_s: float
    """Length of steps 4 and 6 of AN-1042, s."""
    warmup_s: float
    """Length of step 5, the warm-up, s."""
    settle_s: float
    """Length of step 7, the settling, s."""
    offset_s: float
    """Length of step 8, the average that gives PBC, s."""
    max_lost: float
    """Largest share of lost samples that was accepted."""
    max_u_btc_dps_per_c: float
    """Largest uncertainty of BTC that was accepted, °/s/°C."""
    assume_linear: bool
    """True if the bias was assumed to be a straight line over temperature."""
    earth_dps: float | None = None
    """Component of the Earth's rotation that was subtracted, °/s; None if none was, so that PBC contains it."""


@dataclass(frozen=True)
class Calibration:
    """A calibration, as its file holds it. Only ``schema``, ``part``, ``axes`` and ``id`` are always present.

    With one axis, ``correction``, ``measured``, ``uncertainty``, ``noise`` and ``curve`` belong to this axis. With
    several axes, take one of them as ``calibration["x"]``.
    """

    schema: int
    """Version of the file format."""
    part: str
    """The type of the sensor, such as ``ADIS16130``."""
    axes: list[CalibratedAxis]
    """The results of each axis."""
    id: str
    """Short identifier of the calibration: 12 hexadecimal digits."""
    serial: str | None = None
    """Serial number of the sensor."""
    created: str | None = None
    """Time at which the samples were recorded, RFC 3339; ``SIMULATED`` for the software twin."""
    method: str | None = None
    """The method, such as ``an1042``."""
    software: str | None = None
    """The program that made the calibration, with its version."""
    device: str | None = None
    """The device from which the samples came."""
    config: str | None = None
    """Registers of the sensor, and the way in which it was read."""
    capture_sha256: str | None = None
    """SHA-256 of the samples."""
    supply_note: str | None = None
    """The user's note about the supply."""
    ambient_note: str | None = None
    """The user's note about the surroundings."""
    operator: str | None = None
    """Name of the person who measured."""
    host: str | None = None
    """Name of the computer; None for the software twin, and if the file does not state it."""
    warnings: list[str] = field(default_factory=list)
    """Warnings of the measurement; with several axes, only warnings about all of them."""
    temp: Scale | None = None
    """The scale of the temperature's codes."""
    validity: Validity | None = None
    """The range of temperatures in which the calibration holds."""
    run: Run | None = None
    """Facts about the measurement."""
    text: str = field(default="", repr=False)
    """The text of the file."""

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Calibration:
        """Reads a calibration file.

        A file without its check lines (written by hand) is read with a UserWarning.

        Raises
        ------
        ValueError
            If the file is not a calibration, was edited, or ends early; the text names the line.
        OSError
            If the file cannot be read.
        """
        try:
            return cls.parse(Path(path).read_text(encoding="utf-8"))
        except UnicodeDecodeError:
            advice = "give the TOML file that `save` or calibrate(output=…) writes"
            raise ValueError(f"{os.fspath(path)} is not a calibration file: {advice}") from None
        except ValueError as error:
            raise ValueError(f"{os.fspath(path)}: {error}") from None

    @classmethod
    def parse(cls, text: str) -> Calibration:
        """Reads a calibration from the text of its file, like `load`."""
        core = _zerorate.Calibration(text)
        for note in core.notes:
            warnings.warn(note, stacklevel=3)
        return cls._of(core)

    @classmethod
    def _of(cls, core: _zerorate.Calibration) -> Calibration:
        fields = core.fields
        axes = [CalibratedAxis(**_tables(axis)) for axis in fields.pop("axes")]
        calibration = cls(**_tables(fields), axes=axes, id=core.id, text=core.text)
        calibration.__dict__["_core"] = core
        return calibration

    def __repr__(self) -> str:
        serial = f" {self.serial}" if self.serial else ""
        axes = "; ".join(f"{axis.name}: {axis.correction._told()}" for axis in self.axes)
        axes = axes if len(self.axes) > 1 else self.axes[0].correction._told()
        return f"<Calibration {self.id} of {self.part}{serial}: {axes}>"

    def _repr_html_(self) -> str:
        return _html.with_pictures(self, self.pictures())

    @cached_property
    def _core(self) -> _zerorate.Calibration:
        return _zerorate.Calibration(self.text)

    def __getstate__(self) -> dict[str, Any]:
        """The state without the compiled calibration, which is made again from the text."""
        return {name: value for name, value in self.__dict__.items() if name != "_core"}

    def __getitem__(self, name: str) -> CalibratedAxis:
        """The axis with this name.

        Raises
        ------
        KeyError
            If there is no such axis.
        """
        for axis in self.axes:
            if axis.name == name:
                return axis
        raise KeyError(f"no axis {name!r}; it is of {self._names()}")

    @property
    def correction(self) -> Correction:
        """PBC, BTC and T3 of the only axis, and the further terms of a curve."""
        return self._only("correction").correction

    @property
    def measured(self) -> Measured | None:
        """The means from which the correction of the only axis was computed, or None, as in `CalibratedAxis`."""
        return self._only("measured").measured

    @property
    def uncertainty(self) -> Uncertainties | None:
        """The uncertainties of the only axis after AN-1042, or None, as in `CalibratedAxis`."""
        return self._only("uncertainty").uncertainty

    @property
    def noise(self) -> NoiseRecord | None:
        """The noise behind the uncertainty of the only axis, or None, as in `CalibratedAxis`."""
        return self._only("noise").noise

    @property
    def curve(self) -> CurveRecord | None:
        """The uncertainty of the curve of the only axis, or None, as in `CalibratedAxis`."""
        return self._only("curve").curve

    def _only(self, what: str) -> CalibratedAxis:
        if len(self.axes) == 1:
            return self.axes[0]
        example = f"calibration[{self.axes[0].name!r}].{what}"
        raise ValueError(f"the calibration has several axes, {self._names()}: take one of them, as in {example}")

    def _names(self) -> str:
        return ", ".join(axis.name for axis in self.axes)

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Writes the calibration file, with its check lines if it was read with them.

        Parameters
        ----------
        path
            The file. It appears under this name only when it is complete on the disk.
        force
            Overwrite an existing file, but never a capture.

        Raises
        ------
        FileExistsError
            If a file exists that must not be overwritten.
        OSError
            If the file cannot be written.
        """
        _zerorate.save_text(path, self.text, force)

    def pictures(self) -> list[str]:
        """Plots of the correction over temperature as SVG, one for each axis, as in ``zerorate report``."""
        return self._core.pictures()

    @overload
    def correct(self, rate_dps: float, temp_c: float) -> float: ...

    @overload
    def correct(self, rate_dps: ArrayLike, temp_c: ArrayLike) -> NDArray[np.float64]: ...

    def correct(self, rate_dps: ArrayLike, temp_c: ArrayLike) -> float | NDArray[np.float64]:
        """Removes the bias from a rate: RATE + PBC + (TEMP − T3) · BTC, plus the terms of a curve if there are any.

        Parameters
        ----------
        rate_dps
            Uncorrected rate, °/s: a number or an array of any shape. With several axes, the last dimension of the
            array is the axes, in the order of ``axes``.
        temp_c
            Temperature of the part, °C, read with the rate: a number, or an array that broadcasts to the shape of the
            rate. With several axes, to that of its other dimensions, or of these and a last one of length 1. If the
            rate is a number, or one of each axis, the temperatures may be several.

        Returns
        -------
        float or array
            The corrected rate, °/s, in the shape of the rate, or of several temperatures; NaN where an input is NaN.

        Warns
        -----
        UserWarning
            If temperatures leave the span of the calibration, so that the correction is extrapolated.

        Raises
        ------
        ValueError
            If a rate would have several temperatures, or the last dimension is not the axes.
        """
        rates = np.asarray(rate_dps, dtype=np.float64)
        temps = np.asarray(temp_c, dtype=np.float64)
        if len(self.axes) == 1:
            _check_shapes(rates.shape, rates, temps)
            corrected = _correct(self.axes[0].correction, rates, temps)
            self._warn_outside(temps)
            return corrected if corrected.shape else float(corrected)
        if rates.ndim == 0 or rates.shape[-1] != len(self.axes):
            raise ValueError(
                f"rates of shape {rates.shape}: the last dimension must be the {len(self.axes)} axes {self._names()}"
            )
        samples = rates.shape[:-1]
        if samples and temps.shape == (*samples, 1):
            temps = temps[..., 0]
        _check_shapes(samples, rates, temps)
        columns = [_correct(axis.correction, rates[..., k], temps) for k, axis in enumerate(self.axes)]
        self._warn_outside(temps)
        return np.stack(columns, axis=-1)

    def _warn_outside(self, temps: NDArray[np.float64]) -> None:
        seen = temps[np.isfinite(temps)]
        if seen.size:
            outside = self._core.extrapolation(float(seen.min()), float(seen.max()))
            if outside is not None:
                warnings.warn(outside, stacklevel=3)


def _check_shapes(samples: tuple[int, ...], rates: NDArray[np.float64], temps: NDArray[np.float64]) -> None:
    """Checks that samples of this shape have one temperature each, or that there is one sample."""
    try:
        together = np.broadcast_shapes(samples, temps.shape)
    except ValueError:
        together = None
    if together != samples and (samples or temps.ndim > 1):
        raise ValueError(
            f"rate_dps of shape {rates.shape} and temp_c of shape {temps.shape}: each rate needs one temperature; "
            f"give a number or an array of shape {samples}"
        )


@dataclass(frozen=True)
class Corrected:
    """The result of `Corrector.take`."""

    rate_dps: NDArray[np.float64]
    """The corrected rates, °/s; NaN for an invalid rate, and before the first temperature."""
    temp_c: NDArray[np.float64]
    """The temperature for the correction at each time, °C: the last one that was read; NaN before the first."""
    extrapolated: NDArray[np.bool_]
    """True where `temp_c` lies outside the span in which the calibration holds."""


class Corrector:
    """Corrects a stream of rates, block by block. A rate without a temperature uses the last temperature read.

    ``zerorate stream`` and ``zerorate correct`` use the same corrector.

    Parameters
    ----------
    calibration
        The calibration to apply.
    axes
        The axes to correct, by name, in the order of the rates; all if not given.

    Raises
    ------
    ValueError
        If the calibration has no such axis.
    """

    def __init__(self, calibration: Calibration, axes: Sequence[str] | None = None) -> None:
        names = [axis.name for axis in calibration.axes] if axes is None else list(axes)
        self._inner = _zerorate.Corrector(calibration._core, names)
        self._names = names

    def take(self, rate_dps: ArrayLike, temp_c: ArrayLike) -> Corrected:
        """Corrects the next rates.

        Parameters
        ----------
        rate_dps
            Rates, °/s: one for each time, or for several axes an array of times by axes. NaN marks an invalid rate.
        temp_c
            The temperature read at each time, °C; NaN where none was read.

        Raises
        ------
        ValueError
            If the shapes of rates, temperatures and axes do not fit together.
        """
        rates = np.ascontiguousarray(rate_dps, dtype=np.float64)
        temps = np.ascontiguousarray(temp_c, dtype=np.float64)
        by_axis = rates[:, np.newaxis] if rates.ndim == 1 and len(self._names) == 1 else rates
        if by_axis.shape != (temps.size, len(self._names)) or temps.ndim != 1:
            raise ValueError(
                f"rates of shape {rates.shape} and temperatures of shape {temps.shape}: give a row of "
                f"{len(self._names)} rates and a temperature for each time"
            )
        corrected, used, outside = self._inner.take(by_axis.reshape(-1), temps)
        return Corrected(corrected.reshape(rates.shape), used, outside)

    @property
    def warning(self) -> str | None:
        """The warning if a temperature left the span of the calibration; None if none did."""
        return self._inner.warning()


def _correct(
    known: Correction, rates: NDArray[np.float64], temps: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Broadcasts rates and temperatures, and corrects the rates."""
    rates, temps = np.broadcast_arrays(rates, temps)
    corrected = _zerorate.correct(
        np.ascontiguousarray(rates).reshape(-1),
        np.ascontiguousarray(temps).reshape(-1),
        astuple(known),
    )
    return corrected.reshape(rates.shape)


def _tables(fields: dict[str, Any]) -> dict[str, Any]:
    """Replaces each table among the fields by its data class."""
    known = {name: kind(**fields[name]) for name, kind in _TABLES.items() if fields.get(name) is not None}
    return {**fields, **known}


_TABLES: dict[str, Any] = {
    "temp": Scale,
    "rate": Scale,
    "correction": Correction,
    "measured": Measured,
    "uncertainty": Uncertainties,
    "curve": CurveRecord,
    "noise": NoiseRecord,
    "validity": Validity,
    "run": Run,
}
