"""The page of a certificate: its content, and the rounding of its numbers."""

from __future__ import annotations

import html
import re
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import Made, write
from sealing import as_measured, sealed

from zerorate_certificate import Lab, certificate_html
from zerorate_certificate._quantity import DPS, Quantity


def cells(page: str) -> list[list[str]]:
    """The rows of all tables, without tags."""
    rows = re.findall(r"<tr>(.*?)</tr>", page, re.DOTALL)
    split = [re.findall(r"<t[dh].*?>(.*?)</t[dh]>", row, re.DOTALL) for row in rows]
    return [[html.unescape(re.sub("<.*?>", " ", cell)).strip() for cell in row] for row in split]


@pytest.mark.parametrize(
    ("value", "u", "shown", "expanded"),
    [
        # JCGM 100:2008, 7.2.2: m = 100.021 47 g with u = 0.35 mg
        (100.02147, 0.00035, "100.02147", "0.00070"),
        # JCGM 100:2008, H.1.7: 50.000 838 mm with u = 32 nm
        (50.000838, 32e-6, "50.000838", "0.000064"),
        # EA-4/02 M:2022, S2.13: 10.000 025 kg ± 59 mg
        (10.000025, 29.3e-6, "10.000025", "0.000059"),
        (-0.4657354575747914, 0.01020544042744064, "−0.466", "0.020"),
        (1.23456, 0.0498, "1.23", "0.10"),
        (1234.5, 51.0, "1230", "100"),
        (-0.0004, 0.01, "0.000", "0.020"),
        (0.125, 0.05, "0.12", "0.10"),
    ],
)
def test_the_uncertainty_has_two_digits_and_the_value_ends_where_it_does(
    value: float, u: float, shown: str, expanded: str
) -> None:
    quantity = Quantity("x", value, DPS, u)
    assert (quantity.shown, quantity.shown_expanded) == (shown, expanded)


def test_the_results_are_rounded(simulated: Path, lab: Lab) -> None:
    rows = cells(certificate_html(simulated, lab))
    assert any(row[0] == "PBC" and row[3] == "°/s" and re.fullmatch(r"−0\.\d{3}", row[1]) for row in rows)
    assert any(row[0] == "BTC" and row[3] == "°/s/°C" and re.fullmatch(r"0\.0\d\d", row[2]) for row in rows)


@pytest.mark.parametrize(("kind", "pictures"), [("an1042", 1), ("warmup", 1), ("cycle", 1), ("imu", 3)])
def test_each_axis_has_the_picture_of_the_report(kind: str, pictures: int, made: dict[str, Made], lab: Lab) -> None:
    page = certificate_html(made[kind].path, lab)
    assert page.count("data:image/svg+xml;base64,") == pictures
    assert len(re.findall("<h3>Axis", page)) == (3 if kind == "imu" else 0)


def test_the_page_loads_nothing(simulated: Path, lab: Lab) -> None:
    page = certificate_html(simulated, lab)
    addresses = re.findall(r"(?:src|href)=\"([^\"]*)|url\(|@import", page)
    assert addresses and all(address.startswith("data:") for address in addresses)


def test_everything_that_the_laboratory_states_is_on_the_page(measured: Path, lab_file: Path, lab: Lab) -> None:
    page = html.unescape(certificate_html(measured, lab))
    stated = re.findall(r'= "(.*?)"', lab_file.read_text(encoding="utf-8"))
    assert len(stated) > 25
    for text in stated:
        assert ("In the laboratory" if text == "laboratory" else text) in page
    for day in ("2026-02-27", "2026-02-28", "2026-03-02"):
        assert day in page


def test_limits_of_the_claims_are_stated(measured: Path, lab: Lab) -> None:
    page = certificate_html(measured, lab)
    assert "Metrological traceability is not claimed" in page
    assert "not the certificate of an accredited calibration" in page
    assert "All coefficients are added to the rate" in page


def test_tags_in_a_text_stay_text(measured: Path, lab: Lab) -> None:
    page = certificate_html(measured, replace(lab, remarks="<script>alert(1)</script>", number='1"</style><b>'))
    assert "<script>" not in page
    assert page.count("</style>") == 1


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (r'created = "[^"]*"\n', "", r"no time \(created\)"),
        (r'created = "[^"]*"', 'created = "yesterday"', "not an RFC 3339 time"),
        (r'created = "[^"]*"', 'created = "9999-12-31T23:59:59Z"', "not an RFC 3339 time"),
        (r'created = "[^"]*"', 'created = "2026-03-03T00:00:00Z"', "before the end of the measurement"),
        (r'created = "[^"]*"', 'created = "2026-02-26T00:00:00Z"', "after the begin of the measurement"),
        (r'serial = "[^"]*"', 'serial = "SN8"', "'SN8' here and 'SN7'"),
        (r"\[run\](\n[^[\n]+)+", "", r"no \[run\]"),
        (r"\[validity\](\n[^[\n]+)+", "", r"no \[validity\]"),
        (r"\[uncertainty\](\n[^[\n]+)+", "", "no uncertainty is stated"),
        (r"u_pbc_dps = .*", "u_pbc_dps = 0.0", "does not fit the uncertainties"),
        (r'method = "[^"]*"\n', "", "no method"),
    ],
)
def test_a_calibration_that_says_too_little_is_refused(
    old: str, new: str, why: str, measured: Path, lab: Lab, tmp_path: Path
) -> None:
    text, changes = re.subn(old, new, measured.read_text(encoding="utf-8"))
    assert changes == 1
    path = write(tmp_path / "unit.toml", sealed(text))
    with pytest.raises(ValueError, match=why):
        certificate_html(path, lab)


def test_a_twin_is_simulated_whatever_the_time_says(simulated: Path, lab: Lab, tmp_path: Path) -> None:
    text = simulated.read_text(encoding="utf-8").replace('"SIMULATED"', '"2026-02-27T12:00:00Z"')
    path = write(tmp_path / "unit.toml", sealed(text))
    assert "SIMULATED: the software twin" in certificate_html(path, lab)


def test_an_assumed_straight_line_is_said(simulated: Path, lab: Lab, tmp_path: Path) -> None:
    text = simulated.read_text(encoding="utf-8").replace("assume_linear = false", "assume_linear = true")
    path = write(tmp_path / "unit.toml", as_measured(text))
    assert "Curvature is not part of the uncertainty" in certificate_html(path, lab)
