"""Times numpy's copy and allantools on the rates in a file of little-endian f64. Prints a JSON object per run.

`peers.py DATA` times; `peers.py DATA --memory` runs the overlapping Allan deviation once and states the peak memory.
"""

import functools
import json
import resource
import sys
import time

import allantools
import numpy as np

SHORT = 855_000


def timed(who, work, run, repeats=1):
    seconds, result = [], None
    for _ in range(repeats):
        start = time.perf_counter()
        result = run()
        seconds.append(time.perf_counter() - start)
    dev = list(result[1]) if isinstance(result, tuple) else None
    print(json.dumps({"who": who, "work": work, "seconds": min(seconds), "dev": dev}), flush=True)


def octaves(samples):
    return [2.0**k for k in range(64) if 2 * 2**k <= samples]


def hundred(samples):
    lengths = np.exp(np.log(samples / 3) * np.arange(100) / 99)
    return sorted({float(round(m)) for m in lengths})


def fine(samples):
    """Averaging factors 1, 2, 3, then four per octave."""
    octaves = (float(quarter << k) for k in range(60) for quarter in (4, 5, 6, 7))
    return [1.0, 2.0, 3.0] + [m for m in octaves if 2 * m <= samples]


def time_all(rate):
    timed("numpy copy", "copy", rate.copy, repeats=7)
    for name in ("oadev", "mdev", "ohdev", "totdev"):
        run = getattr(allantools, name)
        timed("allantools", name, lambda: run(rate, rate=1.0, data_type="freq", taus=octaves(len(rate))))
    oadev = functools.partial(allantools.oadev, rate=1.0, data_type="freq")
    timed("allantools", "oadev, 100 times", lambda: oadev(rate, taus=hundred(len(rate))))
    timed("allantools", "oadev, fine", lambda: oadev(rate, taus=fine(len(rate))))
    short = rate[:SHORT]
    timed("allantools", "oadev, short", lambda: oadev(short, taus=octaves(len(short))), repeats=5)


def memory(rate):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    allantools.oadev(rate, rate=1.0, data_type="freq", taus=octaves(len(rate)))
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    print(json.dumps({"who": "allantools", "work": "oadev", "memory": 1 + grown / rate.nbytes}))


data = np.fromfile(sys.argv[1])
memory(data) if "--memory" in sys.argv else time_all(data)
