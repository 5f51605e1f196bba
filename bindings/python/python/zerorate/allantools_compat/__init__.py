"""The deviations of allantools, computed by zerorate: change the import, keep the program.

    import zerorate.allantools_compat as allantools

Signatures, order and names of the results, and the selection of averaging times are the same as in allantools 2024.06.
Its own tests of these functions pass against this module (``cargo xtask python allantools`` in the repository). The
differences:

* Missing values (NaN) inside a record stay gaps: averages over them count if half of their samples are present.
  allantools returns NaN.
* Where allantools raises NotImplementedError, so does `autocorr_noise_id`; only `zerorate.allan` identifies the noise
  there.
* `gradev` has the limits that allantools documents, and `mtie` leaves missing phase out.
* The names in `NOT_OFFERED` are not here; an access to them says so.

New programs should call `zerorate.allan`, which states confidence limits and noise types without further calls.
"""

from __future__ import annotations

from ._confidence import (
    ONE_SIGMA_CI,
    autocorr_noise_id,
    confidence_interval,
    confidence_interval_noiseID,
    edf_greenhall,
    edf_simple,
    edf_totdev,
)
from ._convert import frequency2fractional, frequency2phase, phase2frequency, phase2radians, trim_data
from ._deviations import (
    adev,
    gradev,
    hdev,
    mdev,
    mtie,
    oadev,
    ohdev,
    remove_small_ns,
    tdev,
    three_cornered_hat_phase,
    totdev,
)
from ._offer import NOT_OFFERED, NotOffered
from ._taus import tau_generator, tau_reduction

__all__ = [
    "NOT_OFFERED",
    "NotOffered",
    "ONE_SIGMA_CI",
    "adev",
    "autocorr_noise_id",
    "confidence_interval",
    "confidence_interval_noiseID",
    "edf_greenhall",
    "edf_simple",
    "edf_totdev",
    "frequency2fractional",
    "frequency2phase",
    "gradev",
    "hdev",
    "mdev",
    "mtie",
    "oadev",
    "ohdev",
    "phase2frequency",
    "phase2radians",
    "remove_small_ns",
    "tau_generator",
    "tau_reduction",
    "tdev",
    "three_cornered_hat_phase",
    "totdev",
    "trim_data",
]

def __getattr__(name: str) -> object:
    if name in NOT_OFFERED:
        raise NotOffered(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
