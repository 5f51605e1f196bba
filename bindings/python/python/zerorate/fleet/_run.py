"""Runs the tasks for all files of a source, on an engine that may lose workers or its scheduler, or fail.

Each task writes its own row. So the engine keeps no results, and a task that runs twice leaves one row. A new start
does only the tasks without a row. The driver sends the tasks, and receives only the state of each row.
"""

from __future__ import annotations

import concurrent.futures as futures
import os
import time
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Callable, Optional, Union

from . import _downloads, _one, _program, _store, _table
from ._one import NotEnoughMemory, Replaced, Task
from ._progress import Progress
from ._recipe import DEFAULT, Recipe

# Number of attempts for a task that raises an exception (a full disk, a store that does not answer).
TRIES = 3
# A task is given up after this number of workers died, each while it ran only this task.
DEATHS = 2
# The run ends if a lost engine cannot be reached within this time, s, or if the engine is lost more than this many
# times in a row without a finished task in between.
PATIENCE_S = 120.0
LOSSES = 5

# File extensions of files that are not logs: calibrations, recipes, reports, pictures, unfinished files.
NOT_LOGS = (".toml", ".json", ".yaml", ".yml", ".html", ".svg", ".png", ".pdf", ".md", ".part")

Engine = Union[Executor, Callable[[], Executor]]


@dataclass
class Ended:
    """The outcome of a run."""

    states: dict[str, int] = field(default_factory=dict)
    """Number of rows in each state. ``there`` counts the files that had a row before."""
    undone: dict[str, str] = field(default_factory=dict)
    """Addresses of files without a row, each with the reason. Another run analyses these files."""
    left_out: int = 0
    """Number of files that are not logs by their names: calibrations, reports, pictures, hidden files."""
    not_files: dict[str, str] = field(default_factory=dict)
    """What has the name of a log and is no file, by address, in words: a pipe, a device, a link to a folder."""
    seconds: float = 0.0

    def count(self, state: str, more: int = 1) -> None:
        self.states[state] = self.states.get(state, 0) + more


class EngineLost(Exception):
    """The engine cannot be reached again. Rows that were written stay."""


def run(
    source: str,
    out: str,
    recipe: Recipe = DEFAULT,
    executor: Optional[Engine] = None,
    *,
    workers: Optional[int] = None,
    max_memory: Optional[int] = None,
    again: Iterable[str] = (),
    show_progress: bool = False,
) -> Ended:
    """Analyses every file of `source` that has no row below `out` yet.

    `source` is a folder, a glob or a bucket (``s3://…``, any address of fsspec), and `out` a folder or bucket.
    `executor` is an Executor or, for an engine that breaks when a worker dies, a function that makes one. Without it,
    threads of this process each start the native program. `workers` is the number of tasks at once, and `max_memory`
    (bytes) the memory of all of them together [default: the executor's ``memory_bytes``, or half of the machine's].
    Rows in the states of `again`, such as ``failed``, are made anew.
    """
    began = time.monotonic()
    _downloads.remove_left()
    _program.resume()
    workers = workers or getattr(executor, "workers", None) or os.cpu_count() or 1
    budget = max_memory or getattr(executor, "memory_bytes", None) or _half_of_memory()
    tasks, ended = _tasks(source, out, recipe, set(again))
    with Progress(len(tasks), show_progress) as progress:
        driver = _Driver(executor, workers, budget, ended, progress)
        try:
            driver.work_through(tasks)
        except BaseException:
            _program.stop()
            raise
    ended.seconds = time.monotonic() - began
    return ended


def _tasks(source: str, out: str, recipe: Recipe, again: set[str]) -> tuple[list[Task], Ended]:
    """Makes a task for each file without a row, and counts the other files. Removes the rows to be made anew."""
    digest, program, ended = recipe.digest(), _program.version(), Ended()
    listed, own = _store.find(source), _store.inside(out)
    found = [file for file in listed.files if not file.url.startswith(own)]
    files = [file for file in found if _may_be_log(file.url)]
    ended.left_out = len(found) - len(files)
    ended.not_files = {url: what for url, what in listed.others.items() if _may_be_log(url)}
    tasks = [Task(file, out, recipe, digest, _one.needed_memory(file), program) for file in files]
    there = _table.keys(out)
    if again:
        anew = _table.keys_in_state(out, again) & {task.key for task in tasks}
        _table.forget(out, anew)
        there -= anew
    todo = [task for task in tasks if task.key not in there]
    if len(todo) < len(tasks):
        ended.count("there", len(tasks) - len(todo))
    return todo, ended


def _may_be_log(url: str) -> bool:
    name = url.rsplit("/", 1)[-1].lower()
    return not name.startswith(".") and not name.endswith(NOT_LOGS)


def _half_of_memory() -> int:
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2
    except (AttributeError, ValueError, OSError):
        return 4 << 30


class _WorkerDied(Exception):
    """The engine failed because a worker died. Each running task may be the cause."""


class _Lost(Exception):
    """The engine is gone, and no task is the cause."""


class _Driver:
    """Sends tasks to an engine, and handles their ends."""

    def __init__(self, engine: Optional[Engine], workers: int, budget: int, ended: Ended, progress: Progress) -> None:
        self.engine = engine
        self.workers = workers
        self.budget = budget
        self.ended = ended
        self.progress = progress
        self.tries: dict[str, int] = {}
        self.suspects: list[Task] = []
        self.losses = 0

    def work_through(self, tasks: list[Task]) -> None:
        """Does all tasks. Tasks during which a worker died are repeated last, one at a time."""
        todo = [self._limited(task) for task in tasks]
        while todo:
            todo = self._round(todo)
        for suspect in self.suspects:
            self._alone(suspect)

    def _limited(self, task: Task) -> Task:
        """Sets the memory limit of a task: its share, or without an engine its need if that is larger."""
        share = self.budget // self.workers
        needs = min(task.max_memory, self.budget) if self.engine is None else 0
        return replace(task, max_memory=max(share, needs))

    def _round(self, todo: list[Task]) -> list[Task]:
        """Works through tasks until the engine fails. Returns the tasks that are left for a new engine."""
        waiting = deque(todo)
        pending: dict[Future[str], Task] = {}
        try:
            with self._pool() as pool:
                while waiting or pending:
                    self._send(pool, waiting, pending)
                    for future in futures.wait(pending, return_when=futures.FIRST_COMPLETED).done:
                        task = pending[future]
                        waiting.extend(self._settle(task, future))
                        del pending[future]
        except _WorkerDied as error:
            if isinstance(self.engine, Executor):
                raise EngineLost("the executor broke with a worker; give a function that makes one") from error
            if not pending:
                self._count_loss()
            self.suspects += pending.values()
        except _Lost:
            self._count_loss()
            waiting.extend(pending.values())
        finally:
            for future in pending:
                future.cancel()
        return list(waiting)

    def _send(self, pool: Executor, waiting: deque[Task], pending: dict[Future[str], Task]) -> None:
        # An external engine has a queue, which must not run empty. Threads of this process take the next task at once.
        most = self.workers if self.engine is None else max(4 * self.workers, 16)
        while waiting and len(pending) < most:
            taken = sum(task.max_memory for task in pending.values())
            if self.engine is None and pending and taken + waiting[0].max_memory > self.budget:
                return
            try:
                future = pool.submit(_one.work, waiting[0])
            except futures.BrokenExecutor as error:
                raise _WorkerDied from error
            except Exception as error:
                raise _Lost from error
            pending[future] = waiting.popleft()

    def _settle(self, task: Task, future: Future[str]) -> list[Task]:
        """Counts a task that has ended. Returns the task to repeat, if any."""
        try:
            self._done(future.result())
        except futures.CancelledError as error:
            raise _Lost from error
        except futures.BrokenExecutor as error:
            raise _WorkerDied from error
        except Replaced as error:
            return self._again(task, replace(task, file=error.file), "it changes while it is read")
        except NotEnoughMemory as error:
            self._undone(task, str(error))
        except Exception as error:
            if type(error).__name__ == "KilledWorker":  # an exception of Dask, which need not be imported
                self.suspects.append(task)
                return []
            return self._again(task, task, f"{type(error).__name__}: {error}")
        return []

    def _done(self, state: str) -> None:
        self.losses = 0
        self.ended.count(state)
        self.progress.advance()

    def _again(self, failed: Task, next_try: Task, why: str) -> list[Task]:
        url = failed.file.url
        self.tries[url] = self.tries.get(url, 0) + 1
        if self.tries[url] < TRIES:
            return [next_try]
        self._undone(failed, why)
        return []

    def _undone(self, task: Task, why: str) -> None:
        self.ended.undone[task.file.url] = why
        self.progress.advance()

    def _alone(self, task: Task) -> None:
        """Runs one task while nothing else runs, so that it must be the cause if the worker dies."""
        deaths, todo = 0, [task]
        while todo and deaths < DEATHS:
            self.suspects = []
            todo = self._round(todo)
            if self.suspects:
                deaths, todo = deaths + 1, [task]
        if todo:
            self._probe()
            reason = f"the worker died {deaths} times while it did nothing but this file"
            _one.put(task, {"state": "killed", "code": "worker-died", "error": reason})
            self._done("killed")

    def _probe(self) -> None:
        """Runs an empty task. Raises `EngineLost` if it fails, because then the engine is at fault and not a file."""
        try:
            with self._pool() as pool:
                pool.submit(_one.nothing).result()
        except Exception as error:
            why = 'the workers die before they begin; does a script of yours lack `if __name__ == "__main__":`?'
            raise EngineLost(why) from error

    def _count_loss(self) -> None:
        self.losses += 1
        if self.losses > LOSSES:
            raise EngineLost("the engine was lost again and again with no task done; look at its log, and start again")

    @contextmanager
    def _pool(self) -> Iterator[Executor]:
        """Yields an executor. One that was made here is closed at the end, without waiting for running tasks."""
        if isinstance(self.engine, Executor):
            yield self.engine
            return
        pool = self._made()
        try:
            yield pool
        finally:
            pool.shutdown(wait=False)

    def _made(self) -> Executor:
        if self.engine is None:
            return futures.ThreadPoolExecutor(self.workers, "zerorate-fleet")
        assert not isinstance(self.engine, Executor)
        until = time.monotonic() + PATIENCE_S
        while True:
            try:
                return self.engine()
            except Exception as error:
                if time.monotonic() > until:
                    raise EngineLost(f"the engine cannot be reached: {error}") from error
                time.sleep(1.0)
