"""A case of a rule: a tiny nest built by hand, cuts in order, and the violations to the letter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from kerfwise.encoder.cut import Cut, CutSequence, Side
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Contour, Nest, Part, Sheet, as_scrap
from kerfwise.rules.judging.violation import Violation

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


# Small nests built by hand, for the cases of rules, for tests and for trying things out.

Rows = Sequence[Sequence[float]]


def rect(x: float, y: float, w: float, h: float) -> Rows:
    """A rectangle's vertices, counter-clockwise from its lower left corner."""
    return [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]


def circle(cx: float, cy: float, r: float) -> Rows:
    """A circle as two half-circle arcs."""
    return [(cx - r, cy, 1.0), (cx + r, cy, 1.0)]


def part(name: str, outer: Rows, holes: Sequence[Rows] = (), marks: Sequence[Rows] = ()) -> Part:
    """A part with contour ids as a reader gives them; marks are open lines."""
    return Part(
        name,
        Contour(f"{name}.outer", name, "outer", Curve.of(outer)),
        tuple(Contour(f"{name}.hole{k}", name, "hole", Curve.of(h)) for k, h in enumerate(holes, 1)),
        tuple(Contour(f"{name}.mark{k}", name, "mark", Curve.of(m, closed=False)) for k, m in enumerate(marks, 1)),
    )


def nest(width: float, height: float, *parts: Part, scrap: Sequence[Rows] = ()) -> Nest:
    """A rectangular sheet at the origin with these parts, and with these lines to cut up its skeleton."""
    return Nest(Sheet.rectangle(width, height), parts, scrap=scrap_lines(scrap))


def scrap_lines(lines: Sequence[Rows]) -> tuple[Contour, ...]:
    """Scrap lines with ids as a reader gives them."""
    return as_scrap(Curve.of(line, closed=False) for line in lines)
