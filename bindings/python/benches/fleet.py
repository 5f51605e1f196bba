"""``cargo xtask bench-fleet``: times `zerorate.fleet` against a plain loop over the same commands.

Loop and fleet are timed one after the other, three times. The printed ratio is that of their best times.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Callable, Optional

from zerorate import fleet
from zerorate.fleet import Recipe, _one, _program, _store

PLAN = ("--average", "2s", "--warmup", "60s", "--settle", "20s", "--offset", "5s")
RECIPE = Recipe(recalibrate=PLAN)
ROUNDS = 3
# Runs a command and prints its peak memory, KiB.
PEAK = """
import resource, subprocess, sys
quiet = subprocess.DEVNULL
subprocess.run(sys.argv[1:], stdout=quiet, stderr=quiet)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


def main() -> None:
    """Prints the figures of docs/reference/fleet.md."""
    parser = argparse.ArgumentParser()
    parser.add_argument("program", help="the native program")
    parser.add_argument("--captures", type=int, default=200)
    args = parser.parse_args()
    os.environ["ZERORATE_PROGRAM"] = args.program
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "captures"
        source.mkdir()
        for seed in range(args.captures):
            record(args.program, source / f"unit{seed}.arrows", seed)
        size = sum(path.stat().st_size for path in source.iterdir()) / args.captures
        print(f"{args.captures} captures of {size / 1e6:.1f} MB, {os.cpu_count()} cores")
        for workers in (1, 2):
            compare(args.program, source, workers, None)
        engine = fleet.dask_cluster("local", 2)
        compare(args.program, source, 2, engine)
        engine.close()
        for name, make in (("threads", None), ("Dask", fleet.dask_cluster)):
            overhead(source, name, make)
    memory(args.program)


def record(program: str, path: Path, seed: int) -> None:
    """Records a capture of a simulated sensor: 89 s, thinned by a divider."""
    twin = ["--device", f"twin:seed={seed}", "--divider", "20", "--serial", f"SN{seed}"]
    command = [program, "calibrate", *twin, *PLAN, "--log", str(path), "--no-save"]
    subprocess.run(command, capture_output=True)  # about one of fifty is refused; the fleet handles that file as well


def loop(program: str, source: Path, workers: int) -> float:
    """Returns the seconds that the two commands take on all files, in `workers` threads."""

    def both(path: Path) -> None:
        for words in (["recalibrate", str(path), *PLAN], ["allan", str(path), "--fit"]):
            subprocess.run([program, *words, "--json", "--max-memory", "1G"], capture_output=True)

    began = time.perf_counter()
    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(both, sorted(source.iterdir())))
    return time.perf_counter() - began


def through_fleet(source: Path, workers: int, engine: Any) -> float:
    """Returns the seconds of a run of the fleet into a new folder."""
    with tempfile.TemporaryDirectory() as out:
        ended = fleet.run(str(source), out, RECIPE, engine, workers=workers)
    files = len(list(source.iterdir()))
    assert sum(ended.states.values()) == files and not ended.undone, ended
    return ended.seconds


def compare(program: str, source: Path, workers: int, engine: Any) -> None:
    """Prints the times of fleet and loop for one engine, a line of the table in the documentation."""
    pairs = [(loop(program, source, workers), through_fleet(source, workers, engine)) for _ in range(ROUNDS)]
    plain, ours = (min(times) for times in zip(*pairs))
    name = "Dask" if engine else "threads"
    each_ms = 1e3 * (ours - plain) * workers / len(list(source.iterdir()))
    ratio = ours / plain
    print(
        f"{name}, {workers} workers: {ours:.2f} s, the loop {plain:.2f} s, ratio {ratio:.3f}; {each_ms:+.1f} ms a file"
    )


def overhead(source: Path, name: str, make: Optional[Callable[..., Any]]) -> None:
    """Prints the time per file of commands that do nothing, on one worker: the overhead of the fleet itself."""
    program = os.environ["ZERORATE_PROGRAM"]
    nothing = shutil.which("true") or "/bin/true"
    os.environ["ZERORATE_PROGRAM"] = nothing
    _program._own.cache_clear()
    engine: Any = make("local", 1) if make else None
    with tempfile.TemporaryDirectory() as out:
        ended = fleet.run(str(source), out, Recipe(recalibrate=None), engine, workers=1)
    if engine:
        engine.close()
    os.environ["ZERORATE_PROGRAM"] = program
    _program._own.cache_clear()
    print(f"{name}: {1e3 * ended.seconds / sum(ended.states.values()):.1f} ms a file whose command is `true`")


def memory(program: str) -> None:
    """Prints the peak memory of ``allan --fit`` on an hour at the full rate, and what the fleet reserves for it."""
    with tempfile.TemporaryDirectory() as folder:
        for ending in ("arrows", "parquet"):
            path = Path(folder) / f"hour.{ending}"
            capture = [program, "capture", "--device", "twin:", "--duration", "1h", "-o", str(path)]
            subprocess.run(capture, check=True, capture_output=True)
            needed = _one.needed_memory(_store.stat(str(path)))
            command = [sys.executable, "-c", PEAK, program, "allan", str(path), "--fit", "--json"]
            peak = int(subprocess.run(command, check=True, capture_output=True, text=True).stdout) << 10
            sizes = (path.stat().st_size / 1e6, peak / 1e6, needed / 1e6)
            print("an hour in {}, {:.0f} MB: {:.0f} MB at most, {:.0f} MB reserved".format(ending, *sizes))


if __name__ == "__main__":
    main()
