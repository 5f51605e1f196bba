"""The laboratory's file: all errors are reported at once."""

from __future__ import annotations

from datetime import date
from pathlib import Path

import pytest

from zerorate_certificate import Lab


def refusal(path: Path, text: str | bytes) -> str:
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ValueError) as caught:
        Lab.load(path)
    assert str(caught.value).startswith(f"{path}: ")
    return str(caught.value)[len(f"{path}: ") :]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "lab.toml"


def test_the_example_is_a_whole_file(path: Path, example_lab: str) -> None:
    path.write_text(example_lab, encoding="utf-8")
    lab = Lab.load(path)
    assert (lab.number, lab.issued, lab.replaces, lab.equipment) == ("2026-0001", date(2026, 3, 2), None, [])


def test_the_full_example_has_all_of_it(lab: Lab) -> None:
    assert [person.name for person in lab.persons] == ["A. Example", "B. Example"]
    assert (lab.received, lab.item.serial) == (date(2026, 2, 27), "SN7")
    assert lab.replaces is not None and lab.replaces.number == "2026-0000"
    assert [(c.name, c.value, c.unit.dsi) for c in lab.conditions] == [("Air temperature", 23.0, r"\degreecelsius")]


def test_an_empty_file_names_every_mandatory_key(path: Path) -> None:
    contact = ["name", "street", "postcode", "city", "country"]
    wanted = ["place", "number", *(f"{who}.{key}" for who in ("laboratory", "customer") for key in contact)]
    wanted += ["persons", "item.manufacturer", "item.condition", "dates.issued", "deviations"]
    assert refusal(path, "") == f"missing: {', '.join(wanted)}"


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("deviations =", "deviatons =", "missing: deviations; unknown: deviatons (did you mean deviations?)"),
        ("[customer]", "[custommer]", "unknown: custommer (did you mean customer?)"),
        ('role = "Head', 'rolle = "Head', "unknown: persons[1].rolle (did you mean persons[1].role?)"),
        ("number =", "colour = 1\nnumber =", "unknown: colour"),
        ("issued = 2026-03-02", 'issued = "2026-03-02"', "dates.issued must be a date without quotes"),
        ("issued = 2026-03-02", "issued = 2026-03-02T10:00:00Z", "dates.issued must be a date without quotes"),
        ('number = "2026-0001"', "number = 20260001", "number must be a text in quotes"),
        ('number = "2026-0001"', 'number = "  "', "number is empty"),
        ('number = "2026-0001"', 'number = "a\\u0007b"', "number contains a control character"),
        ('number = "2026-0001"', f'number = "{"9" * 81}"', "number is longer than 80 characters"),
        ('deviations = "none"', f'deviations = "{"9" * 2001}"', "deviations is longer than 2000 characters"),
        ('place = "laboratory"', 'place = "lab"', "place must be one of laboratory, customer, laboratoryBranch"),
        ('place = "laboratory"', 'place = "other"', "missing: place_address"),
        ('country = "DE"', 'country = "Germany"', "laboratory.country must be a code of two capital letters"),
        ("[item]", "[[item]]", "item must be a table: [item]"),
        ("[[persons]]", "[persons]", "persons must be a list of tables: [[persons]]"),
        ("[item]", "[replaces]\n[item]", "missing: replaces.number, replaces.reason"),
    ],
)
def test_a_fault_is_named(old: str, new: str, why: str, path: Path, example_lab: str) -> None:
    assert old in example_lab
    assert why in refusal(path, example_lab.replace(old, new, 1))


@pytest.mark.parametrize(
    ("row", "why"),
    [
        ('name = "Air"\nvalue = "23"\nunit = "°C"', "conditions[1].value must be a number without quotes"),
        ('name = "Air"\nvalue = inf\nunit = "°C"', "conditions[1].value must be a number without quotes"),
        ('name = "Air"\nvalue = true\nunit = "°C"', "conditions[1].value must be a number without quotes"),
        ('name = "Air"\nvalue = 23\nunit = "Celsius"', "conditions[1].unit must be one of °C,"),
        ('name = "Air"', "missing: conditions[1].value, conditions[1].unit"),
    ],
)
def test_a_faulty_condition_is_named(row: str, why: str, path: Path, example_lab: str) -> None:
    assert why in refusal(path, f"{example_lab}\n[[conditions]]\n{row}\n")


OTHERS = [("a = ", "is not TOML"), ("a = " + "[" * 9999, "is not TOML"), (b"\xff", "is not text in UTF-8")]


@pytest.mark.parametrize(("content", "why"), OTHERS, ids=["cut", "nested", "binary"])
def test_another_file_is_refused(content: str | bytes, why: str, path: Path) -> None:
    assert why in refusal(path, content)


def test_several_faults_are_told_at_once(path: Path, example_lab: str) -> None:
    why = refusal(path, example_lab.replace("postcode", "postcod", 1).replace('country = "DE"', 'country = "de"'))
    assert "missing: laboratory.postcode; unknown: laboratory.postcod" in why
    assert "laboratory.country must be" in why and "customer.country must be" in why
