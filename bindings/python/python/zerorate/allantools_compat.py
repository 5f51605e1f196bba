"""The deviations of allantools, computed by zerorate: change the import, keep the program.

    import zerorate.allantools_compat as allantools

Signatures, order and names of the results, and the selection of averaging times are the same as in allantools 2024.06.
Its own tests of these functions pass against this module (``cargo xtask python allantools`` in the repository). One
thing differs: missing values (NaN) inside a record stay gaps, and averages over them count if at least half of
their samples are present. allantools returns NaN.

The names in `NOT_OFFERED` are not here: accessing one raises `NotOffered`. New programs should call `zerorate.allan`,
which states confidence limits and noise types without further calls.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _zerorate

__all__ = ["NOT_OFFERED", "NotOffered", "adev", "hdev", "mdev", "oadev", "ohdev", "tdev", "totdev"]

NOT_OFFERED = tuple(
    """
    Dataset Noise ONE_SIGMA_CI Plot autocorr_noise_id calc_hdev_phase calc_htotdev_freq calc_mtotdev_phase
    confidence_interval confidence_interval_noiseID edf_greenhall edf_mtotdev edf_simple edf_totdev
    frequency2fractional frequency2phase gcodev gradev htotdev mask mtie mtie_phase_fast mtotdev noise oadev_realtime
    ohdev_realtime pdev phase2frequency phase2radians psd2allan realtime remove_small_ns tau_generator tau_reduction
    tdev_realtime theo1 three_cornered_hat_phase tierms trim_data ttotdev
    """.split()
)
"""Names of allantools that this module does not have."""

Floats = NDArray[np.float64]
Result = tuple[Floats, Floats, Floats, Floats]


class NotOffered(AttributeError):
    """A name in `NOT_OFFERED` was accessed."""

    def __init__(self, name: str) -> None:
        super().__init__(f"zerorate.allantools_compat does not offer {name}; take it from allantools")
        self.name = name


def __getattr__(name: str) -> object:
    if name in NOT_OFFERED:
        raise NotOffered(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def adev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Allan deviation, NIST SP 1065 equation 10.

    Parameters
    ----------
    data
        Phase in seconds, shape (N,), or fractional frequency, shape (N − 1,). NaN is a missing value.
    rate
        Samples per second.
    data_type
        ``phase`` or ``freq``.
    taus
        Averaging times, s; or ``"octave"`` (1, 2, 4 … samples, also for None and an empty list), ``"decade"`` (1, 2,
        4, 10 … samples), ``"log10"`` (about ten in a decade), ``"all"``.

    Returns
    -------
    (taus, dev, deverr, n)
        Averaging times, s; deviations; deviations / √n; numbers n of terms. Averaging times with fewer than two terms
        are left out.

    Raises
    ------
    UserWarning
        If no averaging time is left.
    RuntimeError
        If the rate is zero.
    """
    return _deviation("adev", data, rate, data_type, taus)


def oadev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Overlapping Allan deviation, NIST SP 1065 equation 11. Arguments and result are as in `adev`."""
    return _deviation("oadev", data, rate, data_type, taus)


def mdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Modified Allan deviation, NIST SP 1065 equation 14. Arguments and result are as in `adev`."""
    return _deviation("mdev", data, rate, data_type, taus)


def tdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Time deviation, s, NIST SP 1065 equation 15. Arguments and result are as in `adev`."""
    return _deviation("tdev", data, rate, data_type, taus)


def hdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Hadamard deviation, NIST SP 1065 equation 17. Arguments and result are as in `adev`."""
    return _deviation("hdev", data, rate, data_type, taus)


def ohdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Overlapping Hadamard deviation, NIST SP 1065 equation 18. Arguments and result are as in `adev`."""
    return _deviation("ohdev", data, rate, data_type, taus)


def totdev(data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None) -> Result:
    """Total deviation, NIST SP 1065 equation 25. Arguments and result are as in `adev`."""
    return _deviation("totdev", data, rate, data_type, taus)


def _deviation(stat: str, data: Any, rate: float, data_type: str, taus: Any) -> Result:
    if data_type not in ("phase", "freq"):
        raise Exception(f"unknown data_type: {data_type}")  # what allantools raises
    if rate == 0:
        raise RuntimeError("rate is 0: give samples per second")
    is_phase = data_type == "phase"
    record = np.ascontiguousarray(data, dtype=np.float64)
    if not is_phase:
        present = np.flatnonzero(~np.isnan(record))
        record = record[present[0] : present[-1] + 1] if len(present) else record[:0]
    points = len(record) + (not is_phase)
    lengths = np.unique(np.round(_lengths(taus, points, float(rate))))
    lengths = lengths[(lengths > 0) & (lengths < points)]
    dev, counts = _zerorate.deviations(record, is_phase, float(rate), stat, lengths.astype(np.int64).tolist())
    enough = counts > 1
    if not enough.any():
        raise UserWarning("no averaging time has more than one term: the record is too short")
    dev, n = dev[enough], counts[enough].astype(np.float64)
    return lengths[enough] / float(rate), dev, dev / np.sqrt(n), n


def _lengths(taus: Any, points: int, rate: float) -> Floats:
    """The averaging times in samples, as allantools chooses them."""
    if taus is None or (isinstance(taus, (list, tuple)) and not len(taus)):
        taus = "octave"
    if not isinstance(taus, str):
        return np.asarray(taus, dtype=np.float64) * rate
    if points < 1:
        return np.empty(0)
    if taus == "all":
        return np.arange(1.0, points + 1)
    if taus == "octave":
        return 2.0 ** np.arange(np.floor(np.log2(points)) + 1)
    if taus == "log10":
        decades = np.log10(points)
        return np.logspace(0.0, decades, int(10 * decades))
    if taus == "decade":
        return np.outer(10.0 ** np.arange(np.floor(np.log10(points)) + 1), [1.0, 2.0, 4.0]).ravel()
    raise ValueError(f"taus={taus!r}: give 'octave', 'decade', 'log10', 'all', or seconds")
