"""Foreign text is shown, not obeyed: what a terminal, an editor or a spreadsheet would act on is written out."""

from __future__ import annotations

import json
import re
from unicodedata import category

OBEYED = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode's controls, invisible formats (those that turn the direction of text among them), halves of a character that
stand alone, and its own ends of lines and paragraphs."""
_PLAIN = re.compile(r"[ -~]*")
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def as_cell(value: object) -> object:
    """A value as a spreadsheet shows it: a text that it would take for a formula gets a `'` before.

    Examples
    --------
    >>> as_cell("=HYPERLINK(1)"), as_cell("plate 7"), as_cell(-3.5), as_cell("-3.5")
    ("'=HYPERLINK(1)", 'plate 7', -3.5, '-3.5')
    """
    if not isinstance(value, str) or not value.lstrip(" \n").startswith(_FORMULA) or _is_number(value):
        return value
    return f"'{value}"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def escape_text(text: str) -> str:
    """The text in one line, every character that is obeyed rather than read written as its number.

    Examples
    --------
    >>> escape_text("A\\nok: every hard rule holds")
    'A\\\\u000aok: every hard rule holds'
    >>> escape_text("Träger 7")
    'Träger 7'
    """
    if _PLAIN.fullmatch(text):
        return text
    return "".join(_numbered(c) if category(c) in OBEYED else c for c in text)


def escape_lines(text: str) -> str:
    """The same for text of several lines, which may hold tabs: both stay."""
    return "\n".join("\t".join(escape_text(cell) for cell in line.split("\t")) for line in text.split("\n"))


def json_lines(data: object) -> str:
    """JSON to be read by people, too: letters of all languages stay, what would be obeyed is written as its number.

    Examples
    --------
    >>> print(json_lines({"part": "Tr\u00e4ger\u200b"}), end="")
    {
     "part": "Träger\\u200b"
    }
    """
    text = json.dumps(data, indent=1, ensure_ascii=False)
    if not text.isascii():
        text = "".join(json.dumps(c)[1:-1] if c != "\n" and category(c) in OBEYED else c for c in text)
    return text + "\n"


def _numbered(character: str) -> str:
    code = ord(character)
    return f"\\u{code:04x}" if code < 1 << 16 else f"\\U{code:08x}"
