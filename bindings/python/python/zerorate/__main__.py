"""The command line tool: ``zerorate …`` or ``python -m zerorate …``.

The program itself is native. The command ``fleet`` exists only in this package.
"""

from __future__ import annotations

import os
import signal
import sys

from . import _zerorate


def main() -> int:
    """Runs this process's command line. Returns 0 done, 1 failed, 2 usage, 3 refused, 130 interrupted ``fleet``."""
    if sys.argv[1:2] == ["fleet"]:
        return run_fleet(sys.argv[2:])
    # Python handles a Ctrl-C only at its next instruction, and runs none until the native command has ended.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _zerorate.main(["zerorate", *sys.argv[1:]])


def run_fleet(arguments: list[str]) -> int:
    """Runs ``zerorate fleet``. If its libraries are missing, prints how to install them."""
    # Workers of Dask are new interpreters. From Python 3.11 on, they then import nothing from the current folder.
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        from .fleet import _cli
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("zerorate"):
            raise
        print(f"error: `zerorate fleet` needs {error.name}: pip install 'zerorate[fleet]'", file=sys.stderr)
        return 1
    try:
        return _cli.main(arguments)
    except KeyboardInterrupt:
        print("error: interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
