"""Thousands of captures and logs, one row each, on any engine that gives a ``concurrent.futures.Executor``.

==========  ==========================================================================
`run`       every file of a folder, a glob or a bucket
`one`       one file: for Slurm arrays, Snakemake, Ray, Spark and ``xargs``
`table`     all rows as one Parquet file, with their counts by state and reason
`report`    a page about the population
`Recipe`    the commands for each file
==========  ==========================================================================

Install it by ``pip install 'zerorate[fleet]'``; ``zerorate[s3]`` and ``zerorate[dask]`` add a store and an engine.
"""

from ._dask import dask_cluster
from ._one import one
from ._recipe import Recipe, load
from ._report import write as report
from ._run import Ended, EngineLost, run
from ._store import Unreachable
from ._table import Counts, table

__all__ = [
    "Counts",
    "Ended",
    "EngineLost",
    "Recipe",
    "Unreachable",
    "dask_cluster",
    "load",
    "one",
    "report",
    "run",
    "table",
]
