"""The row of one file: the columns of the table of a fleet.

The numbers are from ``zerorate recalibrate``, ``allan --fit`` and ``imu`` with ``--json``, in the same units: rates in
°/s, temperatures in °C, N in °/√s, B in °/s, K in °/s/√s; for an accelerometer, m/s² replaces °/s. ``u_…`` is a
standard uncertainty; ``…_lo`` and ``…_hi`` bound the 95 % interval of a noise coefficient.
"""

from __future__ import annotations

import pyarrow as pa

TEXTS = ["key", "url", "version", "serial", "part", "state", "code", "error", "method", "calibration_id"]
TEXTS += ["capture_sha256", "created", "recipe", "program", "host"]

COEFFICIENTS = ["pbc_dps", "u_pbc_dps", "btc_dps_per_c", "u_btc_dps_per_c", "t3_c", "u_t3_c", "cov_pbc_btc_dps2_per_c"]
NOISE = ["n", "n_lo", "n_hi", "b", "b_lo", "b_hi", "k", "k_lo", "k_hi", "model_error"]

AXIS = pa.struct(
    [("name", pa.string()), ("kind", pa.string()), ("unit", pa.string())]
    + [(name, pa.float64()) for name in COEFFICIENTS + NOISE]
)
"""One of several axes of a sensor or log. ``kind`` and ``unit`` (of the rate) are from the noise analysis."""

AXIS_NAMES = [field.name for field in AXIS]

SCHEMA = pa.schema(
    [(name, pa.string()) for name in TEXTS]
    + [("simulated", pa.bool_()), ("bytes", pa.int64()), ("samples", pa.int64()), ("lost_samples", pa.int64())]
    + [(name, pa.float64()) for name in [*COEFFICIENTS, "temp_min_c", "temp_max_c", *NOISE]]
    + [("axes", pa.list_(AXIS)), ("warnings", pa.list_(pa.string()))]
    + [("seconds", pa.float64()), ("ended", pa.timestamp("ms", tz="UTC"))]
)
"""The columns of ``rows.parquet``.

``state`` is ``ok``, ``refused`` (the measurement must not become a calibration, or its noise model a result),
``failed`` (the file cannot be used) or ``killed`` (the file killed its command or its worker every time). ``code`` and
``error`` give the reason.

``version`` distinguishes contents of the same address: the object's ETag, or a file's size and time. ``created`` is
the time that the capture states. If a sensor has several axes, their numbers are in ``axes``, and these columns of
the row itself are empty.
"""
