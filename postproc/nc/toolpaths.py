"""The torch-on paths of a whole plan, in its order, as its program will follow them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely

from kerfwise.encoder.bevels.cut_nest import bevelled
from kerfwise.encoder.bevels.tilted_path import TiltedPath
from kerfwise.encoder.cut import Cut, Span, Tab
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.torch_path import compensated, torch_way
from kerfwise.models.plan.plan import Plan, PlannedCut
from kerfwise.models.plan.read_plan import expect_plan_of
from kerfwise.rules.profile.technique import Technique

SHA_DIGITS = 12


@dataclass(frozen=True, eq=False, slots=True)
class Toolpath:
    """One cut of the plan with its whole path; `edge_start` where it pierces nothing: at an edge, or in an old kerf.

    One that is `pierced` begins at a hole that was pierced in a pass before.
    The torch follows it at `feed_share` of the cut feed, unlit along the stretches `unlit`, mm from its start.
    A contour with a bevel is cut in `passes`; `path` is then that of the last one, at its root, without loops.
    """

    planned: PlannedCut
    path: Curve
    marks: bool
    edge_start: bool
    feed_share: float = 1.0
    unlit: tuple[tuple[float, float], ...] = ()
    pierced: bool = False
    together: tuple[PlannedCut, ...] = ()
    passes: tuple[TiltedPath, ...] = ()

    @property
    def small_hole_share(self) -> float:
        """The share of the cut feed that its contour's size alone allows, where it is cut in passes."""
        if self.passes[0].aside_mm is not None:
            return self.feed_share / min(one.feed_share for one in self.passes)
        last = self.passes[-1]
        return self.feed_share / (last.feed_share if last.steady else 1.0)

    @property
    def pieces(self) -> tuple[Curve, ...]:
        """The path taken apart where the torch goes off and on again over tabs: lit and unlit pieces, in turn."""
        if not self.unlit:
            return (self.path,)
        ends = [0.0, *(mm for stretch in self.unlit for mm in stretch), self.path.length_mm]
        return tuple(self.path.between(low, high - low) for low, high in pairwise(ends))

    @property
    def linked(self) -> bool:
        """Whether it begins where the path before ends, with the torch on."""
        return self.planned.cut.linked


def toolpaths(plan: Plan, nest: Nest, profile: Technique) -> tuple[Toolpath, ...]:
    """The paths of all cuts of the first torch, each with the cuts that further torches make `together` with it.

    Raises InputError if the plan was made from another nest.
    """
    nest = profile.as_cut(nest)
    expect_same_nest(plan, nest)
    first = [planned for planned in plan.burns if planned.cut.torch == 1]
    others: dict[str, list[PlannedCut]] = {}
    for planned in plan.cuts:
        if planned.cut.torch > 1:
            others.setdefault(planned.cut.together, []).append(planned)
    edge_starts = outside(nest, [p.cut.pierce for p in first])
    bevelling = profile.bevelling_of(nest)
    drawn = {} if bevelling is None else {contour.id: contour for contour in bevelled(nest)}
    paths, pierced = [], {pierce.contour for pierce in plan.pierces}
    for planned, edge_start in zip(first, edge_starts, strict=True):
        contour = nest.contour(planned.cut.contour)
        cut, kerf_mm = _as_filed(planned.cut), profile.material.kerf_mm
        path, unlit = torch_path(contour, cut, kerf_mm), unlit_on(contour, cut, kerf_mm)
        in_kerf = planned.cut.span is not None and not planned.cut.way
        unpierced = edge_start or (in_kerf and profile.kerf_starts)
        edge_start = unpierced and not planned.cut.linked
        mark, hole = contour.kind == "mark", planned.cut.contour in pierced
        together = tuple(others.get(planned.cut.contour, ()))
        passes: tuple[TiltedPath, ...] = ()
        if bevelling is not None and contour.id in drawn:
            passes = bevelling.passes_of(drawn[contour.id], cut)
        paths.append(Toolpath(planned, path, mark, edge_start, contour.feed_share, unlit, hole, together, passes))
    return tuple(paths)


def outside(nest: Nest, points: list[Point]) -> list[bool]:
    """Whether each point lies outside the sheet, where there is nothing to pierce."""
    shapely.prepare(nest.sheet.polygon)
    inside = shapely.contains_xy(nest.sheet.polygon, [x for x, _ in points], [y for _, y in points])
    return [not bool(i) for i in inside]


def expect_same_nest(plan: Plan, nest: Nest) -> None:
    """Refuse a plan that was made from another nest.

    Raises InputError with both sums of bytes, or the contours that the nest does not have.
    """
    sha = plan.nest.get("sha256", "")
    if sha and nest.sha256 and sha != nest.sha256:
        raise InputError(
            f"the plan was made from another nest: its sha256 begins {sha[:SHA_DIGITS]}, that of {nest.file} "
            f"{nest.sha256[:SHA_DIGITS]}; solve again or give the nest it was made from"
        )
    expect_plan_of(plan, nest, once=False)  # a program of it can be written, and the check finds what is cut twice


def _as_filed(cut: Cut) -> Cut:
    """The cut as a plan file holds it: to 6 decimals."""

    def rounded(lead: Curve | None) -> Curve | None:
        return None if lead is None else Curve(np.round(lead.vertices, 6), lead.closed)

    x, y = cut.pierce
    tabs = tuple(Tab((round(tab.at[0], 6), round(tab.at[1], 6)), round(tab.width_mm, 6)) for tab in cut.tabs)
    pierce = (round(x, 6), round(y, 6))
    span = None if cut.span is None else Span(_rounded(cut.span.begin), _rounded(cut.span.end))
    lead_in, lead_out = rounded(cut.lead_in), rounded(cut.lead_out)
    return replace(cut, pierce=pierce, lead_in=lead_in, lead_out=lead_out, span=span, tabs=tabs)


def _rounded(at: Point) -> Point:
    return round(at[0], 6), round(at[1], 6)


# The whole path of the torch's centre for one cut, from where it is switched on to where it goes off.

_SPECK_MM = 3e-6
"""Plans are written to 6 decimals: nothing shorter than this is a move."""


def torch_path(contour: Contour, cut: Cut, kerf_mm: float) -> Curve:
    """Lead-in, once round the kerf-compensated contour in the cut's direction, lead-out; arcs stay arcs.

    A cut with a span goes along that stretch of it alone.

    Parameters
    ----------
    contour
        The contour that `cut` is of.
    cut
        Its leads may be rounded to 6 decimals, as plans are written.
    kerf_mm
        Width of the kerf.

    Returns
    -------
    Open curve without segments of no length. An open mark is followed along its line ("ccw") or against it ("cw"), a
    closed one once round from its entry; a slit along its line from the end of its lead-in. Over tabs the path goes on,
    see `unlit_on`; before one at the end of the round it ends.

    Raises InputError if the kerf leaves nothing of the contour to cut.

    Examples
    --------
    >>> hole = Contour("P.hole1", "P", "hole", Curve.of([(0, 0), (10, 0), (10, 10), (0, 10)]))
    >>> lead_in = Curve.of([(5, 4), (5, 1)], closed=False)
    >>> torch_path(hole, Cut("P.hole1", (5, 0), "ccw", (5, 4), lead_in), 2.0).as_rows()
    [[5.0, 4.0], [5.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 9.0], [1.0, 1.0], [5.0, 1.0]]
    """
    if not contour.curve.closed:
        line = contour.curve if cut.direction == "ccw" else contour.curve.reversed()
        return line if cut.lead_in is None else _joined((cut.lead_in, line))
    ring = compensated(contour, kerf_mm).towards(cut.direction)
    way, _ = torch_way(ring, cut.join, cut.span, cut.tabs, kerf_mm)
    return _joined(path for path in (cut.lead_in, way, cut.lead_out) if path is not None)


def unlit_on(contour: Contour, cut: Cut, kerf_mm: float) -> tuple[tuple[float, float], ...]:
    """The stretches of the torch's path that it makes unlit, over tabs, mm from where it starts."""
    if not cut.tabs:
        return ()
    ring = compensated(contour, kerf_mm).towards(cut.direction)
    _, gaps = torch_way(ring, cut.join, cut.span, cut.tabs, kerf_mm)
    before_mm = 0.0 if cut.lead_in is None else cut.lead_in.length_mm
    return tuple((before_mm + low, before_mm + high) for low, high in gaps)


def _joined(paths: Iterable[Curve]) -> Curve:
    """One open path of several that follow each other; from the end of each a line leads to the next."""
    rows: list[list[float]] = []
    for path in paths:
        rows += path.vertices.tolist()
        rows[-1][2] = 0.0
    kept = [a for a, b in pairwise(rows) if math.dist(a[:2], b[:2]) > _SPECK_MM]
    return Curve(np.array([*kept, rows[-1]]), closed=False)
