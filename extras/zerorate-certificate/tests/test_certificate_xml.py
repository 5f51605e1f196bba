"""The XML of a certificate, against the schemas of PTB and against the numbers of the native program."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import Any

import pytest
from conftest import Made, write
from lxml import etree
from schematron import complaints, rules_of

from zerorate_certificate import Lab, certificate_xml

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

KINDS = ["an1042", "warmup", "cycle", "imu"]
NS = {"dcc": "https://ptb.de/dcc", "si": "https://ptb.de/si"}

# The BIPM names in the D-SI guide that a certificate may use.
UNITS = {"ampere", "degree", "degreecelsius", "hertz", "kelvin", "metre", "one", "pascal", "percent", "second"}
UNITS |= {"tesla", "volt"}
PREFIXES = {"hecto", "kilo", "milli", "micro"}


@pytest.fixture(scope="module")
def schema(shared: Path) -> Any:
    return etree.XMLSchema(etree.parse(str(shared / "dcc" / "v3.3.0" / "dcc.xsd"), etree.XMLParser(no_network=True)))


@pytest.fixture(scope="module")
def schematron(shared: Path) -> Path:
    return shared / "schematron" / "dcc.sch"


def tree_of(path: Path, lab: Lab) -> Any:
    return etree.fromstring(certificate_xml(path, lab))


def texts(tree: Any, path: str) -> list[str]:
    return ["".join(element.itertext()).strip() for element in tree.iterfind(path, NS)]


def quantities(tree: Any) -> dict[str, tuple[float, float | None]]:
    """Value and U of each single quantity. The key is the name of the result, `/`, and the name of the quantity."""
    found = {}
    for result in tree.iterfind(".//dcc:result", NS):
        title = result.findtext("dcc:name/dcc:content", namespaces=NS)
        for quantity in result.iterfind("dcc:data/dcc:quantity", NS):
            expanded = quantity.findtext(".//si:valueExpandedMU", namespaces=NS)
            name = f"{title}/{quantity.findtext('dcc:name/dcc:content', namespaces=NS)}"
            value = float(quantity.findtext("si:real/si:value", namespaces=NS))
            found[name] = (value, None if expanded is None else float(expanded))
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_the_xml_is_valid(kind: str, made: dict[str, Made], lab: Lab, schema: Any, schematron: Path) -> None:
    document = certificate_xml(made[kind].path, lab)
    assert schema.validate(etree.fromstring(document)), schema.error_log
    assert complaints(document, schematron) == []


def test_a_measured_certificate_of_the_shortest_lab_file_is_valid(
    measured: Path, example_lab: str, tmp_path: Path, schema: Any, schematron: Path
) -> None:
    short = Lab.load(write(tmp_path / "lab.toml", example_lab))
    document = certificate_xml(measured, replace(short, issued=date(2026, 3, 2)))
    assert schema.validate(etree.fromstring(document)), schema.error_log
    assert complaints(document, schematron) == []


def test_the_schematron_complains_about_a_broken_document(simulated: Path, lab: Lab, schematron: Path) -> None:
    document = certificate_xml(simulated, lab)
    assert rules_of(schematron) > 30
    for old, new, words in [
        (b"<dcc:release>v", b"<dcc:release>", "release version"),
        (b'lang="en"', b'lang="de"', "language code"),
        (b"<dcc:endPerformanceDate>2026", b"<dcc:endPerformanceDate>2025", "date range"),
        (b"<dcc:countryCodeISO3166_1>DE", b"<dcc:countryCodeISO3166_1>QQ", "country code"),
        (b"dcc:influenceConditions>", b"dcc:other>", "influence conditions"),
    ]:
        assert old in document
        found = complaints(document.replace(old, new), schematron)
        assert any(role == "error" and words in text for role, text in found), words


@pytest.mark.parametrize("kind", KINDS)
def test_units_are_of_the_digital_si(kind: str, made: dict[str, Made], lab: Lab) -> None:
    units = {u.text for u in tree_of(made[kind].path, lab).iter("{*}unit", "{*}unitXMLList")}
    assert {r"\degree\second\tothe{-1}", r"\degree\second\tothe{-1}\kelvin\tothe{-1}", r"\degreecelsius"} <= units
    for unit in units:
        assert is_dsi(unit), unit


def is_dsi(unit: str) -> bool:
    """True for a D-SI unit: factors with BIPM names, each with a prefix and a power if it needs them."""
    rest = unit
    while rest:
        words = re.match(r"(?:\\([a-z]+))?\\([a-z]+)(?:\\tothe\{(-?\d+(?:\.\d+)?)\})?", rest)
        if words is not None and words[1] not in PREFIXES:
            words = re.match(r"()\\([a-z]+)(?:\\tothe\{(-?\d+(?:\.\d+)?)\})?", rest)
        if words is None or words[2] not in UNITS:
            return False
        rest = rest[words.end() :]
    return unit != ""


def test_the_numbers_are_those_of_the_file_and_the_uncertainty_is_twice_the_standard_one(
    simulated: Path, lab: Lab
) -> None:
    file = tomllib.loads(simulated.read_text(encoding="utf-8"))
    stated, u = quantities(tree_of(simulated, lab)), file["uncertainty"]
    assert stated["Bias correction/PBC"] == (file["correction"]["pbc_dps"], 2 * u["u_pbc_dps"])
    assert stated["Bias correction/BTC"] == (file["correction"]["btc_dps_per_c"], 2 * u["u_btc_dps_per_c"])
    assert stated["Bias correction/T3"] == (file["correction"]["t3_c"], None)
    assert stated["Bias correction/Covariance of PBC and BTC"] == (u["cov_pbc_btc_dps2_per_c"], None)
    noise = {name: value for name, value in stated.items() if name.startswith("Noise")}
    white = (file["noise"]["white_dps_per_rt_hz"], None)
    assert noise == {"Noise of the rate/White noise, one-sided density": white}


@pytest.mark.parametrize("kind", ["an1042", "warmup", "imu"])
def test_the_curve_is_that_of_the_native_program(kind: str, made: dict[str, Made], lab: Lab) -> None:
    lists = tree_of(made[kind].path, lab).findall(".//dcc:result/dcc:data/dcc:list", NS)
    reports = made[kind].report["axes"] if kind == "imu" else [made[kind].report]
    assert len(lists) == len(reports) == (3 if kind == "imu" else 1)
    for columns, report in zip(lists, reports):
        temps, corrections = (list(map(float, c.text.split())) for c in columns.iterfind(".//si:valueXMLList", NS))
        expanded = list(map(float, columns.findtext(".//si:valueExpandedMUXMLList", namespaces=NS).split()))
        curve = report["curve"]
        assert temps == pytest.approx([point["temp_c"] for point in curve], rel=1e-12)
        assert corrections == pytest.approx([point["correction_dps"] for point in curve], rel=1e-9)
        assert expanded == pytest.approx([2 * point["u_dps"] for point in curve], rel=1e-6)


def test_the_covariances_of_a_curve_give_its_uncertainty(made: dict[str, Made], lab: Lab) -> None:
    tree = tree_of(made["warmup"].path, lab)
    stated = {name.split("/")[1]: pair for name, pair in quantities(tree).items() if name.startswith("Bias")}
    names = ["PBC", "BTC", "BTC2", "BTC3"]
    columns = tree.find(".//dcc:result/dcc:data/dcc:list", NS)
    temps = list(map(float, columns.findtext(".//si:valueXMLList", namespaces=NS).split()))
    expanded = list(map(float, columns.findtext(".//si:valueExpandedMUXMLList", namespaces=NS).split()))
    for temp_c, wanted in zip(temps, expanded):
        d = temp_c - stated["T3"][0]
        variance = sum(((stated[name][1] or 0) / 2 * d**k) ** 2 for k, name in enumerate(names))
        for i in range(4):
            for j in range(i + 1, 4):
                variance += 2 * stated[f"Covariance of {names[i]} and {names[j]}"][0] * d ** (i + j)
        assert 2 * math.sqrt(variance) == pytest.approx(wanted, rel=1e-6)


def test_each_axis_has_its_results(made: dict[str, Made], lab: Lab) -> None:
    names = texts(tree_of(made["imu"].path, lab), ".//dcc:result/dcc:name")
    wanted = ["Bias correction", "Correction over temperature", "Noise of the rate"]
    assert names == [f"Axis {axis}: {name}" for axis in "xyz" for name in wanted]


@pytest.mark.parametrize("kind", KINDS)
def test_every_warning_is_there_in_full(kind: str, made: dict[str, Made], lab: Lab) -> None:
    file = tomllib.loads(made[kind].path.read_text(encoding="utf-8"))
    # in newer files, a warning begins with a code, which the certificate leaves out
    words = [re.sub("^[a-z-]+: ", "", text) for text in file["warnings"]]
    of_axes = [(axis["name"], text) for axis in file.get("axis", []) for text in axis["warnings"]]
    wanted = words + [f"axis {name}: {re.sub('^[a-z-]+: ', '', text)}" for name, text in of_axes]
    assert wanted
    assert texts(tree_of(made[kind].path, lab), ".//dcc:metaData/dcc:declaration") == wanted


def test_a_simulated_certificate_says_so_wherever_a_date_of_performance_stands(simulated: Path, lab: Lab) -> None:
    tree = tree_of(simulated, lab)
    assert texts(tree, ".//dcc:item/dcc:name")[0].startswith("SIMULATED")
    assert texts(tree, ".//dcc:measurementResult/dcc:name")[0].startswith("SIMULATED")
    statement = texts(tree, ".//dcc:statement/dcc:declaration")[0]
    assert statement.startswith("SIMULATED") and "no dates of performance" in statement
    assert texts(tree, ".//dcc:beginPerformanceDate") == texts(tree, ".//dcc:issueDate") == ["2026-03-02"]


def test_a_measured_certificate_has_the_days_of_the_measurement(measured: Path, lab: Lab) -> None:
    tree = tree_of(measured, lab)
    # the measurement takes 221 s from 23:58:30
    assert texts(tree, ".//dcc:beginPerformanceDate") == ["2026-02-27"]
    assert texts(tree, ".//dcc:endPerformanceDate") == ["2026-02-28"]
    assert b"SIMULATED" not in etree.tostring(tree)


def test_traceability_and_accreditation_are_not_claimed(measured: Path, lab: Lab) -> None:
    tree = tree_of(measured, lab)
    assert texts(tree, ".//dcc:traceable") == ["false"]
    assert tree.find(".//dcc:calibrationLaboratoryCode", NS) is None
    declared = texts(tree, ".//dcc:statement/dcc:declaration")
    assert any("not the certificate of an accredited calibration" in text for text in declared)


def test_the_first_person_signs_and_an_amendment_names_what_it_replaces(measured: Path, lab: Lab) -> None:
    tree = tree_of(measured, lab)
    assert texts(tree, ".//dcc:mainSigner") == ["true", "false"]
    assert texts(tree, ".//dcc:replacedUniqueIdentifier") == ["2026-0000"]
    assert any("2026-0000" in text and "misspelt" in text for text in texts(tree, ".//dcc:declaration"))
