"""Makes the files with noise parameters that filters read."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from . import _zerorate
from ._errors import Refused

if TYPE_CHECKING:
    from ._result import Allan

Format = Literal["kalibr", "openvins", "vins", "orbslam3", "kf-gins", "ros"]
"""The program that the file is for; ``ros`` gives the covariances of `sensor_msgs/Imu`."""

Combine = Literal["worst", "mean"]
"""The value for several axes: the worst of their values, or the mean."""


def file(
    axes: Sequence[Allan],
    path: str | os.PathLike[str] | None,
    log: str,
    format: str,
    combine: str,
    horizon_s: float | None,
    as_fitted: bool,
    inflate: float,
    topic: str | None,
    force: bool,
    accept_rejected: bool,
    said: list[str],
) -> str:
    """Makes the text of the file, with those warnings in `said` that concern it. Writes it to `path` if given."""
    modelled = []
    for axis in axes:
        if axis._is_unit_assumed:
            raise ValueError(f"{axis.name}: nothing states its unit, so {axis.unit} is a guess: give unit= to allan()")
        if axis.kind is None:
            what = f"{axis.name} is in {axis.unit}, which is of no axis of an IMU"
            raise ValueError(f"{what}: give unit= (rad/s, m/s² …)")
        if axis._core is None:
            raise _no_model(axis)
        modelled.append((axis.name, axis.unit, axis._core))
    if horizon_s is not None and as_fitted:
        raise ValueError("give horizon_s or as_fitted=True, not both")
    if horizon_s is not None and not 1 < horizon_s < float("inf"):
        raise ValueError(f"horizon_s={horizon_s!r}: give more than 1 s")
    text, doubts = _zerorate.imu_file(
        format, modelled, log, topic, combine, horizon_s, as_fitted, float(inflate), accept_rejected, said
    )
    if doubts:
        warnings.warn("; ".join(doubts) + "; made all the same (accept_rejected=True)", stacklevel=3)
    if path is not None:
        _zerorate.save_text(path, text, force)
    return text


def _no_model(axis: Allan) -> ValueError:
    if axis.fit is not None:
        why = "the result came from another process, which keeps its noise model: make the file there"
        return ValueError(f"{axis.name}: {why}")
    return Refused(f"{axis.name}: {axis.no_fit or 'it has no noise model: give fit=True'}")
