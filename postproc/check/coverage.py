"""Every contour once, and nothing else."""

from __future__ import annotations

from ...encoder.cut import Cut, CutSequence
from ...encoder.nest import Nest
from ...rules.rule import Violation

_RULE = "every-contour-once"


def coverage(nest: Nest, cuts: CutSequence) -> list[Violation]:
    """Contours left out, cut again, or not in the nest."""
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
    for contour in nest.contours:
        if contour.id not in first:
            found.append(Violation(_RULE, (contour.id,), f"{contour.id} is not {_done(contour.kind)}"))
    return found


def _done(kind: str) -> str:
    return "marked" if kind == "mark" else "cut"


def once_each(nest: Nest, cuts: CutSequence) -> CutSequence:
    """The cuts that rules can judge: those of the nest's contours, each the first time it is cut."""
    kept: dict[str, Cut] = {}
    for cut in cuts:
        if cut.contour in nest.index:
            kept.setdefault(cut.contour, cut)
    return CutSequence(tuple(kept.values()), cuts.start_side, cuts.home)
