"""Results as notebooks show them: the text, and the picture."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from . import _frame

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def with_figure(result: object, plot: Callable[[], Figure]) -> str:
    """The text of a result as HTML, with its figure if there is something to draw and matplotlib is installed."""
    try:
        figure = plot()
    except (ImportError, ValueError):
        return _text(result)
    png = io.BytesIO()
    figure.savefig(png, format="png", dpi=90)
    # a notebook would show an open figure once more
    _frame.needed("matplotlib.pyplot", "plot()").close(figure)
    return _text(result) + _image("png", png.getvalue())


def with_pictures(result: object, pictures: Iterable[str]) -> str:
    """The text of a result, and its pictures in SVG."""
    return _text(result) + "".join(_image("svg+xml", picture.encode()) for picture in pictures)


def _text(result: object) -> str:
    return f"<pre>{html.escape(repr(result))}</pre>"


def _image(kind: str, content: bytes) -> str:
    return f'<img style="max-width: 100%" src="data:image/{kind};base64,{base64.b64encode(content).decode()}">'
