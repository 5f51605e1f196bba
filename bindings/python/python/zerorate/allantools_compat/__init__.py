"""The functions of allantools, computed by zerorate: change the import, keep the program.

    import zerorate.allantools_compat as allantools

Signatures, order and names of the results, and the selection of averaging times are those of allantools 2024.06, whose
own tests of these functions pass against this module (``cargo xtask python allantools`` in the repository). What is
different:

* Missing values (NaN) inside of a record stay gaps: averages over them count if half of their samples are there.
  allantools returns NaN.
* The noise is identified where allantools raises NotImplementedError only by `zerorate.allan`, not by
  `autocorr_noise_id`.
* `gradev` has the limits that allantools says it has, and `mtie` leaves missing phase out.
* What is in `NOT_OFFERED` is not here; an access to it says so.

New programs should call `zerorate.allan`, which states confidence limits and noise types without further calls.
"""

from __future__ import annotations

from . import noise
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
from ._dataset import Dataset
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
from ._kasdin import Noise
from ._offer import NOT_OFFERED, NotOffered
from ._taus import tau_generator, tau_reduction

__all__ = [
    "NOT_OFFERED",
    "Dataset",
    "Noise",
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
    "noise",
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
