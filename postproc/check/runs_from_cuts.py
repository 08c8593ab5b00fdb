"""A plan's cuts as torch-on paths, made here from the contour and the leads alone, with what is wrong with them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely import ops

from kerfwise.encoder.cut import Cut, CutSequence, Span, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.rule import Violation

from .covering.free import at_tabs
from .program_rules import tolerance_mm
from .rings import rings_of, torch_rings
from .torch_run import TorchRun, every_line_of
from .totals import end_of


def runs_from_cuts(nest: Nest, cuts: CutSequence, kerf_mm: float) -> tuple[tuple[TorchRun, ...], tuple[Violation, ...]]:
    """The torch-on path of every new cut of a known contour, and where leads do not join what they should."""
    new = enumerate(cuts.new, cuts.made + 1)
    known = [(k, cut, nest.contour(cut.contour)) for k, cut in new if cut.contour in nest.index]
    of_nest = rings_of(nest, kerf_mm)
    runs: list[TorchRun] = []
    violations: list[Violation] = []
    leads_in, leads_out = (
        every_line_of([c.lead_in for _, c, _ in known]),
        every_line_of([c.lead_out for _, c, _ in known]),
    )
    for (position, cut, contour), lead_in, lead_out in zip(known, leads_in, leads_out, strict=True):
        ring, faults = of_nest[nest.index[cut.contour]], []
        if ring is None:
            faults.append(("contour-geometry", f"the kerf of {kerf_mm:g} mm leaves nothing of {contour.id} to follow"))
            ring = contour.curve.line()
        join = _join(cut, ring)
        faults += list(_faults(cut, contour, ring, join, kerf_mm))
        if cut.linked:
            faults += list(_unlinked(nest, cut, cuts[position - 2] if position > cuts.made + 1 else None, kerf_mm))
        if cut.span is not None and contour.encloses:
            faults += list(_off_span(cut, contour, cut.span, ring, join, kerf_mm))
            ring = _stretch(ring, join, cut.span.end, cut.direction == "ccw")
        where, marks, partial = f"cut {position}", contour.kind == "mark", cut.span is not None
        off = unlit_tabs(cut, kerf_mm) if contour.encloses else ()
        faults += list(_faults_of_tabs(cut, off, ring, join, kerf_mm))
        runs.append(TorchRun(position, where, contour, lead_in, ring, lead_out, marks, cut.linked, partial, off))
        violations += [Violation(rule, (contour.id,), f"{where}: {text}", (position,)) for rule, text in faults]
    return tuple(runs), tuple(violations)


def unlit_tabs(cut: Cut, kerf_mm: float) -> tuple[Tab, ...]:
    """The tabs of a cut, as wide as the torch is off over them: the kerf comes off the metal at both ends."""
    return tuple(Tab(tab.at, tab.width_mm + kerf_mm) for tab in cut.tabs)


def _ends_at_tab(cut: Cut, off: Sequence[Tab], ring: shapely.LineString, kerf_mm: float) -> bool:
    """Whether the torch goes off where a tab begins, without a lead-out."""
    if not off or cut.lead_out is None or cut.lead_out.length_mm > 0:
        return False
    end_mm = ring.project(shapely.Point(_xy(cut.lead_out, 0)))
    ends = at_tabs(ring, off, 0.0).ravel()
    apart = np.abs((ends - end_mm + ring.length / 2) % ring.length - ring.length / 2)
    return bool(len(ends) and apart.min() <= tolerance_mm(kerf_mm))


def _faults_of_tabs(
    cut: Cut, off: Sequence[Tab], ring: shapely.LineString, join: Point, kerf_mm: float
) -> Iterator[tuple[str, str]]:
    """Tabs where the torch joins the contour: nothing would lead to it."""
    if not off:
        return
    joined_mm, allowed = ring.project(shapely.Point(join)), tolerance_mm(kerf_mm)
    for low, high in at_tabs(ring, off, -allowed).tolist():
        if low < joined_mm < high:
            yield "contour-geometry", f"{cut.contour}: the torch joins it in a tab"


def _unlinked(nest: Nest, cut: Cut, before: Cut | None, kerf_mm: float) -> Iterator[tuple[str, str]]:
    """What keeps a cut from being linked with the one before."""
    if before is None:
        yield "contour-geometry", f"{cut.contour}: there is no cut before, to be linked with"
    elif (apart_mm := math.dist(end_of(nest, before), cut.pierce)) > tolerance_mm(kerf_mm):
        text = f"the link begins {apart_mm:.3f} mm from where {before.contour} ends"
        yield "contour-geometry", f"{cut.contour}: {text}"


def _off_span(
    cut: Cut, contour: Contour, span: Span, ring: shapely.LineString, join: Point, kerf_mm: float
) -> Iterator[tuple[str, str]]:
    """What is wrong with the ends of the stretch that a cut follows."""
    if math.dist(span.begin, join) > tolerance_mm(kerf_mm):
        yield "contour-geometry", f"{contour.id}: the span does not begin where the torch joins"
    if (off_mm := ring.distance(shapely.Point(span.end))) > tolerance_mm(kerf_mm):
        yield "contour-geometry", f"{contour.id}: the span ends {off_mm:.3f} mm off where the kerf asks for it"
    if cut.lead_out is None:
        yield "contour-geometry", f"{contour.id}: a cut with a span says with its lead-out where it ends"


def _stretch(ring: shapely.LineString, join: Point, end: Point, ccw: bool) -> shapely.LineString:
    """The stretch of a ring from where the torch joins it to a point of it, the way the cut goes."""
    if shapely.is_ccw(shapely.LinearRing(ring.coords)) != ccw:
        ring = ring.reverse()
    low, high = (float(ring.project(shapely.Point(at))) for at in (join, end))
    line = shapely.LineString(ring.coords)
    if low <= high:
        return ops.substring(line, low, high)
    rows = [ops.substring(line, a, b).coords for a, b in ((low, line.length), (0.0, high)) if b > a]
    return shapely.LineString([point for row in rows for point in row])


def _join(cut: Cut, ring: shapely.LineString) -> Point:
    """Where the torch joins the contour: the end of the lead-in, else the start of the lead-out, else at the entry.

    A link that goes nowhere, and a stretch without a lead-in, begin where the torch is.
    """
    if cut.lead_in is not None:
        return _xy(cut.lead_in, -1)
    if cut.linked or cut.span is not None or cut.tabs:
        return cut.pierce
    if cut.lead_out is not None:
        return _xy(cut.lead_out, 0)
    x, y = ops.nearest_points(ring, shapely.Point(cut.entry))[0].coords[0]
    return x, y


def _faults(
    cut: Cut, contour: Contour, ring: shapely.LineString, join: Point, kerf_mm: float
) -> Sequence[tuple[str, str]]:
    allowed = tolerance_mm(kerf_mm)
    found: list[tuple[str, str]] = []

    def geometry(text: str) -> None:
        found.append(("contour-geometry", f"{contour.id}: {text}"))

    off_mm = contour.curve.project(cut.entry)[1]
    if off_mm > allowed:
        geometry(f"the entry is {off_mm:.3f} mm off the contour")
    if cut.lead_in is not None and math.dist(_xy(cut.lead_in, 0), cut.pierce) > allowed:
        geometry("the lead-in does not start at the pierce")
    if not contour.shapes_part:
        if cut.lead_in is not None and cut.lead_in.segments:
            geometry(f"a {contour.kind if contour.kind == 'mark' else 'scrap line'} has no lead-in")
        begins = cut.entry if contour.curve.closed else _xy(contour.curve, 0 if cut.direction == "ccw" else -1)
        if math.dist(cut.pierce, begins) > allowed:
            geometry(f"{'marking' if contour.kind == 'mark' else 'the torch'} does not start where the line does")
        return found
    if contour.kind == "slit":
        begins = cut.pierce if cut.lead_in is None else _xy(cut.lead_in, -1)
        if cut.direction != "ccw" or math.dist(begins, _xy(contour.curve, 0)) > allowed:
            geometry("a slit is cut from its mouth on")
        return found
    start = cut.pierce if cut.lead_in is None else join
    off_mm = shapely.Point(start).distance(ring)
    if off_mm > allowed:
        other = torch_rings([contour], kerf_mm, "wrong")[0]
        if other is not None and shapely.Point(start).distance(other) <= allowed:
            side = "inside" if contour.kind == "outer" else "outside"
            found.append(("kerf-side", f"the torch joins {contour.id} {side}, so that the kerf is on the part's side"))
        else:
            geometry(f"the torch joins {off_mm:.3f} mm off where the kerf asks for it")
    if math.dist(join, cut.entry) > kerf_mm + allowed:
        geometry(f"the torch joins {math.dist(join, cut.entry):.3f} mm from the entry")
    at_tab = _ends_at_tab(cut, unlit_tabs(cut, kerf_mm), ring, kerf_mm)
    if cut.lead_out is not None and cut.span is None and not at_tab and math.dist(_xy(cut.lead_out, 0), join) > allowed:
        geometry("the lead-out does not start where the round ends")
    return found


def _xy(curve: Curve, k: int) -> Point:
    x, y = curve.vertices[k, :2].tolist()
    return x, y
