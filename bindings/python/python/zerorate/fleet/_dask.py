"""Dask as an engine: ``fleet.dask_cluster("tcp://…")``, or ``"local"`` for processes of this machine."""

from __future__ import annotations

import importlib
from concurrent.futures import Executor
from typing import Any, Optional

LOCAL = "local"


class Dask:
    """Makes executors of a Dask cluster. If the scheduler was lost, the next call connects to it again."""

    def __init__(self, address: str, workers: Optional[int] = None) -> None:
        self.cluster: Any = None
        if address == LOCAL:
            self.cluster = _distributed().LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
            address = str(self.cluster.scheduler_address)
        self.address = address
        self.client: Any = None
        nodes = self._connect().scheduler_info(n_workers=-1)["workers"].values()
        if not nodes:
            raise ValueError(f"the Dask scheduler at {address} has no workers; start `dask worker {address}`")
        self.workers = sum(int(node["nthreads"]) for node in nodes)
        self.memory_bytes = self.workers * min(int(node["memory_limit"]) // int(node["nthreads"]) for node in nodes)

    def _connect(self) -> Any:
        if self.client is not None:
            self.client.close(timeout=1)
        self.client = _distributed().Client(self.address, timeout=10)
        return self.client

    def __call__(self) -> Executor:
        """Makes an executor. It runs equal tasks separately, so that they do not share one result."""
        executor: Executor = self._connect().get_executor(pure=False)
        return executor

    def close(self) -> None:
        """Leaves the cluster, and ends a local one."""
        if self.client is not None:
            self.client.close(timeout=1)
        if self.cluster is not None:
            self.cluster.close()


def _distributed() -> Any:
    try:
        return importlib.import_module("distributed")
    except ModuleNotFoundError as error:
        raise ImportError(f"Dask needs {error.name}: pip install 'zerorate[dask]'") from error


def dask_cluster(address: str = LOCAL, workers: Optional[int] = None) -> Dask:
    """Returns an engine for `run`: the Dask scheduler at `address`, or a new cluster on this machine."""
    return Dask(address, workers)
