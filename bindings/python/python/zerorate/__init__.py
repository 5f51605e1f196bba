"""Allan deviation of any gyroscope, and calibration of the ADIS16130 gyroscope, with a simulated one to try it on.

===================  ==================================================================
`allan`              Allan deviation of a record or a log at rest, with limits and a noise model
`imu`                Allan deviation of all axes of an IMU, and noise files for filters
`tempcal`            bias over temperature of all axes, and files for flight controllers
`read_log`           columns of a log in any form
`calibrate`          the procedure of AN-1042 on a sensor or a `Twin`, with uncertainties
`capture`            a recording of a sensor's raw codes
`stream`             the corrected rate of a sensor, row by row
`Calibration`        a calibration file; `Calibration.correct` removes the bias
`Corrector`          removes the bias from a stream with occasional temperatures
`read_capture`       a recording as numpy columns
`Twin`               a simulated sensor, drawn from a seed
`allantools_compat`  the deviations of allantools: change the import, keep the program
===================  ==================================================================

Units are in the names: ``rate_dps`` is in °/s, ``tau_s`` in seconds, ``temp_c`` in °C. Invalid arguments raise
ValueError, whose text says what to do. A file that cannot be read or written raises OSError, and a device that cannot
be read `ZerorateError`. A measurement that must not become a result raises `Refused`, which is both a `ZerorateError`
and a ValueError.
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
from ._device import Progress
from ._errors import Refused, ZerorateError
from ._imu import Imu, imu
from ._log import Log, read_log
from ._model import BandShape, Cleaned, Coefficient, Detrended, Estimate, Fit, GaussMarkov, Line, WarmUp
from ._procedure import Calibrated, CurvePoint, Truth, calibrate
from ._recording import Captured, capture
from ._result import Allan, AllanAxes, Unavailable
from ._stream import Stream, StreamRow, stream
from ._tempcal import BiasAxis, BiasCubic, BiasCurve, BiasMeans, BiasNoise, Tempcal, tempcal
from ._twin import Twin, TwinKey

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
    "Captured",
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
    "Progress",
    "Refused",
    "Run",
    "Scale",
    "Stream",
    "StreamRow",
    "Tempcal",
    "Truth",
    "Twin",
    "TwinKey",
    "Unavailable",
    "Uncertainties",
    "Validity",
    "WarmUp",
    "ZerorateError",
    "__version__",
    "allan",
    "calibrate",
    "capture",
    "imu",
    "read_capture",
    "read_log",
    "stream",
    "tempcal",
]
