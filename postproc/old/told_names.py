"""The names that a program of kerfwise gives its contours, for the nest that is told from its burns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest

from kerfwise.encoder.nest import Contour, Part

from .contours import Told

_CUT = re.compile(r"(?:CUT|MARK) \d+ (?P<contour>.+?) ZONE \d+\b.*", re.IGNORECASE)
_ID = re.compile(r"(?P<part>.+)\.(?P<kind>outer|hole|mark)(?P<number>\d*)")


def named_as_told(told: Told, comments: Sequence[str]) -> Told | None:
    """The same nest with the names of the program's comments; None where these do not fit what the burns cut.

    Each contour that is cut has a comment, in their order, also where one burn cuts several.
    """
    ordered = sorted(told.burn_of, key=lambda contour_id: told.burn_of[contour_id])  # those of one burn in its order
    found = [parsed for text in comments if (parsed := _CUT.fullmatch(text)) is not None]
    names: dict[str, str] = {}
    for contour_id, words in zip_longest(ordered, found):
        parsed = None if words is None else _ID.fullmatch(words["contour"])
        if contour_id is None or parsed is None or parsed["kind"] != told.nest.contour(contour_id).kind:
            return None
        names[contour_id] = words["contour"]
    if len(set(names.values())) != len(names):
        return None
    parts = []
    for part in told.nest.parts:
        named = {_ID.fullmatch(names[contour.id])["part"] for contour in part}  # type: ignore[index]
        if len(named) != 1:
            return None
        parts.append(_named(part, named.pop(), names))
    if len({part.id for part in parts}) != len(parts):
        return None
    burn_of = {names[contour_id]: k for contour_id, k in told.burn_of.items()}
    round_of = {names[contour_id]: ring for contour_id, ring in told.round_of.items()}
    return Told(replace(told.nest, parts=tuple(parts)), burn_of, round_of)


def _named(part: Part, name: str, names: dict[str, str]) -> Part:
    def named(contour: Contour) -> Contour:
        return replace(contour, id=names[contour.id], part=name)

    return replace(
        part, id=name, outer=named(part.outer), holes=tuple(map(named, part.holes)), marks=tuple(map(named, part.marks))
    )
