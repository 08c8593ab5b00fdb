"""Every contour once, and nothing else."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import replace

from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.nest import Nest
from kerfwise.rules.registry import RULES
from kerfwise.rules.rule import Violation

from .relaxed import Relaxed

_RULE = "every-contour-once"


def coverage(nest: Nest, cuts: CutSequence, relaxed: Sequence[Relaxed] = ()) -> list[Violation]:
    """Contours left out, cut again, or not in the nest.

    One may be left out if the plan says so, naming with it the contour that it lies in, which was cut before a stop.
    """
    found: list[Violation] = []
    first: dict[str, int] = {}
    for position, cut in enumerate(cuts, 1):
        if cut.contour not in nest.index and nest.drawn is not None and cut.contour in nest.drawn.index:
            text = f"cut {position} is of {cut.contour}, which the profile leaves out"
        elif cut.contour not in nest.index:
            text = f"cut {position} is of {cut.contour}, which the nest does not have"
        elif cut.contour in first:
            text = f"{cut.contour} is cut again as cut {position}; it was cut as cut {first[cut.contour]}"
        else:
            first[cut.contour] = position
            continue
        found.append(Violation(_RULE, (cut.contour,), text, (position,)))
    made = {cut.contour for cut in cuts[: cuts.made]}
    of_fallen_metal = {name for name, rule in RULES.items() if rule.of_fallen_metal}
    loose = {r.contours[0] for r in relaxed if r.rule in of_fallen_metal and _dropped(nest, r.contours, made)}
    for contour in nest.contours:
        if contour.id not in first and contour.id not in loose:
            found.append(Violation(_RULE, (contour.id,), f"{contour.id} is not {_done(contour.kind)}"))
    return found


def _dropped(nest: Nest, contours: Sequence[str], made: Set[str]) -> bool:
    """Whether the first of two contours lies inside the second, which is cut through and out."""
    if len(contours) != 2 or not {*contours} <= nest.index.keys() or contours[1] not in made:
        return False
    inner, outer = (nest.contour(name) for name in contours)
    return outer.encloses and bool(outer.polygon.covers(inner.line))


def _done(kind: str) -> str:
    return "marked" if kind == "mark" else "cut"


def once_each(nest: Nest, cuts: CutSequence) -> CutSequence:
    """The cuts that rules can judge: those of the nest's contours, each the first time it is cut."""
    kept: dict[str, Cut] = {}
    made = 0
    for k, cut in enumerate(cuts, 1):
        if cut.contour in nest.index:
            kept.setdefault(cut.contour, cut)
        if k == cuts.made:
            made = len(kept)
    return replace(cuts, cuts=tuple(kept.values()), made=made)
