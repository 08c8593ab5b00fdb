"""Foreign text is shown, not obeyed: what a terminal or an editor would act on is written out instead."""

from __future__ import annotations

import re
from unicodedata import category

OBEYED = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode's controls, invisible formats (those that turn the direction of text among them), halves of a character that
stand alone, and its own ends of lines and paragraphs."""
_PLAIN = re.compile(r"[ -~]*")


def shown(text: str) -> str:
    """The text in one line, every character that is obeyed rather than read written as its number.

    Examples
    --------
    >>> shown("A\\nok: every hard rule holds")
    'A\\\\u000aok: every hard rule holds'
    >>> shown("Träger 7")
    'Träger 7'
    """
    if _PLAIN.fullmatch(text):
        return text
    return "".join(_numbered(c) if category(c) in OBEYED else c for c in text)


def shown_lines(text: str) -> str:
    """The same for text of several lines, which may hold tabs: both stay."""
    return "\n".join("\t".join(shown(cell) for cell in line.split("\t")) for line in text.split("\n"))


def _numbered(character: str) -> str:
    code = ord(character)
    return f"\\u{code:04x}" if code < 1 << 16 else f"\\U{code:08x}"
