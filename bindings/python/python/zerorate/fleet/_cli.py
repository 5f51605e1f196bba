"""``zerorate fleet``: many captures, one row each."""

from __future__ import annotations

import argparse
import json
import re
import sys
from typing import Any, Optional

from . import _one, _run, _table
from ._dask import Dask, dask_cluster
from ._plain import plain
from ._recipe import DEFAULT, Recipe, load
from ._run import Ended, EngineLost
from ._store import Unreachable, is_pattern

DONE, FAILED, REFUSED = 0, 1, 3
EXIT_CODES = {"ok": DONE, "refused": REFUSED}

ABOUT = """\
Analyse every capture or log of a folder, a glob or a bucket. Each file gets one row: its calibration, its noise, or
the reason why it has none.
"""

EXAMPLES = """\
examples:
  zerorate fleet run captures/ out/
  zerorate fleet table out/
  zerorate fleet report out/ -o fleet.html
  zerorate fleet run 's3://bucket/night/*.parquet' s3://bucket/rows --dask tcp://scheduler:8786
  zerorate fleet one s3://bucket/night/7.parquet s3://bucket/rows

A run that is started again does what has no row. Keys of a store come from its own settings, such as AWS_PROFILE.
"""


def main(arguments: list[str]) -> int:
    args = _parser().parse_args(arguments)
    try:
        return int(args.run(args))
    except (Unreachable, EngineLost, OSError, ValueError, ImportError) as error:
        _complain(error)
        return FAILED


def _complain(text: object) -> None:
    print(f"error: {plain(text)}", file=sys.stderr)


def _parser() -> argparse.ArgumentParser:
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser("zerorate fleet", description=ABOUT, epilog=EXAMPLES, formatter_class=plain)
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    _add_run(commands)
    one = commands.add_parser("one", help="analyse one file and print its row")
    one.add_argument("url", help="the file: a path, or an address such as s3://bucket/7.parquet")
    one.add_argument("out", help="the folder or bucket of the rows")
    _add_recipe(one)
    one.set_defaults(run=_one_file)
    table = commands.add_parser("table", help="write all rows to OUT/rows.parquet, and count them")
    table.add_argument("out", help="the folder or bucket of the rows")
    table.add_argument("--json", action="store_true", help="print the counts as one JSON object")
    table.set_defaults(run=_write_table)
    report = commands.add_parser("report", help="write a page about the population")
    report.add_argument("table", help="rows.parquet, or the folder that has it")
    report.add_argument("-o", "--output", required=True, metavar="FILE", help="the page, .html")
    report.add_argument("--group", metavar="COLUMN", help="compare groups: a column such as host or method")
    report.add_argument("--force", action="store_true", help="overwrite the page")
    report.set_defaults(run=_write_report)
    return parser


def _add_run(commands: Any) -> None:
    run = commands.add_parser("run", help="analyse every file that has no row yet")
    run.add_argument("source", help="a folder, a glob (in quotes) or a bucket")
    run.add_argument("out", help="the folder or bucket of the rows")
    _add_recipe(run)
    run.add_argument("--workers", type=_count, metavar="N", help="tasks at once [default: one for each core]")
    run.add_argument("--dask", metavar="ADDRESS", help="a Dask scheduler, tcp://…, or `local` for processes here")
    states = ["failed", "killed", "refused", "ok"]
    again = "make the rows in this state anew; give the option once for each state"
    run.add_argument("--again", action="append", default=[], choices=states, help=again)
    run.set_defaults(run=_run_all)


def _add_recipe(command: argparse.ArgumentParser) -> None:
    recipe = "a TOML file that says what is done [default: recalibrate, and allan --fit]"
    command.add_argument("--recipe", metavar="FILE", help=recipe)
    memory = "memory that all tasks may take together, such as 8G [default: half of the machine's]"
    command.add_argument("--max-memory", type=_size, metavar="SIZE", help=memory)


def _count(text: str) -> int:
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text} is not a whole number above 0")
    return int(text)


def _size(text: str) -> int:
    found = re.fullmatch(r"(\d+(?:\.\d+)?)([KMGT]?)(?:i?B)?", text.strip(), re.IGNORECASE)
    if not found:
        raise argparse.ArgumentTypeError(f"{text} is not a size; give one such as 500M or 8G")
    return int(float(found[1]) * 1024 ** " KMGT".index((found[2] or " ").upper()))


def _recipe(args: argparse.Namespace) -> Recipe:
    return load(args.recipe) if args.recipe else DEFAULT


def _run_all(args: argparse.Namespace) -> int:
    engine: Optional[Dask] = dask_cluster(args.dask, args.workers) if args.dask else None
    try:
        ended = _run.run(
            args.source,
            args.out,
            _recipe(args),
            engine,
            workers=args.workers,
            max_memory=args.max_memory,
            again=args.again,
            show_progress=True,
        )
    finally:
        if engine:
            engine.close()
    return _say_ended(ended, args.source, args.out)


def _say_ended(ended: Ended, source: str, out: str) -> int:
    for url, what in ended.not_files.items():
        print(f"warning: {plain(url)} has no row: it is {what}, and not a file", file=sys.stderr)
    if not ended.states and not ended.undone:
        _complain(_why_nothing(ended, source))
        return FAILED
    there = ended.states.pop("there", 0)
    rows = ", ".join(f"{count} {state}" for state, count in sorted(ended.states.items())) or "nothing to do"
    left_out = f"; not logs by their names: {ended.left_out}" if ended.left_out else ""
    print(f"{rows} in {ended.seconds:.1f} s; {there} had a row before{left_out}")
    for url, why in list(ended.undone.items())[:20]:
        _complain(f"{url} has no row: {why}")
    if ended.undone:
        _complain(f"{len(ended.undone)} files have no row; run the same command again")
        return FAILED
    print(f"`zerorate fleet table {plain(out)}` makes one table of all rows")
    return DONE


def _why_nothing(ended: Ended, source: str) -> str:
    if ended.left_out:
        return f"{source} holds no log; not logs by their names: {ended.left_out}"
    return f"no file fits {source}" if is_pattern(source) else f"{source} holds no file"


def _one_file(args: argparse.Namespace) -> int:
    try:
        row = _one.one(args.url, args.out, _recipe(args), max_memory=args.max_memory)
    except _one.NotEnoughMemory as error:
        _complain(f"{args.url} has no row: {error}")
        return FAILED
    except _one.Replaced:
        _complain(f"{args.url} has no row: it changed while it was read; start again")
        return FAILED
    print(json.dumps(row, ensure_ascii=False, indent=1))
    return EXIT_CODES.get(str(row["state"]), FAILED)


def _write_table(args: argparse.Namespace) -> int:
    counts = _table.table(args.out)
    if not counts.rows:
        _complain(f"{args.out} has no rows; `zerorate fleet run SOURCE {args.out}` makes them")
        return FAILED
    if args.json:
        reasons = [dict(zip(("state", "code", "count", "url", "error"), reason)) for reason in counts.reasons]
        found = {"rows": counts.rows, "states": counts.states, "reasons": reasons}
        print(json.dumps(found, ensure_ascii=False, indent=1))
        return DONE
    print(f"{plain(args.out.rstrip('/'))}/{_table.TABLE}: {counts.rows} rows")
    for state, count in counts.states.items():
        print(f"{count:8} {state}")
    for state, code, count, url, error in counts.reasons:
        print(f"{count:8} {state}: {plain(code)}\n         {plain(url)}: {plain(error)}")
    return DONE


def _write_report(args: argparse.Namespace) -> int:
    from . import _report

    _report.write(args.table, args.output, group=args.group, force=args.force)
    print(f"{plain(args.output)}: written")
    return DONE
