"""The statements of a certificate, in order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ._quantity import COVERAGE_FACTOR, typeset
from ._results import typical_noise

if TYPE_CHECKING:
    from zerorate import Calibration, Run, Validity

    from ._lab import Lab

METHODS = {
    "an1042": (
        "Analog Devices, application note AN-1042",
        "The part rests. Two averages of rate and temperature with a warm-up between them give BTC. "
        "A long average after settling gives PBC at the temperature T3.",
    ),
    "warmup": (
        "zerorate, method warmup",
        "The part rests and warms by itself. A polynomial over temperature is fitted to the whole recording, "
        "averaged over its orders 0 to 3 by their probability.",
    ),
    "cycle": (
        "zerorate, method cycle",
        "The part rests while it is heated and cooled. A polynomial over temperature is fitted to the whole "
        "recording, averaged over its orders 0 to 3 by their probability.",
    ),
    "chamber": (
        "zerorate, method chamber",
        "The part rests in a chamber that follows a plan of temperatures. The bias at its steps gives the correction.",
    ),
}
"""Name and description of each method."""


@dataclass(frozen=True)
class Statement:
    name: str
    text: str
    traceable: bool | None = None
    """True or False for the statement on traceability; None for all others."""
    own_words: bool = False
    """True if the text has words of the laboratory, whose language is unknown."""


def method_of(calibration: Calibration) -> tuple[str, str]:
    method = calibration.method or ""
    return METHODS.get(method, (f"zerorate, method {method}", "The part rests."))


def statements_of(
    calibration: Calibration, run: Run, validity: Validity, lab: Lab, simulated: bool
) -> list[Statement]:
    return [
        *_of_simulation(simulated),
        *_of_amendment(lab),
        *_of_standing(),
        *_of_numbers(calibration, run, validity),
        *_of_laboratory(lab),
    ]


def _of_simulation(simulated: bool) -> list[Statement]:
    if not simulated:
        return []
    text = (
        "SIMULATED. The item is the software twin, so that nothing was measured on a real part. There are no dates of "
        "performance. Where a form demands them, the date of issue stands in their place. "
        "This document must not be used as a certificate."
    )
    return [Statement("Simulated item", text)]


def _of_amendment(lab: Lab) -> list[Statement]:
    if lab.replaces is None:
        return []
    text = f"This certificate replaces the certificate {lab.replaces.number}. Reason: {lab.replaces.reason}"
    return [Statement("Amendment", text, own_words=True)]


def _of_standing() -> list[Statement]:
    return [
        Statement("Item", "The results relate only to the item calibrated, as it was when it was calibrated."),
        Statement(
            "Traceability",
            "Metrological traceability is not claimed. The temperature is the reading of the part's own sensor, and "
            "the reference of the rate is rest. No reference with a certificate stands behind either.",
            traceable=False,
        ),
        Statement(
            "Accreditation",
            "The laboratory issues this certificate under its own responsibility. It is not the certificate of an "
            "accredited calibration. No accreditation body and no signatory of the ILAC MRA stands behind it.",
        ),
        Statement(
            "Adjustment",
            "The item was not adjusted. The results are corrections, which the user applies. "
            "No interval for recalibration is recommended.",
        ),
        Statement("Reproduction", "This certificate may be reproduced only in full, unless the laboratory approves."),
    ]


def _of_numbers(calibration: Calibration, run: Run, validity: Validity) -> list[Statement]:
    lowest, highest = (typeset(f"{temp_c:.1f}") for temp_c in (validity.temp_min_c, validity.temp_max_c))
    statements = [
        Statement(
            "Sign convention",
            "All coefficients are added to the rate. Each is minus the bias that it removes. T3 is the temperature "
            "at which PBC holds; its error is part of the uncertainty of PBC.",
        ),
        Statement(
            "Uncertainty",
            f"U is the expanded uncertainty: the standard uncertainty multiplied by the coverage factor "
            f"k = {COVERAGE_FACTOR}, which for a normal distribution is a coverage probability of about 95 % "
            "(JCGM 100:2008). It does not include the long-term behaviour of the item.",
        ),
        Statement(
            "Rounding",
            "On the page, U has two digits and the value is rounded to the same decimal place. "
            "The digital certificate (XML) has the values without this rounding.",
        ),
        Statement(
            "Range",
            f"The results hold from {lowest} °C to {highest} °C of the part's own sensor. "
            "Outside of this range they are extrapolated and are not certified.",
        ),
    ]
    if run.assume_linear:
        text = "The bias was taken for a straight line over temperature. Curvature is not part of the uncertainty."
        statements.append(Statement("Linearity", text))
    return statements + _of_noise(calibration)


def _of_noise(calibration: Calibration) -> list[Statement]:
    sources = sorted({source for axis in calibration.axes for source in typical_noise(axis.noise)})
    if not sources:
        return []
    text = "The uncertainty uses values that this measurement did not determine. The calibration names their sources: "
    return [Statement("Noise from elsewhere", f"{text}{', '.join(sources)}.")]


def _of_laboratory(lab: Lab) -> list[Statement]:
    texts = [
        ("Deviations from the method, additions and exclusions", lab.deviations),
        ("Data from the customer, not checked by the laboratory", lab.customer_data),
        ("Remarks", lab.remarks),
    ]
    return [Statement(name, text, own_words=True) for name, text in texts if text]
