"""Folders for downloads. If a process is killed, the next start of any process removes its folder."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

try:
    import fcntl
except ImportError:  # Windows has no such lock, so folders of killed processes stay there.
    fcntl = None  # type: ignore[assignment]

PREFIX = "zerorate-fleet-"
LOCK = ".lock"


@contextmanager
def folder() -> Iterator[str]:
    """Makes a folder, and removes it at the end. The lock in the folder is free once this process has died."""
    path = tempfile.mkdtemp(prefix=PREFIX)
    try:
        with open(os.path.join(path, LOCK), "w") as lock:
            _try_lock(lock.fileno())
            yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)


def remove_left() -> int:
    """Removes the folders of processes that have died, and returns their number."""
    if fcntl is None:
        return 0
    root = tempfile.gettempdir()
    left = [os.path.join(root, name) for name in os.listdir(root) if name.startswith(PREFIX)]
    return sum(_remove_if_left(path) for path in left)


def _remove_if_left(path: str) -> bool:
    try:
        with open(os.path.join(path, LOCK)) as lock:
            is_left = _try_lock(lock.fileno())
    except OSError:  # the folder belongs to another user, is gone by now, or is not locked yet
        return False
    if is_left:
        shutil.rmtree(path, ignore_errors=True)
    return is_left


def _try_lock(descriptor: int) -> bool:
    if fcntl is None:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
