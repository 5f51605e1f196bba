"""Allan deviation of any gyroscope, and calibration of the ADIS16130 gyroscope, with a simulated one to try it on.

===================  ==================================================================
`allan`              Allan deviation of a record or a log at rest, with limits and a noise model
`imu`                the same for all axes of an IMU, and the noise files for filters
`tempcal`            bias over temperature of all axes, and files for flight controllers
`read_log`           columns of a log in any form
`calibrate`          the procedure of AN-1042 on a `Twin`, with uncertainties
`Calibration`        a calibration file; `Calibration.correct` removes the bias
`Corrector`          the same for a stream with occasional temperatures
`read_capture`       a recording of raw codes as numpy columns
`Twin`               a simulated sensor, drawn from a seed
`allantools_compat`  the deviations of allantools: change the import, keep the program
===================  ==================================================================

Units are in the names: ``rate_dps`` is in °/s, ``tau_s`` in seconds, ``temp_c`` in °C. Invalid arguments raise
ValueError, whose text says what to do. A measurement that must not become a calibration raises `Refused`.
"""

from importlib.metadata import version

from ._allan import allan
from ._calibration import (
    CalibratedAxis,
    Calibration,
    Corrected,
    Correction,
    Corrector,
    CurveRecord,
    Measured,
    NoiseRecord,
    Run,
    Scale,
    Uncertainties,
    Validity,
)
from ._capture import Capture, read_capture
from ._imu import Imu, imu
from ._log import Log, read_log
from ._model import BandShape, Cleaned, Coefficient, Detrended, Estimate, Fit, GaussMarkov, Line, WarmUp
from ._procedure import Calibrated, CurvePoint, Truth, calibrate
from ._result import Allan, AllanAxes, Unavailable
from ._tempcal import BiasAxis, BiasCubic, BiasCurve, BiasMeans, BiasNoise, Tempcal, tempcal
from ._twin import Twin, TwinKey
from ._zerorate import Refused

__version__ = version("zerorate")

__all__ = [
    "Allan",
    "AllanAxes",
    "BandShape",
    "BiasAxis",
    "BiasCubic",
    "BiasCurve",
    "BiasMeans",
    "BiasNoise",
    "Calibrated",
    "CalibratedAxis",
    "Calibration",
    "Capture",
    "Cleaned",
    "Coefficient",
    "Corrected",
    "Correction",
    "Corrector",
    "CurvePoint",
    "CurveRecord",
    "Detrended",
    "Estimate",
    "Fit",
    "GaussMarkov",
    "Imu",
    "Line",
    "Log",
    "Measured",
    "NoiseRecord",
    "Refused",
    "Run",
    "Scale",
    "Tempcal",
    "Truth",
    "Twin",
    "TwinKey",
    "Unavailable",
    "Uncertainties",
    "Validity",
    "WarmUp",
    "__version__",
    "allan",
    "calibrate",
    "imu",
    "read_capture",
    "read_log",
    "tempcal",
]
