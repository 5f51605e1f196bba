"""`calibrate`: calibrates a sensor by AN-1042 or another method."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Literal

from . import _device, _html, _zerorate
from ._calibration import Calibration
from ._keywords import checked
from ._settling import Seconds

@dataclass(frozen=True)
class Truth:
    """The result of a perfect measurement at the reported T3; known only for a twin."""

    pbc_dps: float
    """Bias correction at T3, °/s."""
    btc_dps_per_c: float
    """Temperature coefficient of the correction at T3, °/s/°C."""
    curve: list[CurvePoint] = field(default_factory=list)
    """The true correction at the temperatures of `Calibrated.curve`."""


@dataclass(frozen=True)
class CurvePoint:
    """The correction at a temperature, at the end of the recording."""

    temp_c: float
    """Temperature, °C."""
    correction_dps: float
    """The correction that is added to the rate, °/s: minus the bias."""
    u_dps: float | None = None
    """Standard uncertainty of the correction, °/s; None if unknown."""


@dataclass(frozen=True)
class Calibrated:
    """The result of `calibrate`: the keys of ``zerorate calibrate --json``, and the calibration itself.

    corrected rate = RATE + PBC + d · (BTC + d · (BTC2 + d · BTC3)) with d = TEMP − T3. A value ± ``coverage_factor`` ×
    its ``u_…`` covers the truth with the probability ``coverage``.
    """

    b1_dps: float | None
    """Mean rate of step 4, °/s; None for methods other than ``an1042``."""
    t1_c: float | None
    """Mean temperature of step 4, °C; None for methods other than ``an1042``."""
    b2_dps: float | None
    """Mean rate of step 6, °/s; None for methods other than ``an1042``."""
    t2_c: float | None
    """Mean temperature of step 6, °C; None for methods other than ``an1042``."""
    btc_dps_per_c: float
    """Temperature coefficient of the correction, °/s/°C."""
    pbc_dps: float
    """Bias correction at T3, °/s: the negative of the bias."""
    t3_c: float
    """Temperature of the bias correction, °C."""
    u_pbc_dps: float
    """Standard uncertainty of PBC, °/s."""
    u_btc_dps_per_c: float
    """Standard uncertainty of BTC, °/s/°C."""
    u_t3_c: float
    """Standard uncertainty of T3, °C."""
    cov_pbc_btc_dps2_per_c: float
    """Covariance of PBC and BTC, (°/s)²/°C."""
    coverage: float
    """Probability with which the stated intervals contain the true value."""
    coverage_factor: float
    """Half width of the stated intervals in standard uncertainties."""
    rdy_hz: float
    """Data-ready edges per second."""
    rate_hz: float
    """Rate samples read per second, without lost ones."""
    samples: int
    """Number of rate samples read."""
    lost_samples: int
    """Number of rate samples lost."""
    impossible_readings: int
    """Number of readings that are impossible for the sensor (bit errors). No mean includes them."""
    duration_s: float
    """Time from the first sample to the last, s."""
    temp_min_c: float
    """Lowest temperature, °C."""
    temp_max_c: float
    """Highest temperature, °C."""
    method: str
    """``an1042``, ``warmup`` or ``cycle``."""
    part: str
    """The type of the sensor."""
    serial: str | None
    """Serial number of the sensor, from the caller or the replayed recording; None if neither states it."""
    device: str
    """The device from which the samples came."""
    created: str | None
    """Time at which the samples were recorded, RFC 3339; ``SIMULATED`` for a twin; None if unknown."""
    simulated: bool
    """True if the samples are from the software twin, directly or from a recording of it."""
    calibration_id: str
    """Short identifier of the calibration. Files with corrected data state it."""
    capture_sha256: str
    """SHA-256 of the samples."""
    warnings: list[str]
    """Warnings, each ``code: text``: what was seen and what to do."""
    remarks: list[str]
    """Limitations of every measurement by this plan, each ``code: text``: ``earth-included``, ``curvature-unseen``."""
    curve: list[CurvePoint]
    """The correction at nine temperatures, evenly spread over the measured range."""
    calibration: Calibration = field(repr=False)
    """The calibration, which can correct rates and be saved."""
    truth: Truth | None = None
    """The twin's true values at the end of the last average, or of the recording; None unless a twin was measured."""
    order: int = 1
    """Order of the correction over temperature."""
    order_weights: list[float] | None = None
    """Posterior probability of the orders 0 to 3; None for ``an1042``."""
    btc2_dps_per_c2: float = 0.0
    """Quadratic term BTC2, °/s/°C²; 0 for a line."""
    btc3_dps_per_c3: float = 0.0
    """Cubic term BTC3, °/s/°C³; 0 for a line."""
    lag_s: float | None = None
    """Time by which the bias lags behind the temperature sensor, s; None for ``an1042``."""
    play_c: float | None = None
    """Half width of the backlash between temperature and bias, °C; None for ``an1042``."""
    bias_instability_dps: float | None = None
    """Bias instability B of the recording, °/s; None for ``an1042``."""
    rate_random_walk_dps_per_rt_s: float | None = None
    """Rate random walk K of the recording, °/s/√s; None for ``an1042``."""
    steps: list[dict[str, float]] = field(default_factory=list)
    """Steps of the rate that were removed before the fit: ``at_s``, ``size_dps``, ``u_dps``."""
    sway_probability: float | None = None
    """Posterior probability that the base moved slowly during the recording; None for ``an1042``."""
    budget: list[dict[str, Any]] = field(default_factory=list)
    """Contributions to the uncertainties: ``of`` (PBC or BTC), ``source``, ``u``, ``share`` of the variance."""
    file: str | None = None
    """The file to which the calibration was written; None without ``output``."""
    axes: dict[str, Calibrated] = field(default_factory=dict, repr=False)
    """The result of each axis of a sensor with several, by its name; empty for a sensor with one. The sensor then has
    only what its axes share, and an axis has its own warnings as well."""

    def __repr__(self) -> str:
        half = self.coverage_factor
        pbc = f"PBC {self.pbc_dps:+.5g} ± {half * self.u_pbc_dps:.2g} °/s"
        btc = f"BTC {self.btc_dps_per_c:+.4g} ± {half * self.u_btc_dps_per_c:.2g} °/s/°C at {self.t3_c:.2f} °C"
        origin = f"{self.method} on {self.device}"
        return f"<Calibrated by {origin}: {pbc}, {btc} ({self.coverage:.0%}), {len(self.warnings)} warnings>"

    def _repr_html_(self) -> str:
        return _html.with_pictures(self, self.calibration.pictures())


@checked
def calibrate(
    device: _device.Device,
    /,
    *,
    method: Literal["an1042", "warmup", "cycle"] = "an1042",
    target_dph: float | None = None,
    average: Seconds | None = None,
    warmup: Seconds | None = None,
    settle: Seconds | None = None,
    offset: Seconds | None = None,
    max_lost: float | None = None,
    max_u_btc: float | None = None,
    earth_dps: float | None = None,
    assume_linear: bool = False,
    part: str | os.PathLike[str] | None = None,
    every_temp: int | None = None,
    divider: int | None = None,
    realtime: bool = False,
    serial: str | None = None,
    supply_note: str | None = None,
    ambient_note: str | None = None,
    operator: str | None = None,
    log: str | os.PathLike[str] | None = None,
    output: str | os.PathLike[str] | None = None,
    force: bool = False,
    progress: _device.OnProgress | None = None,
) -> Calibrated:
    """Calibrates a sensor, by default with the procedure of AN-1042.

    The procedure of AN-1042 takes 53 minutes on a real sensor, and seconds on a simulated one.

    Other Python threads run meanwhile, and Ctrl-C ends the measurement. ``zerorate calibrate`` has the same options,
    and its help states the defaults.

    Parameters
    ----------
    device
        The address of the sensor, as in ``zerorate help device``: ``"spi:/dev/spidev0.0?rdy=gpiochip0:25"``,
        ``"bridge:/dev/ttyACM0"``, ``"tcp:HOST:PORT"``, ``"iio:NAME"``, ``"replay:FILE"``, ``"twin:seed=7"``; or a
        `Twin`.
    method
        ``an1042``: two temperatures and the line through them. ``warmup``: a curve fitted to all samples, in the same
        time. ``cycle``: such a curve for a sensor that is heated and cooled.
    target_dph
        End the recording once the temperature has settled and the correction is known to this standard uncertainty,
        rms over the measured temperatures, °/h. Not for ``an1042``.
    average
        Length of the two averages of rate and temperature, steps 4 and 6: seconds, or a text such as ``"1m"``.
    warmup
        Length of the warm-up between these averages, step 5.
    settle
        Length of the settling to thermal balance, step 7.
    offset
        Length of the average that gives PBC, step 8.
    max_lost
        Largest share of lost samples, and of bit errors, in an average or recording, 0 … 1.
    max_u_btc
        Largest standard uncertainty of BTC, °/s/°C.
    earth_dps
        The component of the Earth's rotation along the sensor's axis, °/s, which is subtracted from the bias.
    assume_linear
        Assume that the bias is a straight line over temperature.
    part
        The type of a sensor other than the ADIS16130: a name of ``zerorate parts``, such as ``"icm20948:500"`` with
        the full scale in °/s, or a part file.
    every_temp
        Read the temperature with every N-th rate sample.
    divider
        Read on every N-th data-ready edge only.
    realtime
        Pace simulated or replayed time to the wall clock.
    serial, supply_note, ambient_note, operator
        Texts that are stored in the calibration and in the log.
    log
        Record every sample to this file (`read_capture` reads it).
    output
        Write the calibration file. Without it, the result is only returned: `Calibration.save` writes it.
    force
        Overwrite an existing ``output`` and ``log``, but never a capture by a calibration.
    progress
        A function that is called with a `Progress`, at most ten times a second and once at the end.

    Returns
    -------
    Calibrated
        The numbers with their uncertainty, the warnings, the truth, and the calibration.

    Raises
    ------
    ZerorateError
        If the device cannot be opened or read.
    Refused
        If the sensor moves, freezes, hardly changes its temperature, or loses too many samples.
    ValueError
        For invalid options.
    OSError
        If a file cannot be written. A measured calibration is then saved to another file, which the text names.
    """
    arguments = locals()
    read = _device.options(device, part, every_temp, divider, realtime)
    report, core = _zerorate.calibrate(read, arguments, _device.showing(progress))
    calibration = Calibration._of(core)
    axes = report.pop("axes", None)
    return _of_axis(report, calibration) if axes is None else _Several(report, calibration, axes)


def _of_axis(report: dict[str, Any], calibration: Calibration) -> Calibrated:
    truth = report.pop("truth", None)
    if truth is not None:
        truth["curve"] = [CurvePoint(**point) for point in truth["curve"]]
    curve = [CurvePoint(**point) for point in report.pop("curve")]
    truth = None if truth is None else Truth(**truth)
    return Calibrated(**report, curve=curve, calibration=calibration, truth=truth)


class _Several(Calibrated):
    """The result of a sensor with several axes, without what belongs to one axis."""

    def __init__(self, report: dict[str, Any], calibration: Calibration, axes: list[dict[str, Any]]) -> None:
        all_axes = {}
        for axis in axes:
            name = axis.pop("name")
            notes = {key: [*report[key], *axis[key]] for key in ("warnings", "remarks")}
            all_axes[name] = _of_axis({**report, **axis, **notes}, calibration)
        for key, value in {**report, "calibration": calibration, "axes": all_axes}.items():
            object.__setattr__(self, key, value)

    def __getattribute__(self, name: str) -> Any:
        if name in Calibrated.__dataclass_fields__ and name not in vars(self):
            example = f"result.axes[{next(iter(self.axes))!r}].{name}"
            raise AttributeError(f"{name} belongs to one axis of {', '.join(self.axes)}: take it as {example}")
        return super().__getattribute__(name)

    def __repr__(self) -> str:
        return f"<Calibrated by {self.method} on {self.device}: the axes {', '.join(self.axes)}>"
