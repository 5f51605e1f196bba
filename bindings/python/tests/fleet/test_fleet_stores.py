"""Rows on an object store, and Dask. No row is lost if a worker or the scheduler is killed; the tests kill them."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from fleet_helpers import RECIPE, UNITS, Wrap, held_until, in_thread, wait_for

from zerorate import fleet
from zerorate.fleet import _store

pytestmark = pytest.mark.stores


def free_port() -> int:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        return int(server.getsockname()[1])


def is_open(port: int) -> bool:
    with socket.socket() as client:
        return client.connect_ex(("127.0.0.1", port)) == 0


@pytest.fixture(scope="session")
def bucket(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a bucket on an S3 server of this machine (moto), which all tests share."""
    port = free_port()
    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)]
    server = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    settings = {
        "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}",
        "AWS_ACCESS_KEY_ID": "test",
        "AWS_SECRET_ACCESS_KEY": "test",
        "AWS_DEFAULT_REGION": "us-east-1",
        "NO_PROXY": "127.0.0.1",
    }
    os.environ.update(settings)
    wait_for(lambda: is_open(port), "the S3 server")
    import boto3

    boto3.client("s3").create_bucket(Bucket="fleet")
    yield "s3://fleet"
    server.kill()
    for name in settings:
        os.environ.pop(name, None)


def test_no_room_for_downloads(
    captures: Path, small_disk: Path, tmp_path: Path, bucket: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fsspec

    fsspec.filesystem("s3").put_file(str(captures / "unit1.arrows"), "fleet/large/unit1.arrows")
    monkeypatch.setattr(tempfile, "tempdir", str(small_disk))
    ended = fleet.run(f"{bucket}/large", str(tmp_path / "out"), RECIPE)
    assert not ended.states and ["No space left" in why for why in ended.undone.values()] == [True]
    monkeypatch.setattr(tempfile, "tempdir", None)
    assert fleet.run(f"{bucket}/large", str(tmp_path / "out"), RECIPE).states == {"ok": 1}


class Cluster:
    """A scheduler and workers of Dask, each a process."""

    def __init__(self, folder: Path) -> None:
        self.port = free_port()
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.folder = folder
        self.processes: list[subprocess.Popen[bytes]] = []

    def start(self) -> Any:
        """Begins a scheduler with two workers; returns the engine."""
        self.begin("scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-show")
        wait_for(lambda: is_open(self.port), "the scheduler")
        self.begin("worker", self.address, "--nworkers", "2", "--nthreads", "1", "--death-timeout", "60")
        until = time.monotonic() + 60
        while True:
            try:
                engine = fleet.dask_cluster(self.address)
                if engine.workers == 2:
                    return engine
                engine.close()
            except (ValueError, OSError) as error:
                assert time.monotonic() < until, f"no worker came: {error}"
            time.sleep(0.5)

    def begin(self, what: str, *words: str) -> None:
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *words, "--no-dashboard"]
        quiet = subprocess.DEVNULL
        self.processes.append(
            subprocess.Popen(command, stdout=quiet, stderr=quiet, cwd=self.folder, start_new_session=True)
        )

    def kill_scheduler(self) -> None:
        self.processes[0].kill()
        self.processes[0].wait()

    def end(self) -> None:
        for process in self.processes:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@pytest.fixture()
def dask(tmp_path: Path) -> Iterator[Cluster]:
    cluster = Cluster(tmp_path)
    yield cluster
    cluster.end()


def test_a_lost_scheduler_and_a_replaced_object(
    dask: Cluster, bucket: str, captures: Path, tmp_path: Path, wrapped: Wrap
) -> None:
    """The rows are on an object store. The scheduler is killed during the run, and started again with new workers."""
    import fsspec

    wrapped(held_until(tmp_path / "go"))

    store = fsspec.filesystem("s3", use_listings_cache=False)
    for path in captures.iterdir():
        store.put_file(str(path), f"fleet/night/{path.name}")
    out = f"{bucket}/rows"
    engine = dask.start()
    wait = in_thread(lambda: fleet.run(f"{bucket}/night", out, RECIPE, engine))
    wait_for(lambda: len(_store.row_paths(out)) == 1, "the first row")
    dask.kill_scheduler()
    (tmp_path / "go").touch()
    dask.start().close()
    ended = wait()
    engine.close()
    assert not ended.undone and sum(ended.states.values()) == UNITS
    assert fleet.table(out).states == {"ok": UNITS}
    store.put_file(str(captures / "unit1.arrows"), "fleet/night/unit2.arrows")
    assert fleet.run(f"{bucket}/night", out, RECIPE).states == {"there": UNITS - 1, "ok": 1}


def test_workers_of_dask_that_are_killed(dask: Cluster, captures: Path, tmp_path: Path, wrapped: Wrap) -> None:
    """One file kills every worker that reads it. All other files get their rows."""
    wrapped('case "$*" in *unit5*) kill -KILL $PPID; sleep 5;; esac')
    engine = dask.start()
    ended = fleet.run(str(captures), str(tmp_path / "out"), RECIPE, engine)
    engine.close()
    assert (ended.states, ended.undone) == ({"ok": UNITS - 1, "killed": 1}, {})
