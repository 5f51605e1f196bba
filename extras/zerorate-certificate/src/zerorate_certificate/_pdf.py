"""The certificate as PDF/A-3b with the XML in it. WeasyPrint and the libraries of Pango are loaded on demand."""

from __future__ import annotations

import contextlib
import hashlib
import io
import logging
from datetime import datetime, time
from typing import TYPE_CHECKING, Any

from ._html import html_of
from ._xml import xml_of

if TYPE_CHECKING:
    from ._content import Content

ATTACHMENT = "dcc.xml"

OLDEST_WEASYPRINT = 67
"""Oldest supported version, which needs Python 3.10. Older ones silently omit characters that no font has."""


def pdf_of(content: Content) -> bytes:
    """The PDF of this content: the same content and fonts give the same bytes."""
    weasyprint = _weasyprint()
    page, xml = html_of(content), xml_of(content)
    issued = datetime.combine(content.lab.issued, time())
    attachment = weasyprint.Attachment(
        string=xml.decode(),
        name=ATTACHMENT,
        description="Digital calibration certificate, DCC 3.3.0",
        created=issued,
        modified=issued,
        relationship="Data",
    )
    with _Complaints() as complaints:
        document = weasyprint.HTML(string=page).render()
        pdf = document.write_pdf(
            pdf_variant="pdf/a-3b",
            pdf_identifier=hashlib.sha256(page.encode() + xml).digest()[:16],
            attachments=[attachment],
        )
    complaints.raise_lost_text()
    return bytes(pdf)


def _weasyprint() -> Any:
    try:
        # WeasyPrint prints a paragraph if a library is missing
        with contextlib.redirect_stdout(io.StringIO()):
            import weasyprint
    except ModuleNotFoundError as error:
        raise ImportError(
            f"a PDF needs {error.name}: pip install weasyprint, with Python 3.10 or newer"
        ) from None
    except OSError as error:
        raise ImportError(
            f"a PDF needs the libraries of Pango ({error}). On Debian: apt install libpango-1.0-0 libpangoft2-1.0-0"
        ) from None
    if int(weasyprint.__version__.partition(".")[0]) < OLDEST_WEASYPRINT:
        raise ImportError(f"a PDF needs WeasyPrint {OLDEST_WEASYPRINT} or newer, and this is {weasyprint.__version__}")
    return weasyprint


class _Complaints(logging.Handler):
    """Collects the log messages of WeasyPrint. A character that no font has would silently become an empty box."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._texts: list[str] = []

    def __enter__(self) -> _Complaints:
        logging.getLogger("weasyprint").addHandler(self)
        return self

    def __exit__(self, *_: object) -> None:
        logging.getLogger("weasyprint").removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        self._texts.append(record.getMessage())

    def raise_lost_text(self) -> None:
        """Raises ValueError if no font has a character of the page."""
        lost = [text.rpartition("(")[2].rstrip(")") for text in self._texts if "notdef" in text]
        if lost:
            raise ValueError(
                f"no font of this machine has the characters {', '.join(sorted(set(lost)))}. "
                "Install a font that has them, such as fonts-noto on Debian"
            )
