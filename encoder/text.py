"""Text for people: foreign text escaped, names joined or suggested, rows as columns, times and money as figures."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from unicodedata import category

# Foreign text is shown, not obeyed: what a terminal or an editor would act on is written out instead.

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


def _numbered(character: str) -> str:
    code = ord(character)
    return f"\\u{code:04x}" if code < 1 << 16 else f"\\U{code:08x}"


# Names in a sentence: the first few of them, and how many more there are.


def join_names(names: Sequence[str], most: int) -> str:
    """The first names, `most` of them, and the number of the others.

    Examples
    --------
    >>> join_names(["A", "B"], 2), join_names(["A", "B", "C"], 2)
    ('A, B', 'A, B and 1 more')
    """
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")


def first_and_last(names: Sequence[str], most: int = 6) -> str:
    """All names, or the first and the last where there are more than `most`.

    Examples
    --------
    >>> first_and_last(["A", "B"]), first_and_last(["A", "B", "C"], most=2)
    ('A, B', 'A … C')
    """
    return ", ".join(names) if len(names) <= most else f"{names[0]} … {names[-1]}"


# Rows of text as columns of equal width, for terminals.


def align_columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """A line for each row; all rows have as many cells as the first.

    Examples
    --------
    >>> align_columns([("", "before", "after"), ("idle travel", "3.1 m", "2.9 m")])
    ['             before  after', 'idle travel  3.1 m   2.9 m']
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip() for row in rows]


# Figures as a planner reads them.

NONE = "–"
"""Stands where there is no figure."""


def clock(seconds: float) -> str:
    """Hours, minutes and seconds.

    Examples
    --------
    >>> clock(75.2), clock(3675.0)
    ('1:15', '1:01:15')
    """
    minutes, left = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{left:02d}" if hours else f"{minutes}:{left:02d}"


def money(amount: float | None, currency: str) -> str:
    """An amount with its currency."""
    return NONE if amount is None else f"{amount:.2f} {currency}"


def metres(mm: float) -> str:
    """A length."""
    return f"{mm / 1000:.2f} m"


def percent(share: float | None) -> str:
    """A share; what is 0 is exactly that.

    Examples
    --------
    >>> percent(0.0), percent(0.0123)
    ('0 %', '1.23 %')
    """
    return NONE if share is None else "0 %" if share == 0 else f"{100 * share:.2f} %"


def nearest(word: str, valid: Iterable[str]) -> str | None:
    """The valid name most like `word`, or None when nothing is like it.

    Examples
    --------
    >>> nearest("levelahead", ["hull-before", "level-ahead"])
    'level-ahead'
    >>> nearest("lasr", ["laser-wood", "water-jet"])
    'laser-wood'
    >>> nearest("zzz", ["hull-before"]) is None
    True
    """
    by_plain = {_plain(name): name for name in sorted(valid, reverse=True)}
    begun = [plain for plain in sorted(by_plain) if len(word) > 2 and plain.startswith(_plain(word))]
    matches = begun or difflib.get_close_matches(_plain(word), by_plain, n=1, cutoff=0.6)
    return by_plain[matches[0]] if matches else _begun_alike(_plain(word), by_plain)


def _begun_alike(word: str, by_plain: Mapping[str, str]) -> str | None:
    """The first name whose beginning is much like what was given: `lasr` for `laser-wood`."""
    for plain in sorted(by_plain) if len(word) > 2 else ():
        beginnings = [plain[: len(word) + k] for k in (-1, 0, 1)]
        if difflib.get_close_matches(word, beginnings, n=1, cutoff=0.8):
            return by_plain[plain]
    return None


def unknown(what: str, word: str, valid: Iterable[str]) -> str:
    """A message for a name that is not among the valid ones: the nearest, and all of them when they are few.

    Examples
    --------
    >>> unknown("key", "kerv", ["name", "kerf"])
    "unknown key 'kerv': did you mean 'kerf'? (valid: kerf, name)"
    """
    names = sorted(valid)
    guess = nearest(word, names)
    hint = f": did you mean {guess!r}?" if guess else ""
    listed = ", ".join(names) if len(names) <= 20 else f"{', '.join(names[:20])}, …"
    return f"unknown {what} {word!r}{hint} (valid: {listed})" if names else f"unknown {what} {word!r}"


def _plain(name: str) -> str:
    return name.lower().replace("_", "-").replace(" ", "-")


_DXF_IN_MM = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n9\n$MEASUREMENT\n70\n1\n0\nENDSEC\n"


def dxf_in_mm(text: str) -> str:
    """A DXF without a header, with one that says that it is in millimetres: who reads it does not have to ask.

    Examples
    --------
    >>> dxf_in_mm("0\\nSECTION\\n2\\nENTITIES\\n").count("SECTION")
    2
    """
    return _DXF_IN_MM + text
