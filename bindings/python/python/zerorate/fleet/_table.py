"""All rows of a folder: JSON files that the tasks wrote, and Parquet parts into which many of them were packed."""

from __future__ import annotations

import io
import json
from collections import Counter
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any, Optional

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from . import _store
from ._row import SCHEMA

TABLE = "rows.parquet"
PARTS = "parts"
# Number of row files from which on they are packed into Parquet parts. To list a million files takes 1000 requests.
PACK_FROM = 10_000
ROWS_IN_PART = 20_000


@dataclass
class Counts:
    """Counts of the rows in a table."""

    rows: int = 0
    states: dict[str, int] = field(default_factory=dict)
    reasons: list[tuple[str, str, int, str, str]] = field(default_factory=list)
    """Each reason why rows are not ``ok``, the most frequent first: state, code, count, and the address and error text
    of an example."""


def table(out: str, *, pack_from: int = PACK_FROM) -> Counts:
    """Writes all rows to ``rows.parquet`` in `out`, sorted by address, and counts them.

    If at least `pack_from` rows have files of their own, these rows are packed into parts first.
    """
    if len(_store.row_paths(out)) >= pack_from:
        _pack(out)
    rows = read(out).sort_by([("url", "ascending"), ("ended", "ascending")])
    _store.put(f"{out.rstrip('/')}/{TABLE}", _parquet(rows))
    return _counts(rows)


def read(out: str) -> pa.Table:
    """Reads all rows. If a row was made again, only the newer one is returned."""
    loose = [json.loads(data) for some in _store.contents(out, _store.row_paths(out)) for data in some.values()]
    parts = [pq.read_table(io.BytesIO(data)).cast(SCHEMA) for data in _part_contents(out)]
    rows = pa.concat_tables([*parts, _arrow(loose)])
    last = {key: index for index, key in enumerate(rows.column("key").to_pylist())}
    return rows if len(last) == len(rows) else rows.take(pa.array(sorted(last.values())))


def keys(out: str) -> set[str]:
    loose = {path.rsplit("/", 1)[-1][: -len(".json")] for path in _store.row_paths(out)}
    packed = (pq.read_table(io.BytesIO(data), columns=["key"]).column("key") for data in _part_contents(out))
    return loose.union(*(column.to_pylist() for column in packed))


def keys_in_state(out: str, states: set[str]) -> set[str]:
    rows = read(out)
    chosen = rows.filter(pc.is_in(rows.column("state"), value_set=pa.array(sorted(states), pa.string())))
    return set(chosen.column("key").to_pylist())


def forget(out: str, unwanted: set[str]) -> None:
    """Removes the files of rows, so that the rows are made anew. A packed row stays until a newer one replaces it."""
    for path in _store.row_paths(out):
        if path.rsplit("/", 1)[-1][: -len(".json")] in unwanted:
            _store.remove_path(out, path)


def _pack(out: str) -> None:
    """Packs row files into parts, and removes the files of a part when it is written."""
    paths = _store.row_paths(out)
    first_part = len(_store.part_paths(out, PARTS))
    for number, first in enumerate(range(0, len(paths), ROWS_IN_PART), first_part):
        some = paths[first : first + ROWS_IN_PART]
        rows = _arrow([json.loads(data) for piece in _store.contents(out, some) for data in piece.values()])
        _store.put(f"{out.rstrip('/')}/{PARTS}/part-{number:05}.parquet", _parquet(rows))
        for path in some:
            _store.remove_path(out, path)


def _part_contents(out: str) -> list[bytes]:
    paths = _store.part_paths(out, PARTS)
    return [data for some in _store.contents(out, paths, together=8) for _, data in sorted(some.items())]


def _parquet(rows: pa.Table) -> bytes:
    sink = io.BytesIO()
    pq.write_table(rows, sink, compression="zstd")
    return sink.getvalue()


def _arrow(rows: list[dict[str, Any]]) -> pa.Table:
    return pa.Table.from_pylist([{**row, "ended": _time(row.get("ended"))} for row in rows], schema=SCHEMA)


def _time(seconds: Optional[float]) -> Optional[datetime]:
    return None if seconds is None else datetime.fromtimestamp(seconds, timezone.utc)


def _counts(rows: pa.Table) -> Counts:
    columns = (rows.column(name).to_pylist() for name in ("state", "code", "url", "error"))
    seen: Counter[tuple[str, str]] = Counter()
    example: dict[tuple[str, str], tuple[str, str]] = {}
    for state, code, url, error in zip(*columns):
        seen[state, code or ""] += 1
        example.setdefault((state, code or ""), (url, error or ""))
    reasons = [(*reason, count, *example[reason]) for reason, count in seen.most_common() if reason[0] != "ok"]
    states: Counter[str] = Counter(rows.column("state").to_pylist())
    return Counts(len(rows), dict(states.most_common()), reasons)
