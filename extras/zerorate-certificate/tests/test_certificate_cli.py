"""The program `zerorate-certificate`: its output files, and the last line of each error."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from conftest import PROGRAM

from zerorate_certificate import Lab, certificate_html, certificate_pdf, certificate_xml


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, encoding="utf-8", timeout=120)


def fails(code: int, why: str, *arguments: str | Path) -> None:
    """Checks the exit code, and that the last line of the errors (for code 1, the only line) states this reason."""
    done = run(*arguments)
    assert (done.returncode, done.stdout) == (code, ""), done.stderr
    lines = done.stderr.splitlines()
    assert why in lines[-1] and "Traceback" not in done.stderr
    if code == 1:
        assert len(lines) == 1 and lines[0].startswith("error: ")


@pytest.mark.parametrize("ending", [".html", ".pdf", ".xml", ".PDF"])
def test_the_ending_chooses_the_form(ending: str, measured: Path, lab_file: Path, tmp_path: Path) -> None:
    if ending.lower() == ".pdf":
        pytest.importorskip("weasyprint", minversion="67", reason="a PDF needs WeasyPrint 67, which needs Python 3.10")
    output, lab = tmp_path / f"Größe{ending}", Lab.load(lab_file)
    done = run(measured, "--lab", lab_file, "-o", output)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"Written to {output}\n"
    forms = {
        ".html": lambda *given: certificate_html(*given).encode(),
        ".pdf": certificate_pdf,
        ".xml": certificate_xml,
    }
    assert output.read_bytes() == forms[ending.lower()](measured, lab)
    assert [path.name for path in tmp_path.iterdir()] == [output.name]


def test_another_ending_is_refused(measured: Path, lab_file: Path, tmp_path: Path) -> None:
    fails(2, "one of .html, .pdf, .xml", measured, "--lab", lab_file, "-o", tmp_path / "x.docx")
    fails(2, "one of .html, .pdf, .xml", measured, "--lab", lab_file, "-o", tmp_path / "x")


def test_an_existing_file_is_kept_without_force(measured: Path, lab_file: Path, tmp_path: Path) -> None:
    output = tmp_path / "x.xml"
    output.write_text("mine")
    fails(1, "give --force", measured, "--lab", lab_file, "-o", output)
    assert output.read_text() == "mine"
    assert run(measured, "--lab", lab_file, "-o", output, "--force").returncode == 0
    assert output.read_bytes().startswith(b"<?xml")


def test_missing_facts_are_named(measured: Path, lab_file: Path, tmp_path: Path) -> None:
    output = tmp_path / "x.xml"
    fails(2, "missing: the calibration file, --lab, -o")
    fails(2, "missing: --lab", measured, "-o", output)
    fails(1, "none.toml: No such file", tmp_path / "none.toml", "--lab", lab_file, "-o", output)
    fails(1, "none.toml: No such file", measured, "--lab", tmp_path / "none.toml", "-o", output)
    fails(1, "the folder", measured, "--lab", lab_file, "-o", tmp_path / "none" / "x.xml")
    assert not output.exists()


def test_a_wrong_calibration_is_refused(measured: Path, lab_file: Path, tmp_path: Path) -> None:
    unit, output = tmp_path / "unit.toml", tmp_path / "x.pdf"
    text = measured.read_text(encoding="utf-8")
    unit.write_text(text.replace("pbc_dps = -0.4", "pbc_dps = -0.3"), encoding="utf-8")
    fails(1, "is not what was written", unit, "--lab", lab_file, "-o", output)
    unit.write_text("\n".join(line for line in text.splitlines() if "check" not in line), encoding="utf-8")
    fails(1, "no check lines", unit, "--lab", lab_file, "-o", output)
    unit.write_bytes(b"\x00\xff junk")
    fails(1, "unit.toml: this is not text in UTF-8", unit, "--lab", lab_file, "-o", output)
    fails(1, "lab.toml", lab_file, "--lab", lab_file, "-o", output)
    fails(1, str(tmp_path), tmp_path, "--lab", lab_file, "-o", output)
    assert not output.exists()


def test_code_in_the_current_folder_does_not_run(measured: Path, lab_file: Path, tmp_path: Path) -> None:
    pytest.importorskip("weasyprint", minversion="67", reason="a PDF needs WeasyPrint 67, which needs Python 3.10")
    folder = tmp_path / "foreign"
    folder.mkdir()
    for name in ("jinja2", "json", "lxml", "numpy", "weasyprint", "zerorate", "zerorate_certificate"):
        (folder / f"{name}.py").write_text(f"open({str(folder / 'ran')!r}, 'a').write(__file__)\n")
    command = [PROGRAM, str(measured), "--lab", str(lab_file), "-o", str(tmp_path / "x.pdf")]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert not (folder / "ran").exists(), (folder / "ran").read_text()


def test_the_help_has_examples() -> None:
    done = run("--help")
    assert done.returncode == 0
    assert "zerorate-certificate unit.toml --lab lab.toml -o certificate.pdf" in done.stdout
