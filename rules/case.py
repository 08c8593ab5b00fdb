"""A case of a rule: a tiny nest, cuts in order, and the violations to the letter."""

from __future__ import annotations

from collections.abc import Mapping
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
