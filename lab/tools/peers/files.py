"""Makes logs of noise for `cargo xtask bench-peers`, and analyses them with polars or NumPy, then allantools.

`files.py make FOLDER ROWS` writes one.csv, seven.csv, seven.parquet and one.npy. `files.py FILE COLUMN,…` reads
columns and prints their overlapping Allan deviations at octaves. `files.py peak PROGRAM ARGUMENT…` prints the most
memory that a program had, in bytes.
"""

import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

NAMES = ["gx", "gy", "gz", "ax", "ay", "az"]


def make(folder, rows):
    import polars

    noise = np.random.default_rng(1).normal(size=(rows, len(NAMES))).round(6)
    table = polars.DataFrame({"t_s": np.arange(rows) / 200} | {name: noise[:, at] for at, name in enumerate(NAMES)})
    table.write_csv(folder / "seven.csv", float_precision=6)
    table.select("gx").write_csv(folder / "one.csv", float_precision=6)
    table.write_parquet(folder / "seven.parquet", compression="snappy")
    np.save(folder / "one.npy", noise[:, 0])


def read(path, columns):
    if path.endswith(".npy"):
        return [np.load(path)]
    import polars

    read_table = polars.read_csv if path.endswith(".csv") else polars.read_parquet
    table = read_table(path, columns=columns)
    return [table[column].to_numpy() for column in columns]


if sys.argv[1] == "make":
    make(Path(sys.argv[2]), int(sys.argv[3]))
elif sys.argv[1] == "peak":
    subprocess.run(sys.argv[2:], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)
else:
    import allantools

    for rate in read(sys.argv[1], sys.argv[2].split(",")):
        octaves = [2.0**k for k in range(64) if 2 * 2**k <= len(rate)]
        for tau, dev in zip(*allantools.oadev(rate, rate=1.0, data_type="freq", taus=octaves)[:2]):
            print(tau, dev)
