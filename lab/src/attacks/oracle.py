"""Reads files with PyArrow. Prints a line of JSON for each: its columns of numbers, or the reason why it is refused.

Arguments: `arrow` or `parquet`, and the files.
"""

import json
import sys

import pyarrow as pa
import pyarrow.ipc as ipc
import pyarrow.parquet as pq


def arrow(path):
    with pa.OSFile(path) as file:
        opened = ipc.open_file if file.read(6) == b"ARROW1" else ipc.open_stream
    with pa.OSFile(path) as file:
        return opened(file).read_all()


def parquet(path):
    return pq.ParquetFile(path, page_checksum_verification=True).read()


def number(value):
    """A number; `None` if it is missing or not finite."""
    value = None if value is None else float(value)
    return value if value is not None and abs(value) < float("inf") else None


def is_number(kind):
    return pa.types.is_decimal(kind) or pa.types.is_integer(kind) or pa.types.is_floating(kind)


def columns(table):
    found = [pair for pair in zip(table.column_names, table.columns) if is_number(pair[1].type)]
    return [(name, [number(value) for value in column.to_pylist()]) for name, column in found]


def main(form, *paths):
    read = {"arrow": arrow, "parquet": parquet}[form]
    for path in paths:
        try:
            answer = {"columns": columns(read(path))}
        except Exception as why:  # noqa: BLE001 (any refusal counts)
            answer = {"refused": f"{type(why).__name__}: {why}"[:300]}
        print(json.dumps(answer), flush=True)


main(*sys.argv[1:])
