"""Shows names of files and other foreign texts safely: on a terminal, on a page and in a row.

A file name may have any bytes but ``/`` and 0. Characters that move the cursor, change colours or turn the direction
of writing are escaped as in the program, ``\\u{1b}``; a byte that is not UTF-8 as ``\\xfc``.
"""

from __future__ import annotations

import unicodedata
from typing import Any

# Python represents a byte that is not UTF-8 as this code point plus the byte (PEP 383).
BYTES = 0xDC00

SHORT = {"\t": "\\t", "\n": "\\n", "\r": "\\r"}


def is_utf8(name: str) -> bool:
    return not any(_is_surrogate(letter) for letter in name)


def utf8(name: str) -> str:
    """A file name as text. Bytes that are not UTF-8 are escaped."""
    return "".join(_shown(letter) if _is_surrogate(letter) else letter for letter in name)


def plain(text: Any) -> str:
    """A text in which characters that act on a terminal are escaped."""
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
