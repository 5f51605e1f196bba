"""Runs the native program in its own process, so that a crash becomes a row and does not kill the worker."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass
from functools import cache
from typing import Any, Optional

from .. import _zerorate

# Loads the extension alone. The package would also load NumPy, which takes longer than the analysis of a small file.
LAUNCH = """
import sys, importlib.util
spec = importlib.util.spec_from_file_location("zerorate._zerorate", sys.argv[1])
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
sys.exit(module.main(["zerorate", *sys.argv[2:]]))
"""

# Runs a command as the child of the process $1, or not at all. The shell reads its PPID after `setpriv` has asked the
# kernel for the kill, so that a parent that dies in between is noticed too.
AS_CHILD = '[ "$PPID" = "$1" ] && shift && exec "$@"'

# The environment variable with another program to run: a native `zerorate` starts 30 ms sooner.
VARIABLE = "ZERORATE_PROGRAM"

# How the program begins the warning that a recording was not closed.
TORN = "warning: torn-tail: "

# Smallest memory limit that the program accepts, bytes.
LEAST_MEMORY = 256 << 20


class Stopped(Exception):
    """The run was stopped. Its unfinished tasks have no row."""


@dataclass(frozen=True)
class Answer:
    found: Optional[dict[str, Any]]
    """The JSON object that the command printed; None if it printed none."""
    state: str
    """``ok``, ``refused``, ``failed`` or ``killed``."""
    code: str = ""
    error: str = ""


_running: set[subprocess.Popen[str]] = set()
_stopping = threading.Event()


def stop() -> None:
    """Ends all commands of this process, and lets none begin until `resume`."""
    _stopping.set()
    for process in list(_running):
        process.kill()


def resume() -> None:
    _stopping.clear()


@cache
def version() -> str:
    done = subprocess.run([*_command(), "--version"], capture_output=True, text=True, check=True)
    return done.stdout.strip()


@cache
def asked_for_part(name: str) -> Optional[dict[str, Any]]:
    """The data-sheet values of a part in the program's catalogue; None if the part is not in the catalogue."""
    done = subprocess.run([*_command(), "parts", name, "--json"], capture_output=True, text=True)
    parts = (_object(done.stdout) or {}).get("parts", [])
    return parts[0] if done.returncode == 0 and parts else None


def ask(arguments: list[str], max_memory: int, timeout_s: float) -> Answer:
    """Runs a command with ``--json``. Raises `Stopped` if the run is stopped before or meanwhile."""
    if _stopping.is_set():
        raise Stopped
    limited = [*arguments, "--json", "--max-memory", f"{max(max_memory, LEAST_MEMORY) >> 20}M"]
    # The command has its own session, so that Ctrl-C does not reach it: an interrupted command looks like a failure.
    process = subprocess.Popen(
        [*_command(), *limited],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        errors="replace",
        start_new_session=True,
    )
    _running.add(process)
    if _stopping.is_set():  # the run was stopped after the first check
        process.kill()
    try:
        stdout, stderr = process.communicate(timeout=timeout_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return Answer(None, "failed", "timeout", f"`{arguments[0]}` took longer than {timeout_s:g} s")
    except BaseException:
        process.kill()
        raise
    finally:
        _running.discard(process)
    if _stopping.is_set():
        raise Stopped
    return _answer(arguments[0], process.returncode, stdout, stderr)


def _answer(command: str, code: int, stdout: str, stderr: str) -> Answer:
    if code < 0:
        name = signal.Signals(-code).name
        said = stderr.strip()[-200:] or "nothing"
        return Answer(None, "killed", name, f"`{command}` was ended by {name}, and said: {said}")
    found = _object(stdout)
    if code == 0 and found is not None:
        return Answer(found, "ok")
    lines = stderr.splitlines()
    said = next((line for line in lines if line.startswith(("error: ", "refused: "))), stderr.strip()[-300:])
    named = next((line.split()[1] for line in lines if line.startswith("code: ") and len(line.split()) > 1), "")
    state = "refused" if code == 3 else "failed"
    reason = said.split(": ", 1)[-1] if said.startswith(("error: ", "refused: ")) else said
    reason = reason or f"`{command}` ended with {code} and said nothing"
    torn = next((line.removeprefix(TORN) for line in lines if line.startswith(TORN)), "")
    if torn and not named:
        named, reason = "torn-tail", f"{reason} ({torn})"
    return Answer(found, state, named or _code(reason, code), reason)


def _code(reason: str, code: int) -> str:
    return "memory" if "of max_memory" in reason else {2: "usage"}.get(code, f"exit-{code}")


def _object(text: str) -> Optional[dict[str, Any]]:
    try:
        found = json.loads(text)
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


def _command() -> tuple[str, ...]:
    # If this process is killed, the kernel kills its command as well.
    guard = shutil.which("setpriv") if sys.platform == "linux" else None
    shell = ("/bin/sh", "-c", AS_CHILD, "sh", str(os.getpid()))
    return (guard, "--pdeathsig", "KILL", "--", *shell, *_own()) if guard else _own()


@cache
def _own() -> tuple[str, ...]:
    other = os.environ.get(VARIABLE)
    return (other,) if other else (sys.executable, "-I", "-S", "-c", LAUNCH, str(_zerorate.__file__))
