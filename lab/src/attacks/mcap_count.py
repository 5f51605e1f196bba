"""Reads an MCAP with all its sums. Prints how many messages it has, and how many its statistics state."""

import sys

from mcap.reader import make_reader

with open(sys.argv[1], "rb") as file:
    reader = make_reader(file, validate_crcs=True)
    found = sum(1 for _ in reader.iter_messages())
    print(found, reader.get_summary().statistics.message_count)
