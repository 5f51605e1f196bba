"""A record in the hands of a hostile world."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from line_helpers import measurement

from zerorate.line import LineError, open_record

FULL_DISK = """\
import resource, signal, sys
from line_helpers import measurement
from zerorate.line import LineError, open_record
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
record = open_record(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
for number in range(1000):
    try:
        record.add(measurement(f"SN{number}"))
    except LineError as error:
        print(number, error)
        break
"""


@pytest.mark.skipif(os.name == "nt", reason="limits of a process")
def test_a_full_disk_leaves_the_record_whole(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'line.db'}"
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([os.path.dirname(__file__), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-c", FULL_DISK, url]
    done = subprocess.run(command, capture_output=True, text=True, env=env, timeout=60)
    assert done.returncode == 0, done.stderr
    entered, said = done.stdout.split(" ", 1)
    assert "full" in said or "disk I/O" in said
    with open_record(url) as record:
        assert len(record.results()) == int(entered)
        assert record.verify().findings == []
        assert record.add(measurement("SN-last")) is not None


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written_is_explained(tmp_path: Path) -> None:
    tmp_path.chmod(0o555)
    try:
        with pytest.raises(LineError, match="may you write to it"):
            open_record(f"sqlite:///{tmp_path / 'line.db'}")
    finally:
        tmp_path.chmod(0o755)


def test_a_record_that_may_only_be_read_says_so(tmp_path: Path) -> None:
    file = tmp_path / "line.db"
    with open_record(f"sqlite:///{file}") as writer:
        writer.add(measurement("SN1"))
        with open_record(f"sqlite:///file:{file}?mode=ro&uri=true") as record:
            assert len(record.results()) == 1
            with pytest.raises(LineError, match="you may not write there"):
                record.add(measurement("SN2"))


def test_many_programs_may_begin_a_record_at_once(url: str) -> None:
    program = "import sys; from zerorate.line import open_record; open_record(sys.argv[1]).close()"
    running = [subprocess.Popen([sys.executable, "-c", program, url], stderr=subprocess.PIPE) for _ in range(4)]
    assert [child.communicate()[1] for child in running] == [b""] * 4
    with open_record(url, create=False) as record:
        assert record.verify().entries == 0
