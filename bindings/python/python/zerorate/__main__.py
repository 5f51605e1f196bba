"""The command line tool: ``zerorate …`` or ``python -m zerorate …``."""

import signal
import sys

from . import _zerorate


def main() -> int:
    """Runs the command line of this process. Returns the exit code: 0 done, 1 failed, 2 usage, 3 refused."""
    # Python only notes a Ctrl-C until its next instruction, and none comes while the command runs.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _zerorate.main(["zerorate", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
