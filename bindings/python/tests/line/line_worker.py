"""A station of `test_line_at_once`: enters prepared calibrations, and says which are entered.

python line_worker.py URL STATION COUNT
"""

from __future__ import annotations

import sys
from dataclasses import replace

from line_helpers import LIMITS, measurement

from zerorate.line import open_record


def main(url: str, station: str, count: int) -> None:
    """Enters the units of a station from the first on, as after a power cut."""
    with open_record(url) as record:
        for number in range(count):
            serial = f"{station}-{number}"
            record.add(replace(measurement(serial), station=station), LIMITS)
            print(serial, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
