"""Certificates in the record, from the files that `zerorate certificate` writes."""

from __future__ import annotations

import hashlib
from pathlib import Path

from line_helpers import line, run

LAB = "certificate-lab.toml"


def certificate(calibration: Path, folder: Path, number: str, replaces: str = "") -> None:
    """Writes the XML and the HTML of a certificate."""
    example = run("certificate", "--example-lab", cwd=folder).stdout
    (folder / LAB).write_text(example.replace("2026-0001", number) + replaces, encoding="utf-8")
    for ending in ("xml", "html"):
        done = run("certificate", calibration, "--lab", LAB, "-o", f"{number}.{ending}", cwd=folder)
        assert done.returncode == 0, done.stderr


def test_a_certificate_belongs_to_its_calibration(calibration: tuple[Path, Path], tmp_path: Path) -> None:
    certificate(calibration[0], tmp_path, "C-1")
    early = line("certify", "C-1.xml", cwd=tmp_path)
    assert early.returncode == 1 and "there is no record" in early.stderr
    line("add", calibration[0], cwd=tmp_path)
    assert line("certify", "C-1.xml", "--pdf", "C-1.html", cwd=tmp_path).returncode == 0
    assert "C-1" in line("show", "SN7", cwd=tmp_path).stdout
    assert line("verify", cwd=tmp_path).returncode == 0
    twice = line("certify", "C-1.xml", cwd=tmp_path)
    assert twice.returncode == 1 and "has a certificate C-1 already" in twice.stderr


def test_an_amendment_needs_its_reason(calibration: tuple[Path, Path], tmp_path: Path) -> None:
    line("add", calibration[0], cwd=tmp_path)
    certificate(calibration[0], tmp_path, "C-1")
    certificate(calibration[0], tmp_path, "C-2", '\n[replaces]\nnumber = "C-1"\nreason = "a typo"\n')
    line("certify", "C-1.xml", cwd=tmp_path)
    assert "needs a reason" in line("certify", "C-2.xml", cwd=tmp_path).stderr
    assert line("certify", "C-2.xml", "--reason", "a typo", cwd=tmp_path).returncode == 0


def test_other_files_are_refused(calibration: tuple[Path, Path], tmp_path: Path) -> None:
    line("add", calibration[0], cwd=tmp_path)
    certificate(calibration[0], tmp_path, "C-1")
    text = (tmp_path / "C-1.xml").read_text(encoding="utf-8")
    (tmp_path / "nameless.xml").write_text(text.replace("Calibration id", "Other id"), encoding="utf-8")
    (tmp_path / "page.xml").write_text("<html/>")
    (tmp_path / "text.xml").write_text("hello")
    for name, said in [
        ("nameless.xml", "states no calibration"),
        ("page.xml", "is not a digital calibration certificate"),
        ("text.xml", "is not XML"),
        ("none.xml", "cannot read none.xml"),
    ]:
        done = line("certify", name, cwd=tmp_path)
        assert (done.returncode, said in done.stderr) == (1, True), done.stderr


def test_the_hashes_are_those_of_the_files(calibration: tuple[Path, Path], tmp_path: Path) -> None:
    from zerorate.line import open_record
    from zerorate.line._tables import CERTIFICATE

    certificate(calibration[0], tmp_path, "C-1")
    with open_record(f"sqlite:///{tmp_path / 'line.db'}") as record:
        record.add_calibration(calibration[0])
        record.certify(tmp_path / "C-1.xml", pdf=tmp_path / "C-1.html")
        with record._store.reading() as connection:
            row = connection.execute(CERTIFICATE.select()).one()
    for found, name in ((row.dcc_sha256, "C-1.xml"), (row.pdf_sha256, "C-1.html")):
        assert found == hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()
