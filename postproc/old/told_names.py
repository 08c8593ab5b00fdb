"""The names that a program of kerfwise gives its contours, for the nest that is told from its burns."""

from __future__ import annotations

import re
from dataclasses import replace

from kerfwise.encoder.nest import Contour, Part
from kerfwise.postproc.check.reader.program import Burn

from .contours import Told

_CUT = re.compile(r"(?:CUT|MARK) \d+ (?P<contour>.+?) ZONE \d+\b.*", re.IGNORECASE)
_ID = re.compile(r"(?P<part>.+)\.(?P<kind>outer|hole|mark)(?P<number>\d*)")


def named_as_told(told: Told, burns: tuple[Burn, ...]) -> Told | None:
    """The same nest with the names of the program's comments; None where these do not fit what the burns cut."""
    names: dict[str, str] = {}
    for contour in told.nest.contours:
        found = _CUT.fullmatch(burns[told.burn_of[contour.id]].comment)
        parsed = _ID.fullmatch(found["contour"]) if found else None
        if found is None or parsed is None or parsed["kind"] != contour.kind:
            return None
        names[contour.id] = found["contour"]
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
