"""The command line tool: ``zerorate …`` or ``python -m zerorate …``.

The program itself is native. Three commands exist only in this package: ``fleet``, ``line`` and ``certificate``.
"""

from __future__ import annotations

import importlib
import signal
import sys

from . import _zerorate

# The module of each command that is written in Python, which is also the name of its extra.
COMMANDS = ("fleet", "line", "certificate")


def main() -> int:
    """Runs the command line of this process. Returns the exit code: 0 done, 1 failed, 2 usage, 3 refused."""
    command = sys.argv[1] if len(sys.argv) > 1 else None
    if command in COMMANDS:
        return run_module(command, sys.argv[2:])
    # Python only notes a Ctrl-C until its next instruction, and none comes while the command runs.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _zerorate.main(["zerorate", *sys.argv[1:]])


def run_module(command: str, arguments: list[str]) -> int:
    """Runs a command of Python; where its libraries are missing, says how to install them."""
    try:
        module = importlib.import_module(f"zerorate.{command}._cli")
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("zerorate"):
            raise
        print(f"error: `zerorate {command}` needs {error.name}: pip install 'zerorate[{command}]'", file=sys.stderr)
        return 1
    try:
        return int(module.main(arguments))
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
