"""A PostgreSQL server of the tests' own, on a socket in a temporary folder."""

from __future__ import annotations

import glob
import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any


def find_program(name: str) -> str | None:
    """A program of PostgreSQL, in PATH or where Debian puts it."""
    debian = sorted(glob.glob(f"/usr/lib/postgresql/*/bin/{name}"), reverse=True)
    return shutil.which(name) or (debian[0] if debian else None)


@dataclass
class Server:
    """A running server. PostgreSQL refuses to run as root, so it then runs as a user without rights."""

    folder: Path
    process: subprocess.Popen[bytes] | None = None
    schemas: int = 0

    def start(self) -> None:
        """Starts the server, and waits until it answers."""
        data, log = self.folder / "data", self.folder / "log"
        initdb = [self.program("initdb"), "-D", str(data), "-U", "line", "-A", "trust", "--no-sync"]
        initdb += ["--encoding=UTF8", "--locale=C.UTF-8"]
        subprocess.run(initdb, check=True, stdout=subprocess.DEVNULL, cwd="/", **self.as_user())
        postgres = [self.program("postgres"), "-D", str(data), "-k", str(self.folder), "-c", "listen_addresses="]
        postgres.append("-F")  # the tests cut no power, and need not wait for the disk
        with log.open("wb") as output:
            self.process = subprocess.Popen(postgres, stdout=output, stderr=output, cwd="/", **self.as_user())
        last = time.monotonic() + 30
        while b"ready to accept" not in log.read_bytes():
            if self.process.poll() is not None or time.monotonic() > last:
                raise RuntimeError(log.read_text())
            time.sleep(0.05)

    def database(self) -> str:
        """The address of a new schema, which is as good as a database of its own, and is made and removed faster."""
        import psycopg

        self.schemas += 1
        name = f"line{self.schemas}"
        with psycopg.connect(f"host={self.folder} user=line dbname=postgres", autocommit=True) as connection:
            connection.execute(f"CREATE SCHEMA {name}".encode())
        return f"postgresql://line@/postgres?host={self.folder}&options=-csearch_path%3D{name}"

    def stop(self) -> None:
        """Stops the server, and removes its files."""
        if self.process is not None:
            self.process.send_signal(signal.SIGQUIT)
            self.process.wait(timeout=30)
        shutil.rmtree(self.folder, ignore_errors=True)

    def program(self, name: str) -> str:
        """The path of a program that is there."""
        found = find_program(name)
        assert found is not None
        return found

    def as_user(self) -> dict[str, Any]:
        """The user to run as, for `subprocess`."""
        if os.geteuid() != 0:
            return {}
        user = server_user()
        assert user is not None
        return {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}


def server_user() -> pwd.struct_passwd | None:
    """A user without rights."""
    for name in ("postgres", "nobody"):
        try:
            return pwd.getpwnam(name)
        except KeyError:
            continue
    return None


def why_not() -> str | None:
    """Why no server can run here; None if one can."""
    missing = [name for name in ("initdb", "postgres") if find_program(name) is None]
    if missing:
        return f"no {' and no '.join(missing)} in PATH or /usr/lib/postgresql"
    if os.geteuid() == 0 and server_user() is None:
        return "PostgreSQL does not run as root, and there is neither a user postgres nor nobody"
    try:
        import psycopg  # noqa: F401
    except ImportError as error:
        return f"PostgreSQL's driver is not usable: {error}"
    return None


def make_server() -> Server:
    """A server that runs. The folder's name is short: a socket's path has 107 characters at most."""
    folder = Path(tempfile.mkdtemp(prefix="zr-pg-", dir="/tmp"))
    user = server_user()
    if os.geteuid() == 0 and user is not None:
        os.chown(folder, user.pw_uid, user.pw_gid)
    server = Server(folder)
    try:
        server.start()
    except BaseException:
        server.stop()
        raise
    return server
