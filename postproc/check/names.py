"""Names of contours as they survive in a program's comments."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from kerfwise.encoder.nest import Nest

_NAME = re.compile(r"NAME (?P<number>\d{1,9}) (?P<told>\S+) IS (?P<spelt>(?:[A-Za-z0-9.-]|=[0-9A-F]{2})*)")


def folded(name: str) -> str:
    """A contour's id without what a writer replaces: everything but letters, digits and dots.

    Examples
    --------
    >>> folded("Plate (2)-a.hole1")
    'PLATE_2_A.HOLE1'
    """
    return re.sub(r"[^A-Za-z0-9.]+", "_", name).upper()


def ids_by_name(nest: Nest, comments: Iterable[str]) -> Mapping[str, str]:
    """Folded name → contour id: those that the program's comments map (`NAME 1 P-1.outer IS =D0=9F.outer`), and ids.

    A name that two ids fold to is left out: which of them it means nobody can say.
    """
    found: dict[str, str] = {}
    twice: set[str] = set()
    for contour in nest.contours:
        key = folded(contour.id)
        if key in found:
            twice.add(key)
        found[key] = contour.id
    spelt: dict[tuple[int, str], str] = {}
    for words in filter(None, map(_NAME.fullmatch, comments)):
        mapped = (int(words["number"]), words["told"])
        spelt[mapped] = spelt.get(mapped, "") + words["spelt"]
    known = {contour.id for contour in nest.contours}
    kept = {key: name for key, name in found.items() if key not in twice}
    for (_, told), text in spelt.items():
        if (name := _unspelt(text)) in known:
            kept[folded(told)] = name
    return kept


def _unspelt(text: str) -> str:
    data = re.sub(rb"=([0-9A-F]{2})", lambda found: bytes([int(found[1], 16)]), text.encode())
    return data.decode("utf-8", "replace") if b"\xed" not in data else data.decode("utf-8", "surrogatepass")
