"""The text of a DXF file before its library reads it: numbers that are none, and names that were written otherwise."""

from __future__ import annotations

import re

from ezdxf.lldxf.encoding import decode_dxf_unicode, has_dxf_unicode

from kerfwise.encoder.errors import InputError

_NUMBER = re.compile(rb"[ \t]*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[ \t]*")
_READ = (b"ENTITIES", b"BLOCKS")
"""Sections that hold what is drawn; headers and objects are full of other things."""


def _is_real(code: int) -> bool:
    """Whether the values of a group code are real numbers."""
    return 10 <= code <= 59 or 110 <= code <= 149 or 210 <= code <= 239 or 1010 <= code <= 1059


def check_numbers(data: bytes) -> None:
    """Refuse a file with a coordinate that is no number: libraries read as far as it looks like one.

    `120,75` would be 120, and a contour a little smaller than it is drawn. Binary files hold no text.

    Raises
    ------
    InputError
        With the line of the first one, the layer, and what was expected.
    """
    if data.startswith(b"AutoCAD Binary DXF"):
        return
    lines = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    section, layer, after_section = b"", b"0", False
    for k in range(0, len(lines) - 1, 2):
        code, value = lines[k].strip(), lines[k + 1]
        if not code.isdigit() and not code.lstrip(b"-").isdigit():
            return  # pairs of lines are out of step: the library says what it makes of that
        number = int(code)
        if number == 0:
            after_section, layer = value.strip() == b"SECTION", b"0"
        elif number == 2 and after_section:
            section, after_section = value.strip(), False
        elif number == 8:
            layer = value.strip()
        elif section in _READ and _is_real(number) and not _NUMBER.fullmatch(value):
            given = value.strip().decode("utf-8", "replace")
            on = name_of(layer.decode("utf-8", "surrogateescape"))
            raise InputError(
                f"{given!r} is no number (group code {number}, on layer '{on}'): expected one such as {_meant(given)}, "
                "with a point and without spaces; export the drawing again with such numbers",
                line=k + 2,
            )


def _meant(given: str) -> str:
    """The number as it should have been written, where that is plain."""
    tried = re.sub(r"[dD](?=[-+]?\d+$)", "E", given.replace(",", ".").replace("#", ""))
    return tried if _NUMBER.fullmatch(tried.encode("utf-8", "replace")) else "120.75"


def name_of(name: str) -> str:
    """A layer's name as its author wrote it: `\\U+XXXX` decoded, and UTF-8 that was read as another code page.

    Examples
    --------
    >>> name_of("\\\\U+0433\\\\U+0440\\\\U+0430\\\\U+0432"), name_of("GravÃ­r"), name_of("Konturteil Ä")
    ('грав', 'Gravír', 'Konturteil Ä')
    """
    decoded = decode_dxf_unicode(name) if has_dxf_unicode(name) else name
    if decoded.isascii():
        return decoded
    for page in ("cp1252", "latin-1", "cp1250", "cp1251"):
        try:
            again = decoded.encode(page, "surrogateescape").decode("utf-8")
        except UnicodeError:
            continue
        return again
    return decoded.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
