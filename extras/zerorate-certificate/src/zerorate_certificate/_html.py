"""The certificate as one HTML page, for the screen, for paper and for the PDF."""

from __future__ import annotations

import base64
import re
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader, StrictUndefined

from ._lab import PLACES
from ._statements import method_of

if TYPE_CHECKING:
    from ._content import Content


def html_of(content: Content) -> str:
    environment = Environment(
        loader=PackageLoader("zerorate_certificate", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["css_string"] = css_string
    method, description = method_of(content.calibration)
    return environment.get_template("page.html.jinja").render(
        content=content,
        lab=content.lab,
        calibration=content.calibration,
        method=method,
        method_description=description,
        place=PLACES[content.lab.place],
        pictures=[_data_uri(picture) for picture in content.calibration.pictures()],
    )


def css_string(text: str) -> str:
    """The text as a string of CSS: every character with a meaning in CSS or HTML becomes a code."""
    return '"' + re.sub(r'[\\"<>&\n\r\t]', lambda found: f"\\{ord(found[0]):x} ", text) + '"'


def _data_uri(svg: str) -> str:
    return "data:image/svg+xml;base64," + base64.b64encode(svg.encode()).decode("ascii")
