"""The PDF of a certificate: its conformance to PDF/A-3b, attachment, marks on each page, and reproducibility."""

from __future__ import annotations

import io
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from conftest import PROGRAM, Made
from pypdf import PdfReader

from zerorate_certificate import Lab, certificate_pdf, certificate_xml

pytest.importorskip("weasyprint", minversion="67", reason="a PDF needs WeasyPrint 67, which needs Python 3.10")

VERAPDF = shutil.which("verapdf")


@pytest.fixture(scope="module")
def simulated_pdf(made: dict[str, Made], lab: Lab) -> bytes:
    return certificate_pdf(made["imu"].path, lab)


@pytest.fixture(scope="module")
def measured_pdf(measured: Path, lab: Lab) -> bytes:
    return certificate_pdf(measured, lab)


def reader(pdf: bytes) -> PdfReader:
    return PdfReader(io.BytesIO(pdf))


def root_of(pdf: bytes) -> Any:
    """The catalogue of the document, whose entries have no useful types."""
    return reader(pdf).trailer["/Root"]


def pages(pdf: bytes) -> list[str]:
    return [page.extract_text() for page in reader(pdf).pages]


def test_it_says_that_it_is_pdf_a_3b(measured_pdf: bytes) -> None:
    metadata = root_of(measured_pdf)["/Metadata"].get_data().decode()
    assert "part>3<" in metadata.replace('part="3"', "part>3<")
    assert "conformance>B<" in metadata.replace('conformance="B"', "conformance>B<")


def test_it_has_title_author_language_and_the_date_of_issue(measured_pdf: bytes, lab: Lab) -> None:
    document = reader(measured_pdf)
    assert document.metadata is not None
    assert document.metadata.title == "Calibration certificate 2026-0001"
    assert document.metadata.author == lab.laboratory.name
    assert str(document.metadata["/CreationDate"]).startswith("D:20260302")
    assert root_of(measured_pdf)["/Lang"] == "en"


def test_the_xml_is_attached_as_data(measured_pdf: bytes, measured: Path, lab: Lab) -> None:
    root = root_of(measured_pdf)
    # WeasyPrint 70 lists the one attachment twice, which PDF/A allows
    assert len({entry.idnum for entry in root["/AF"]}) == 1
    file = root["/AF"][0].get_object()
    assert (file["/UF"], file["/AFRelationship"]) == ("dcc.xml", "/Data")
    stream = file["/EF"]["/F"].get_object()
    assert stream["/Subtype"] in ("/application/xml", "/text/xml")
    assert stream.get_data() == certificate_xml(measured, lab)
    assert root["/Names"]["/EmbeddedFiles"]["/Names"][1].get_object() == file


def test_it_states_its_colours(measured_pdf: bytes) -> None:
    (intent,) = root_of(measured_pdf)["/OutputIntents"]
    assert intent["/S"] == "/GTS_PDFA1"
    assert intent["/DestOutputProfile"].get_data()[36:40] == b"acsp"


def test_all_fonts_are_in_it(simulated_pdf: bytes) -> None:
    found = [font for page in reader(simulated_pdf).pages for font in fonts(page["/Resources"].get_object())]
    assert found
    for font in found:
        descriptor = font["/DescendantFonts"][0].get_object()["/FontDescriptor"]
        assert {"/FontFile", "/FontFile2", "/FontFile3"} & set(descriptor), font["/BaseFont"]


def fonts(resources: Any) -> list[Any]:
    """The fonts of a page and of the forms on it."""
    found = [font.get_object() for font in resources.get("/Font", {}).values()]
    for form in resources.get("/XObject", {}).values():
        inner = form.get_object().get("/Resources")
        found += fonts(inner.get_object()) if inner is not None else []
    return found


@pytest.mark.skipif(VERAPDF is None, reason="there is no program `verapdf` in PATH")
@pytest.mark.parametrize("kind", ["an1042", "warmup", "cycle", "imu"])
def test_verapdf_agrees(kind: str, made: dict[str, Made], lab: Lab, tmp_path: Path) -> None:
    path = tmp_path / "certificate.pdf"
    path.write_bytes(certificate_pdf(made[kind].path, lab))
    command = [str(VERAPDF), "--flavour", "3b", "--format", "text", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.stdout.startswith("PASS"), done.stdout + done.stderr


def test_every_page_of_a_simulated_certificate_says_so(simulated_pdf: bytes) -> None:
    texts = pages(simulated_pdf)
    assert len(texts) > 3
    assert all("SIMULATED" in text for text in texts)


def test_no_page_of_a_measured_certificate_says_so(measured_pdf: bytes) -> None:
    assert not any("SIMULATED" in text.upper() for text in pages(measured_pdf))


def test_every_page_has_the_number_the_laboratory_and_its_place(measured_pdf: bytes, lab: Lab) -> None:
    texts = pages(measured_pdf)
    for number, text in enumerate(texts, start=1):
        assert f"Certificate {lab.number}" in text
        assert lab.laboratory.name in text
        assert f"Page {number} of {len(texts)}" in text
    assert [f"End of certificate {lab.number}" in text for text in texts] == [False] * (len(texts) - 1) + [True]


def test_the_same_input_gives_the_same_bytes_twice(measured: Path, lab_file: Path, tmp_path: Path) -> None:
    contents = []
    for number, seed in enumerate(("1", "2")):
        output = tmp_path / f"{number}.pdf"
        command = [PROGRAM, str(measured), "--lab", str(lab_file), "-o", str(output)]
        environment = {**os.environ, "PYTHONHASHSEED": seed, "TZ": "Asia/Tokyo" if number else "UTC"}
        subprocess.run(command, check=True, capture_output=True, env=environment)
        contents.append(output.read_bytes())
    assert contents[0] == contents[1]


def test_texts_of_the_laboratory_come_through(measured: Path, lab: Lab) -> None:
    name = 'Prüfstelle "Süd" \\ <b>Ähre & Söhne</b> </style>'
    texts = pages(certificate_pdf(measured, replace(lab, laboratory=replace(lab.laboratory, name=name))))
    # in the header of each page, and once more in the table of the first page
    assert [text.replace("\n", " ").count(name) for text in texts] == [2] + [1] * (len(texts) - 1)


def test_a_character_that_no_font_has_is_an_error(measured: Path, lab: Lab) -> None:
    with pytest.raises(ValueError, match=r"no font of this machine has the characters U\+10F123"):
        certificate_pdf(measured, replace(lab, remarks="lost: \U0010f123"))


def test_the_package_does_not_load_weasyprint_by_itself() -> None:
    program = "import sys, zerorate_certificate; sys.exit('weasyprint' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0


def test_a_missing_library_of_pango_names_the_package(measured: Path, lab_file: Path, tmp_path: Path) -> None:
    (tmp_path / "weasyprint.py").write_text("raise OSError(\"cannot load library 'libpango-1.0-0'\")")
    path = os.pathsep.join(filter(None, [str(tmp_path), os.environ.get("PYTHONPATH")]))
    output = tmp_path / "x.pdf"
    command = [PROGRAM, str(measured), "--lab", str(lab_file), "-o", str(output)]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path})
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.count("\n") == 1 and "apt install libpango-1.0-0 libpangoft2-1.0-0" in done.stderr
    assert not output.exists()
