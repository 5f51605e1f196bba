"""Analyses one file, and writes its row."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Optional

from . import _downloads, _plain, _program, _row, _store
from ._program import Answer
from ._recipe import DEFAULT, Options, Recipe

# Number of attempts if a signal ends the command: the kernel may kill it because other programs use the memory.
TRIES = 3

# Memory of an analysis: a constant and a multiple of the file's size, by `cargo xtask bench-fleet`.
BASE_BYTES = 64 << 20
BYTES_PER_BYTE = {
    ".parquet": 11,
    ".arrows": 2,
    ".arrow": 2,
    ".feather": 2,
    ".mcap": 2,
    ".npy": 5,
    ".csv": 6,
    ".txt": 6,
}
BYTES_PER_UNKNOWN_BYTE = 12

# The facts that a capture states, besides its samples.
STATED = ["part", "serial", "created", "simulated", "capture_sha256"]


@dataclass(frozen=True)
class Task:
    """A task as it is sent to a worker. It holds no connection and no credentials."""

    file: _store.File
    out: str
    recipe: Recipe
    digest: str
    max_memory: int
    """Memory limit of a command, bytes."""
    program: str
    """The version of the program that the run expects on every worker."""

    @property
    def key(self) -> str:
        """The name of the row's file, without its ending."""
        return self.file.key(self.digest)


def needed_memory(file: _store.File) -> int:
    """An upper estimate of the memory that the analysis of a file takes, bytes."""
    name = file.url.rsplit("/", 1)[-1].lower()
    ending = f".{name.rsplit('.', 1)[-1]}"
    return BASE_BYTES + file.size * BYTES_PER_BYTE.get(ending, BYTES_PER_UNKNOWN_BYTE)


def one(url: str, out: str, recipe: Recipe = DEFAULT, *, max_memory: Optional[int] = None) -> dict[str, Any]:
    """Analyses one file, writes its row below `out` and returns the row. If the row exists, only returns it.

    Jobs of Slurm, Snakemake, Ray or Spark call this function, and so does ``zerorate fleet one``. `max_memory` (bytes)
    limits each command; without it, the limit follows from the size of the file. Raises OSError or
    `_store.Unreachable` if the file cannot be fetched or the row cannot be written, `NotEnoughMemory`, and `Replaced`.
    """
    _downloads.remove_left()
    try:
        file = _store.stat(url)
    except FileNotFoundError as error:
        raise _store.Unreachable(f"{url}: there is no such file") from error
    work(Task(file, out, recipe, recipe.digest(), max_memory or needed_memory(file), _program.version()))
    row: dict[str, Any] = json.loads(_store.read(_store.row_url(out, _store.stat(url).key(recipe.digest()))))
    return row


def work(task: Task) -> str:
    """Does a task, unless its row exists. Returns the state of the row."""
    url = _store.row_url(task.out, task.key)
    if _store.exists(url):
        return str(json.loads(_store.read(url))["state"])
    if _program.version() != task.program:
        raise OtherProgram(f"{socket.gethostname()} has {_program.version()}, and this run has {task.program}")
    if not _plain.is_utf8(task.file.url):
        put(task, {"state": "failed", "code": "file-name", "error": "its name is not UTF-8; give it another"})
        return "failed"
    began = time.time()
    with _downloads.folder() as folder:
        path = _store.fetch(task.file, folder)
        now = _store.stat(task.file.url)
        if now != task.file:
            raise Replaced(now)
        row = _analysed(path, task)
    row["seconds"] = time.time() - began
    put(task, row)
    return str(row["state"])


class OtherProgram(Exception):
    """A worker has another version of the program than the run."""


def nothing() -> None:
    """A worker runs this function to show that it works."""


class NotEnoughMemory(Exception):
    """The memory limit of this run is too small for the file. The text says which option to give."""


class Replaced(Exception):
    """The file changed between the listing and the analysis. `file` is the file as it is now."""

    def __init__(self, file: _store.File) -> None:
        super().__init__(file)
        self.file = file


def put(task: Task, row: dict[str, Any]) -> None:
    url = _plain.utf8(task.file.url)
    stated = {"key": task.key, "url": url, "version": task.file.version, "bytes": task.file.size}
    made = {"recipe": task.digest, "program": _program.version(), "host": socket.gethostname(), "ended": time.time()}
    complete = {**dict.fromkeys(_row.SCHEMA.names), "warnings": [], "axes": [], **stated, **made, **row}
    _store.put(_store.row_url(task.out, task.key), json.dumps(complete, sort_keys=True).encode())


def _analysed(path: str, task: Task) -> dict[str, Any]:
    """Runs the commands of the recipe, and none after one that failed or was killed. Returns the row."""
    row: dict[str, Any] = {"state": "ok", "code": "", "error": "", "warnings": [], "axes": []}
    if task.recipe.recalibrate is not None:
        _calibrated(row, path, task)
    else:
        _take_stated(row, _verdict(path, task))
    for command, options in (("allan", task.recipe.allan), ("imu", task.recipe.imu)):
        if options is not None and row["state"] in ("ok", "refused"):
            _analysis(row, command, options, path, task)
    return row


def _asked(arguments: list[str], task: Task) -> Answer:
    """Runs a command, and repeats it if a signal ended it. Returns the answer."""
    for _ in range(TRIES):
        answer = _program.ask(arguments, task.max_memory, task.recipe.timeout_s)
        if answer.state != "killed":
            break
    if answer.code == "memory":
        raise NotEnoughMemory(f"{answer.error} (--max-memory)")
    return answer


def _calibrated(row: dict[str, Any], path: str, task: Task) -> None:
    """Fills in the calibration of a capture. A log of other software has no calibration, only the later analyses."""
    answer = _asked(["recalibrate", path, *(task.recipe.recalibrate or ())], task)
    if answer.state in ("refused", "failed"):
        verdict = _verdict(path, task)
        if verdict.get("form") == "other" and (task.recipe.allan, task.recipe.imu) != (None, None):
            return
        _take_stated(row, verdict)
        answer = _diagnosed(answer, verdict)
    found = answer.found or {}
    _take(row, found, _row.SCHEMA.names)
    row["axes"] = [_only(axis, _row.AXIS_NAMES) for axis in found.get("axes", [])]
    _judge(row, answer)


def _verdict(path: str, task: Task) -> dict[str, Any]:
    files = (_asked(["verify", path], task).found or {}).get("files", [{}])
    verdict: dict[str, Any] = files[0]
    return verdict


def _take_stated(row: dict[str, Any], verdict: dict[str, Any]) -> None:
    """Fills in the facts that a capture states, if no calibration gives them. A log of other software states none."""
    created = "SIMULATED" if verdict.get("simulated") else verdict.get("created")
    _take(row, {**verdict, "created": created, "capture_sha256": verdict.get("samples_sha256")}, STATED)


def _diagnosed(answer: Answer, verdict: dict[str, Any]) -> Answer:
    """Replaces the error of a failed command by the damage of the file, if there is any."""
    if answer.state != "failed" or verdict.get("form") == "other" or not verdict.get("damage"):
        return answer
    return Answer(None, "failed", "damaged", str(verdict["damage"]))


def _analysis(row: dict[str, Any], command: str, options: Options, path: str, task: Task) -> None:
    """Fills in the noise of the record, or of each axis if the command finds several."""
    own = ["--fit", *_all_axes(row, options or ())] if command == "allan" else []
    answer = _asked([command, path, *own, *(options or ())], task)
    if answer.state == "failed":
        answer = _diagnosed(answer, _verdict(path, task))
    found = answer.found or {}
    several = found.get("axes", [])
    axes = several or [found]
    row["samples"] = row.get("samples") or axes[0].get("samples")
    row["warnings"] = [*row["warnings"], *found.get("warnings", [])]
    if len(axes) > 1:
        measured = [{**_only(axis, ["name", "kind", "unit"]), **_noise(axis)} for axis in axes]
        row["axes"] = _merged(row["axes"], measured)
    else:
        row.update(_noise(axes[0]))
    for axis in several:
        of_axis = f": {axis['name']}: " if len(several) > 1 else ": "
        row["warnings"] += [warning.replace(": ", of_axis, 1) for warning in axis.get("warnings", [])]
    _judge(row, answer)


def _all_axes(row: dict[str, Any], options: Sequence[str]) -> list[str]:
    """The option that selects all axes of a capture. For a log, the recipe says which columns are axes."""
    chooses = any(option.split("=")[0] == "--column" for option in options)
    return [] if chooses or row.get("part") is None else ["--column", "all"]


def _merged(calibrated: list[dict[str, Any]], measured: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Merges both lists by the names of the axes. The noise of axis ``x`` of a capture is listed as ``x_code``, the
    name of the column."""
    by_name = {axis["name"]: axis for axis in calibrated}
    for axis in measured:
        name = axis["name"][: -len("_code")] if axis["name"].endswith("_code") else axis["name"]
        by_name[name] = {**by_name.get(name, {}), **axis, "name": name}
    return list(by_name.values())


def _noise(record: dict[str, Any]) -> dict[str, Any]:
    """N, B and K of a record, with their intervals, and the model's error; None if the record was not fitted."""
    fit = record.get("fit") or {}
    found: dict[str, Any] = {"model_error": fit.get("model_error")}
    for name in "nbk":
        coefficient = fit.get(name) or {}
        found.update(
            {name: coefficient.get("value"), f"{name}_lo": coefficient.get("lo"), f"{name}_hi": coefficient.get("hi")}
        )
    return found


def _judge(row: dict[str, Any], answer: Answer) -> None:
    if row["state"] == "ok" and answer.state != "ok":
        row.update(state=answer.state, code=answer.code, error=answer.error)


def _take(row: dict[str, Any], found: dict[str, Any], names: list[str]) -> None:
    row.update(_only(found, [name for name in names if name not in ("axes", "version")]))


def _only(found: dict[str, Any], names: list[str]) -> dict[str, Any]:
    return {name: found[name] for name in names if found.get(name) is not None}
