"""What each command of ``zerorate line`` does."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import asdict
from typing import Any

from . import _listing
from ._errors import LineError
from ._limits import Limits
from ._reading import Result
from ._record import Record, open_record


def run_import(given: argparse.Namespace) -> int:
    """``import``: enters the rows of a fleet."""
    limits = load_limits(given)
    if not given.rows.exists():
        raise LineError(f"there is no {given.rows}")
    with open_record(given.db) as record:
        done = record.import_rows(given.rows, limits)
    for address in done.without_serial:
        print(f"warning: no serial number, not entered: {_listing.printable(address)}", file=sys.stderr)
    for text in done.unusable:
        print(f"warning: not entered: {_listing.printable(text)}", file=sys.stderr)
    left_out = f"{len(done.without_serial)} without a serial number, {len(done.unusable)} not usable"
    print(f"{done.added} entered, {done.known} in the record already, {left_out}")
    return 0


def run_add(given: argparse.Namespace) -> int:
    """``add``: enters a calibration."""
    limits = load_limits(given)
    if not given.file.exists():
        raise LineError(f"there is no {given.file}")
    with open_record(given.db) as record:
        added = record.add_calibration(given.file, capture=given.capture, limits=limits)
        if added is None:
            print(f"{given.file} is in the record already")
            return 0
        entered = [one for one in record.results() if one.run == added.run]
    print(_listing.listing(entered))
    if added.superseded:
        print(f"it supersedes result {', '.join(map(str, added.superseded))}")
    return 0


def run_certify(given: argparse.Namespace) -> int:
    """``certify``: enters a certificate."""
    with reading(given) as record:
        record.certify(given.dcc, pdf=given.pdf, reason=given.reason)
    print(f"{given.dcc} is entered")
    return 0


def run_history(given: argparse.Namespace) -> int:
    """``history``: all that was measured of a unit."""
    with reading(given) as record:
        found = known(record.history(given.serial), given.serial)
    print_json([as_json(one) for one in found]) if given.json else print(_listing.listing(found, marks=True))
    return 0


def run_show(given: argparse.Namespace) -> int:
    """``show``: the current results of all units, or all of one."""
    with reading(given) as record:
        if given.serial is None:
            found = latest(record.results())
        else:
            found = latest(known(record.history(given.serial), given.serial))
    if given.json:
        print_json([as_json(one) for one in found])
    elif given.serial is None:
        print(_listing.listing(found))
    else:
        print("\n\n".join(_listing.detail(one) for one in found))
    return 0


def run_spc(given: argparse.Namespace) -> int:
    """``spc``: the control chart of a quantity."""
    from ._spc import make_chart, to_json

    limits = load_limits(given)
    with reading(given) as record:
        results = record.results(given.part)
    limit = limits.limits.get(given.quantity) if limits else None
    chart = make_chart(results, given.quantity, limit, axis=given.axis, simulated=given.simulated)
    if given.output is not None:
        from ._chart import save_chart

        save_chart(chart, given.output, force=given.force)
    print_json(to_json(chart)) if given.json else print(_listing.spc(chart))
    return 0


def run_verify(given: argparse.Namespace) -> int:
    """``verify``: the chain, the rows and the files."""
    with reading(given) as record:
        found = record.verify(given.head)
        checked = record.verify_files() if given.files else []
    if given.json:
        files = [{**asdict(one.named), "state": one.state, "text": one.text} for one in checked]
        print_json({**asdict(found), "whole": not found.findings, "files": files})
    else:
        print(_listing.verification(found, checked))
    bad = [one for one in checked if one.state in ("differs", "missing")]
    return 1 if found.findings or bad else 0


def run_station(given: argparse.Namespace) -> int:
    """``station``: tests units."""
    from ._station import Station
    from ._trial import Settings

    settings = Settings(given.folder, given.options, given.station, given.operator)
    limits = Limits.load(given.limits)
    with open_record(given.db) as record:
        return Station(record, limits, settings, given.device, given.once).run()


def reading(given: argparse.Namespace) -> Record:
    """The record of a command that reads: it begins none."""
    return open_record(given.db, create=False)


def load_limits(given: argparse.Namespace) -> Limits | None:
    """The limits that were given."""
    return None if given.limits is None else Limits.load(given.limits)


def known(results: list[Result], serial: str) -> list[Result]:
    """Results of a unit; an error if there are none."""
    if not results:
        raise LineError(f"the record does not know the unit {serial}: `zerorate line show` lists all")
    return results


def latest(results: list[Result]) -> list[Result]:
    """The current results, and the runs without a result that came after them."""
    place = {(one.part, one.serial): index for index, one in enumerate(results) if one.current}
    return [
        one
        for index, one in enumerate(results)
        if one.current or (one.result is None and index > place.get((one.part, one.serial), -1))
    ]


def as_json(one: Result) -> dict[str, Any]:
    """A result as values of JSON: the fields of the run stand beside the others."""
    values = asdict(one)
    return {**values.pop("fields"), **values}


def print_json(value: object) -> None:
    """Prints a value as JSON."""
    print(json.dumps(value, indent=2, ensure_ascii=False))
