"""Calibration certificates: a calibration as HTML, as PDF/A-3 and as a Digital Calibration Certificate (DCC).

=====================  =========================================================================
`Lab`                  facts from `lab.toml`: laboratory, customer, persons, dates
`certificate_html`     one page without network access, for the screen and for paper
`certificate_pdf`      PDF/A-3b of that page, with the XML attached
`certificate_xml`      DCC 3.3.0 of PTB with D-SI 2.2.1 units
=====================  =========================================================================

The same calibration, laboratory and fonts give the same bytes. The layout of `lab.toml` and the checklist of
ISO/IEC 17025:2017, 7.8 are in README.md of the package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._content import Content
from ._html import html_of
from ._lab import Lab
from ._xml import xml_of

if TYPE_CHECKING:
    import os

__all__ = ["Lab", "certificate_html", "certificate_pdf", "certificate_xml"]


def certificate_xml(calibration_path: str | os.PathLike[str], lab: Lab) -> bytes:
    """The certificate as a Digital Calibration Certificate, DCC 3.3.0, for machines. Its values are not rounded.

    Parameters
    ----------
    calibration_path
        A calibration file that a measurement wrote, with its check lines.
    lab
        The laboratory's part of the certificate.

    Raises
    ------
    ValueError
        If the file was edited, was written by hand, lacks what a certificate must state, or contradicts ``lab``.
    OSError
        If the calibration file cannot be read.
    """
    return xml_of(Content.load(calibration_path, lab))


def certificate_html(calibration_path: str | os.PathLike[str], lab: Lab) -> str:
    """The certificate as one HTML page. Its values are rounded to the two digits of the expanded uncertainty.

    Takes and raises the same as `certificate_xml`.
    """
    return html_of(Content.load(calibration_path, lab))


def certificate_pdf(calibration_path: str | os.PathLike[str], lab: Lab) -> bytes:
    """The certificate as PDF/A-3b: the page of `certificate_html` with the XML of `certificate_xml` as ``dcc.xml``.

    Takes and raises the same as `certificate_xml`.

    Raises
    ------
    ImportError
        If WeasyPrint or Pango is missing, or WeasyPrint is too old. The error text says what is needed.
    ValueError
        Also if no font of this machine has a character of the certificate.
    """
    from ._pdf import pdf_of

    return pdf_of(Content.load(calibration_path, lab))
