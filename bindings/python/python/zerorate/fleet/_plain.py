"""Names of files and texts from outside, as they are shown: on a terminal, on a page and in a row.

A name of a file may have any bytes but ``/`` and 0. What would move the cursor, change colours or turn the
direction of writing is shown as the program shows it, ``\\u{1b}``; a byte that is not UTF-8 as ``\\xfc``.
"""

from __future__ import annotations

import unicodedata
from typing import Any

# Python carries a byte of a name that is not UTF-8 as this, plus the byte.
BYTES = 0xDC00

SHORT = {"\t": "\\t", "\n": "\\n", "\r": "\\r"}


def is_utf8(name: str) -> bool:
    """True if a name of a file is text."""
    return not any(_is_surrogate(letter) for letter in name)


def utf8(name: str) -> str:
    """A name of a file as text, whose other bytes are escaped."""
    return "".join(_shown(letter) if _is_surrogate(letter) else letter for letter in name)


def plain(text: Any) -> str:
    """A line that does nothing to a terminal."""
    return "".join(_shown(letter) if _acts(letter) else letter for letter in utf8(str(text)))


def _acts(letter: str) -> bool:
    return unicodedata.category(letter) in ("Cc", "Zl", "Zp") or letter in "\u200e\u200f\u061c" or _turns(letter)


def _turns(letter: str) -> bool:
    return "\u202a" <= letter <= "\u202e" or "\u2066" <= letter <= "\u2069"


def _is_surrogate(letter: str) -> bool:
    return "\ud800" <= letter <= "\udfff"


def _shown(letter: str) -> str:
    byte = ord(letter) - BYTES
    if 0x80 <= byte <= 0xFF:
        return f"\\x{byte:02x}"
    return SHORT.get(letter, f"\\u{{{ord(letter):x}}}")
