"""The command line ``zerorate line``."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from . import _commands
from ._errors import LineError
from ._tables import QUANTITIES

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[argparse.ArgumentParser]

DEFAULT = "sqlite:///line.db"
VARIABLE = "ZERORATE_LINE_DB"

ABOUT = """\
Keep the record of a production line: every unit, measurement, verdict and certificate

The record is a database. Rows are added, and never changed or removed: triggers refuse it, and a chain of hashes
shows what was done behind them."""

EXAMPLES = """\
examples:
  zerorate line add unit.toml --capture unit.arrows --limits limits.toml
  zerorate line station --device bridge:/dev/ttyACM0 --limits limits.toml
  zerorate line spc pbc_dps --limits limits.toml -o chart.svg
  zerorate line verify --files"""

STATION_EXAMPLES = """\
The options of `zerorate calibrate` stand behind --. The exit code is 0 if all units passed, 1 if one did not or could
not be measured, and otherwise 3 if one was refused.

examples:
  zerorate line station --device bridge:/dev/ttyACM0 --device bridge:/dev/ttyACM1 --limits limits.toml
  zerorate line station --device twin:seed=7 --limits limits.toml --once -- --average 5s --warmup 1m --settle 2m"""


def main(arguments: list[str]) -> int:
    """Runs a command. Returns the exit code: 0 done, 1 failed, 2 usage, 3 refused."""
    own, options = split(arguments)
    try:
        given = parser().parse_args(own)
    except SystemExit as end:
        return int(end.code or 0)
    if options and given.command != "station":
        print("error: only `zerorate line station` takes options behind --", file=sys.stderr)
        return 2
    given.options = options
    try:
        return int(given.run(given))
    except LineError as error:
        print(f"error: {error}", file=sys.stderr)
    except BrokenPipeError:
        # The reader closed the pipe: nobody is left to tell, not even when Python flushes at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 1


def split(arguments: list[str]) -> tuple[list[str], list[str]]:
    """The arguments before and behind ``--``."""
    if "--" not in arguments:
        return arguments, []
    place = arguments.index("--")
    return arguments[:place], arguments[place + 1 :]


def parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    top = argparse.ArgumentParser("zerorate line", description=ABOUT, epilog=EXAMPLES, formatter_class=Formatter)
    commands = top.add_subparsers(dest="command", metavar="COMMAND", required=True)
    add_writing(commands)
    add_reading(commands)
    add_spc(commands)
    add_station(commands)
    return top


class Formatter(argparse.RawDescriptionHelpFormatter):
    """Keeps the lines of descriptions and examples."""


def command(commands: Commands, name: str, about: str, example: str) -> argparse.ArgumentParser:
    """A command with the options that all have."""
    example = f"example:\n  {example}" if "\n" not in example else example
    made = commands.add_parser(name, help=about, description=about, epilog=example, formatter_class=Formatter)
    made.set_defaults(run=getattr(_commands, f"run_{name}"))
    database = os.environ.get(VARIABLE) or DEFAULT
    text = f"the record: sqlite:///FILE or postgresql://USER@HOST/DATABASE [default: {VARIABLE}, or {DEFAULT}]"
    made.add_argument("--db", metavar="URL", default=database, help=text)
    return made


def limits_option(made: argparse.ArgumentParser, required: bool = False) -> None:
    """The option for the limits."""
    text = "limits of the quantities, a TOML file: a version, and a table for each quantity with lower, upper and rule"
    made.add_argument("--limits", metavar="FILE", type=Path, required=required, help=text)


def json_option(made: argparse.ArgumentParser) -> None:
    """The option for JSON."""
    made.add_argument("--json", action="store_true", help="print the result as JSON")


def add_writing(commands: Commands) -> None:
    """The commands that enter measurements."""
    about = "Enter the rows of `zerorate fleet run`; importing again adds nothing"
    made = command(commands, "import", about, "zerorate line import results/ --limits limits.toml")
    made.add_argument("rows", metavar="ROWS", type=Path, help="rows.parquet, or the folder that contains it")
    limits_option(made)
    about = "Enter the calibration of a unit"
    made = command(commands, "add", about, "zerorate line add unit.toml --capture unit.arrows --limits limits.toml")
    made.add_argument("file", metavar="UNIT.TOML", type=Path, help="the calibration; it states the serial number")
    text = "the capture that it was computed from; it is refused if it holds other samples"
    made.add_argument("--capture", metavar="FILE", type=Path, help=text)
    limits_option(made)

    about = "Enter the certificate of a calibration"
    made = command(commands, "certify", about, "zerorate line certify certificate.xml --pdf certificate.pdf")
    made.add_argument("dcc", metavar="CERTIFICATE.XML", type=Path, help="the XML that `zerorate certificate` wrote")
    made.add_argument("--pdf", metavar="FILE", type=Path, help="the PDF of the same certificate")
    made.add_argument("--reason", metavar="TEXT", help="why it replaces another certificate, if it does")


def add_reading(commands: Commands) -> None:
    """The commands that show the record."""
    made = command(commands, "history", "List all that was measured of a unit", "zerorate line history SN7")
    made.add_argument("serial", metavar="SN", help="serial number of the unit")
    json_option(made)
    about = "List the current result of every unit, or show all of one"
    made = command(commands, "show", about, "zerorate line show SN7 --json")
    made.add_argument("serial", metavar="SN", nargs="?", help="serial number of a unit [default: all units]")
    json_option(made)
    about = "Check the chain of entries, every row, and the files; exit code 1 if something is wrong"
    example = "zerorate line verify --files --head 3c7eae68004609ea3ab56d736355083457680aa7e9c7a7e30fca67f7308232ba"
    made = command(commands, "verify", about, example)
    text = "the head that an earlier verify printed: shows whether entries at the end were removed since"
    made.add_argument("--head", metavar="HASH", help=text)
    made.add_argument("--files", action="store_true", help="also compare captures and calibrations with their hashes")
    json_option(made)


def add_spc(commands: Commands) -> None:
    """The command for control charts."""
    about = "Draw the control chart of a quantity, with capability and signals"
    made = command(commands, "spc", about, "zerorate line spc pbc_dps --limits limits.toml -o chart.svg")
    made.add_argument("quantity", metavar="QUANTITY", choices=QUANTITIES, help=f"one of {', '.join(QUANTITIES)}")
    limits_option(made)
    made.add_argument("--part", metavar="NAME", help="kind of part, where the record has several")
    made.add_argument("--axis", metavar="NAME", help="axis, where the parts have several")
    made.add_argument("--simulated", action="store_true", help="include simulated units")
    made.add_argument("-o", "--output", metavar="FILE", type=Path, help="write the chart as .svg or .png")
    made.add_argument("--force", action="store_true", help="overwrite an existing chart")
    json_option(made)


def add_station(commands: Commands) -> None:
    """The command for a station."""
    about = "Test units: read serial numbers from a scanner or keyboard, calibrate, judge and record"
    made = command(commands, "station", about, STATION_EXAMPLES)
    text = "the device of a unit, as in `zerorate calibrate`; give it once for each place of the station"
    made.add_argument("--device", metavar="DEV", action="append", required=True, help=text)
    limits_option(made, required=True)
    made.add_argument("--station", metavar="NAME", help="name of the station, for the record")
    made.add_argument("--operator", metavar="NAME", help="who tests, for the calibration and the record")
    text = "folder for captures and calibrations [default: captures]"
    made.add_argument("--folder", metavar="DIR", type=Path, default=Path("captures"), help=text)
    made.add_argument("--once", action="store_true", help="test one unit on each device, and end")
