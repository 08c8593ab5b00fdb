"""A case of a rule: a tiny nest, cuts in order, and the violations to the letter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from kerfwise.encoder.cut import Cut, CutSequence, Side
from kerfwise.encoder.nest import Nest

from .rule import Violation

CaseKind = Literal["passes", "fails", "boundary"]


@dataclass(frozen=True)
class Case:
    """`kind` says what the case shows: a nest that passes, one that fails, or one on the boundary of the rule."""

    name: str
    kind: CaseKind
    nest: Nest
    cuts: CutSequence
    violations: tuple[Violation, ...] = ()
    options: Any = None


def cut(nest: Nest, contour: str, **given: Any) -> Cut:
    """A cut of a contour that enters and pierces at its first point, outer contours clockwise, all others not."""
    found = nest.contour(contour)
    entry = found.curve.point_at(0.0)
    return replace(Cut(contour, entry, "cw" if found.kind == "outer" else "ccw", entry), **given)


def in_order(
    nest: Nest, order: str, start_side: Side | None = None, zones: Mapping[str, int] | None = None
) -> CutSequence:
    """The contours named in `order`, cut one after the other; `zones` gives the zone of each part."""
    of_part = zones or {}
    cuts = (cut(nest, name, zone=of_part.get(nest.contour(name).part, 0)) for name in order.split())
    return CutSequence(tuple(cuts), start_side)


def wrong_and_right(cases: Sequence[Case]) -> tuple[Case | None, Case | None]:
    """A case that fails and one that passes, to be shown together; None where there is none.

    They are of one nest where there are such, with the same options and contours, cut in another way, so that one
    sees what the rule is about; then those with the fewest links, tabs and stretches; then the first.
    """
    fails = [case for case in cases if case.kind == "fails"]
    passes = [case for case in cases if case.kind == "passes"]
    if not fails or not passes:
        return next(iter(fails), None), next(iter(passes), None)
    return min(((a, b) for a in fails for b in passes), key=_hard_to_compare)


def _hard_to_compare(pair: tuple[Case, Case]) -> tuple[bool, bool, bool, bool, int]:
    """Smaller for pairs that are easier to tell apart."""
    wrong, right = pair
    one, other = _seen(wrong), _seen(right)
    same = sorted(row[0] for row in one[2:]) == sorted(row[0] for row in other[2:])
    rare = sum(bool(cut.linked or cut.span or cut.tabs) for case in pair for cut in case.cuts)
    return wrong.nest is not right.nest, one == other, wrong.options != right.options, not same, rare


def _seen(case: Case) -> list[Any]:
    """What a picture shows of the cuts of a case: side and temperatures, then a row of each cut."""
    rows = [
        (cut.contour, cut.direction, cut.entry, cut.pierce, cut.end, cut.zone, cut.linked, cut.tabs, cut.span)
        for cut in case.cuts
    ]
    return [case.cuts.start_side, case.cuts.hot_spots, *rows]
