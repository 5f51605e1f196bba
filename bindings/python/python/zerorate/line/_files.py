"""Measurements from calibration files, and the files behind a record."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
import warnings
from pathlib import Path

from .._calibration import Calibration
from ._errors import LineError
from ._measurement import AxisResult, Measurement, utc

SIMULATED = "SIMULATED"
TIMEOUT_S = 3600
"""How long the check of one capture may take."""


def read_calibration(path: Path, capture: Path | None = None) -> Measurement:
    """The measurement that a calibration file describes.

    Raises
    ------
    LineError
        If the file is not an undamaged calibration with a serial number, or the capture holds other samples.
    """
    content = read_bytes(path)
    calibration = parse(path, content)
    if not calibration.serial:
        raise LineError(f"{path} has no serial number: calibrate with --serial")
    if capture is not None:
        compare_capture(path, calibration, capture)
    simulated = calibration.created == SIMULATED
    digest = hashlib.sha256(content).hexdigest()
    return Measurement(
        serial=calibration.serial,
        part=calibration.part,
        recipe=f"calibration {digest}",
        simulated=simulated,
        results=tuple(axis_results(calibration)),
        measured=None if simulated else utc(calibration.created),
        method=calibration.method,
        program=calibration.software,
        device=calibration.device,
        operator=calibration.operator,
        warnings=tuple(calibration.warnings),
        calibration_id=calibration.id,
        capture=None if capture is None else os.path.abspath(capture),
        capture_sha256=calibration.capture_sha256,
        calibration=os.path.abspath(path),
        calibration_sha256=digest,
        toml=calibration.text,
    )


def parse(path: Path, content: bytes) -> Calibration:
    """The calibration in a file's bytes. A file without check lines is refused: its numbers may be anyone's."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", UserWarning)
            return Calibration.parse(content.decode("utf-8"))
    except UserWarning as warning:
        raise LineError(f"{path}: {warning}; the record takes measured calibrations only") from None
    except ValueError as error:
        raise LineError(f"{path}: {error}") from None


def axis_results(calibration: Calibration) -> list[AxisResult]:
    """The numbers of each axis. The uncertainty of a curve is that of its covariance."""
    found = []
    for axis in calibration.axes:
        known, curve = axis.uncertainty, axis.curve
        numbers: dict[str, float | None] = {
            "pbc_dps": axis.correction.pbc_dps,
            "btc_dps_per_c": axis.correction.btc_dps_per_c,
            "t3_c": axis.correction.t3_c,
        }
        if known is not None:
            numbers.update(u_pbc_dps=known.u_pbc_dps, u_btc_dps_per_c=known.u_btc_dps_per_c, u_t3_c=known.u_t3_c)
            numbers["cov_pbc_btc_dps2_per_c"] = known.cov_pbc_btc_dps2_per_c
        elif curve is not None:
            covariance = curve.covariance
            numbers.update(u_pbc_dps=covariance[0][0] ** 0.5, u_btc_dps_per_c=covariance[1][1] ** 0.5)
            numbers["cov_pbc_btc_dps2_per_c"] = covariance[0][1]
        if calibration.validity is not None:
            numbers["temp_min_c"] = calibration.validity.temp_min_c
            numbers["temp_max_c"] = calibration.validity.temp_max_c
        found.append(AxisResult(axis.name, numbers))
    return found


def compare_capture(path: Path, calibration: Calibration, capture: Path) -> None:
    """Refuses a capture that does not hold the samples of the calibration."""
    digest, problem = sample_hash(capture)
    if digest is None:
        raise LineError(f"{capture}: {problem}")
    if digest != calibration.capture_sha256:
        raise LineError(
            f"{capture} holds other samples than {path} was computed from: "
            f"their hash is {digest}, and the calibration states {calibration.capture_sha256}"
        )


def sample_hash(capture: Path) -> tuple[str | None, str]:
    """The hash of the samples of a capture, or None and what is wrong with the file."""
    command = [sys.executable, "-m", "zerorate", "verify", os.path.abspath(capture), "--json"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return None, f"`zerorate verify` took longer than {TIMEOUT_S} s"
    try:
        found = json.loads(done.stdout)["files"][0]
    except (ValueError, LookupError):
        return None, (done.stderr.strip() or f"`zerorate verify` ended with {done.returncode}").splitlines()[0]
    if done.returncode != 0 or not found["whole"]:
        return None, found["damage"] or "it is torn: its end is missing"
    return found["samples_sha256"], "it holds no samples"


def read_bytes(path: Path) -> bytes:
    """The bytes of a file."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise LineError(f"{path}: {error.strerror or error}") from None
