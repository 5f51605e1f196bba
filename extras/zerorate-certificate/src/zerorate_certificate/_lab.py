"""The laboratory's part of a certificate: facts that a calibration file does not state, read from ``lab.toml``."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ._quantity import CONDITION_UNITS, Quantity
from ._table import Problems, Table

if TYPE_CHECKING:
    from datetime import date

EXAMPLE = Path(__file__).with_name("lab.toml")
"""The example of ``lab.toml`` that ``--example-lab`` prints."""

MAX_NUMBER = 80
MAX_NAME = 240
"""Largest number of characters of a certificate's number, and of a laboratory's (on each page) or customer's name."""

PLACES = {
    "laboratory": "In the laboratory",
    "customer": "At the customer's",
    "laboratoryBranch": "In a branch of the laboratory",
    "customerBranch": "In a branch of the customer",
    "other": "Elsewhere",
}
"""Places of performance: the name in DCC 3.3.0, and a text for the page."""


@dataclass(frozen=True)
class Contact:
    """A laboratory or a customer."""

    name: str
    street: str
    postcode: str
    city: str
    country: str
    """ISO 3166-1, two letters."""
    email: str | None = None
    phone: str | None = None


@dataclass(frozen=True)
class Person:
    """A person who is responsible for the certificate."""

    name: str
    role: str


@dataclass(frozen=True)
class Equipment:
    """An instrument that was used, and its number in the laboratory's inventory."""

    name: str
    id: str


@dataclass(frozen=True)
class Item:
    """The laboratory's facts about the item."""

    manufacturer: str
    condition: str
    serial: str | None = None
    """Serial number of the item; needed only if the calibration does not state it."""


@dataclass(frozen=True)
class Replaced:
    """A certificate that this one replaces (ISO/IEC 17025:2017, 7.8.8)."""

    number: str
    reason: str


@dataclass(frozen=True)
class Lab:
    """The statements of the laboratory. `Lab.load` reads them from a file."""

    number: str
    """Number of the certificate, unique in the laboratory."""
    laboratory: Contact
    customer: Contact
    persons: list[Person]
    """Responsible persons. The first person authorises the certificate."""
    item: Item
    place: str
    """Place of the calibration: a key of ``PLACES``."""
    issued: date
    deviations: str
    """Additions to the method, deviations from it and exclusions."""
    place_address: str | None = None
    received: date | None = None
    remarks: str | None = None
    customer_data: str | None = None
    """Facts that the customer stated and the laboratory did not check."""
    equipment: list[Equipment] = field(default_factory=list)
    conditions: list[Quantity] = field(default_factory=list)
    replaces: Replaced | None = None

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Lab:
        """Reads ``lab.toml``.

        Raises
        ------
        ValueError
            If keys are missing, unknown or wrong; the text names all of them.
        OSError
            If the file cannot be read.
        """
        try:
            root = Table.load(path)
            lab = _lab(root)
            root.raise_problems()
        except Problems as problems:
            raise ValueError(f"{os.fspath(path)}: {problems}") from None
        return lab


def _lab(root: Table) -> Lab:
    dates, place, replaces = root.table("dates"), root.choice("place", list(PLACES)), root.table_or_none("replaces")
    item = root.table("item")
    lab = Lab(
        number=root.text("number", limit=MAX_NUMBER),
        laboratory=_contact(root.table("laboratory")),
        customer=_contact(root.table("customer")),
        persons=_persons(root),
        item=Item(item.text("manufacturer"), item.text("condition"), item.text_or_none("serial")),
        place=place,
        place_address=_place_address(root, place),
        issued=dates.day("issued"),
        received=dates.day_or_none("received"),
        deviations=root.text("deviations"),
        remarks=root.text_or_none("remarks"),
        customer_data=root.text_or_none("customer_data"),
        equipment=[Equipment(row.text("name"), row.text("id")) for row in root.tables("equipment")],
        conditions=[_condition(row) for row in root.tables("conditions")],
        replaces=None if replaces is None else Replaced(replaces.text("number"), replaces.text("reason")),
    )
    root.finish()
    return lab


def _place_address(root: Table, place: str) -> str | None:
    """The address of the place; None is allowed only if the place is at the laboratory or the customer."""
    address = root.text_or_none("place_address")
    if address is None and place in ("laboratoryBranch", "customerBranch", "other"):
        root.missing("place_address")
    return address


def _contact(table: Table) -> Contact:
    return Contact(
        name=table.text("name", limit=MAX_NAME),
        street=table.text("street"),
        postcode=table.text("postcode"),
        city=table.text("city"),
        country=table.text("country", pattern="[A-Z]{2}", rule="must be a code of two capital letters, such as DE"),
        email=table.text_or_none("email"),
        phone=table.text_or_none("phone"),
    )


def _persons(root: Table) -> list[Person]:
    rows = root.tables("persons")
    if not rows:
        root.missing("persons")
    return [Person(row.text("name"), row.text("role")) for row in rows]


def _condition(row: Table) -> Quantity:
    name, value = row.text("name"), row.number("value")
    unit = row.choice("unit", list(CONDITION_UNITS))
    return Quantity(name, value, CONDITION_UNITS.get(unit, CONDITION_UNITS["1"]))
