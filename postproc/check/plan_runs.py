"""A plan's cuts as torch-on paths, and what a program that goes on after a stop says is already cut."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import ops
from shapely.ops import substring

from kerfwise.encoder.cut import Cut, CutSequence, Direction, Span, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.rules.judging.violation import Violation

from .plan_conformance import end_of
from .result import ids_by_name, normalize_name
from .ring_coverage import complement, tab_intervals
from .torch_run import TorchRun, every_line_of, rings_of, tolerance_mm, torch_rings


def runs_from_cuts(nest: Nest, cuts: CutSequence, kerf_mm: float) -> tuple[tuple[TorchRun, ...], tuple[Violation, ...]]:
    """The torch-on path of every new cut of a known contour, and where leads do not join what they should.

    A cut that leaves its contour unfinished has no position of its own.
    """
    burns = cuts.new_burns
    earlier = dict(zip((id(cut) for _, cut in burns), [None, *(cut for _, cut in burns)], strict=False))
    known = [(k, cut, nest.contour(cut.contour)) for k, cut in burns if cut.contour in nest.index]
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
            faults += list(_unlinked(nest, cut, earlier[id(cut)], kerf_mm))
        if cut.span is not None and contour.encloses:
            faults += list(_off_span(cut, contour, cut.span, ring, join, kerf_mm))
            ring = _stretch(ring, join, cut.span.end, cut.direction == "ccw")
        marks, partial, where = contour.kind == "mark", cut.span is not None, f"cut {position}"
        if not cuts.finishes(position, cut):
            where, position = f"the stretch of {cut.way} before cut {position}", 0
        off = unlit_tabs(cut, kerf_mm) if contour.encloses else ()
        faults += list(_faults_of_tabs(cut, off, ring, join, kerf_mm))
        runs.append(TorchRun(position, where, contour, lead_in, ring, lead_out, marks, cut.linked, partial, off))
        at = (position,) if position else ()
        violations += [Violation(rule, (contour.id,), f"{where}: {text}", at) for rule, text in faults]
    return tuple(runs), tuple(violations)


def unlit_tabs(cut: Cut, kerf_mm: float) -> tuple[Tab, ...]:
    """The tabs of a cut, as wide as the torch is off over them: the kerf comes off the metal at both ends."""
    return tuple(Tab(tab.at, tab.width_mm + kerf_mm) for tab in cut.tabs)


def _ends_at_tab(cut: Cut, off: Sequence[Tab], ring: shapely.LineString, kerf_mm: float) -> bool:
    """Whether the torch goes off where a tab begins, without a lead-out."""
    if not off or cut.lead_out is None or cut.lead_out.length_mm > 0:
        return False
    end_mm = ring.project(shapely.Point(cut.lead_out.start))
    ends = tab_intervals(ring, off, 0.0).ravel()
    apart = np.abs((ends - end_mm + ring.length / 2) % ring.length - ring.length / 2)
    return bool(len(ends) and apart.min() <= tolerance_mm(kerf_mm))


def _faults_of_tabs(
    cut: Cut, off: Sequence[Tab], ring: shapely.LineString, join: Point, kerf_mm: float
) -> Iterator[tuple[str, str]]:
    """Tabs where the torch joins the contour: nothing would lead to it."""
    if not off:
        return
    joined_mm, allowed = ring.project(shapely.Point(join)), tolerance_mm(kerf_mm)
    for low, high in tab_intervals(ring, off, -allowed).tolist():
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
    if cut.lead_in is not None or cut.linked or cut.span is not None or cut.tabs:
        return cut.join
    if cut.lead_out is not None:
        return cut.lead_out.start
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
    if cut.lead_in is not None and math.dist(cut.lead_in.start, cut.pierce) > allowed:
        geometry("the lead-in does not start at the pierce")
    if not contour.shapes_part:
        if cut.lead_in is not None and cut.lead_in.segments:
            geometry(f"a {contour.kind if contour.kind == 'mark' else 'scrap line'} has no lead-in")
        curve = contour.curve
        begins = cut.entry if curve.closed else curve.start if cut.direction == "ccw" else curve.end
        if math.dist(cut.pierce, begins) > allowed:
            geometry(f"{'marking' if contour.kind == 'mark' else 'the torch'} does not start where the line does")
        return found
    if contour.kind == "slit":
        begins = cut.join
        if cut.direction != "ccw" or math.dist(begins, contour.curve.start) > allowed:
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
    if cut.lead_out is not None and cut.span is None and not at_tab and math.dist(cut.lead_out.start, join) > allowed:
        geometry("the lead-out does not start where the round ends")
    return found


# What a program that goes on after a stop says is already cut: comments such as `OUT 3 P1.outer ZONE 1 CW PIERCE 8
# 3`.
#
# What these say is taken for granted: nobody can see at the desk what lies on the table.

_RULE = "every-contour-once"
_NUMBER = r"-?\d+(?:\.\d+)?"
_RESUME = re.compile(r"RESUME AFTER CUT (?P<made>\d{1,9})(?:, CUT \d+ AGAIN)?", re.IGNORECASE)
_OUT = re.compile(
    rf"(?P<how>OUT|BROKEN) (?P<order>\d{{1,9}}) (?P<contour>.+) ZONE (?P<zone>\d{{1,9}}) (?P<way>CW|CCW) "
    rf"PIERCE (?P<x>{_NUMBER}) (?P<y>{_NUMBER})",
    re.IGNORECASE,
)
_LEAD = re.compile(
    r"(?P<how>OUT|BROKEN|BEGUN) (?P<order>\d{1,9}) (?P<what>LEAD|LINK) (?P<which>IN|OUT) "
    rf"(?P<rows>{_NUMBER}(?: {_NUMBER})*)",
    re.IGNORECASE,
)
_TAB = re.compile(
    rf"(?P<how>OUT|BROKEN) (?P<order>\d{{1,9}}) TAB (?P<x>{_NUMBER}) (?P<y>{_NUMBER}) (?P<width>{_NUMBER})",
    re.IGNORECASE,
)
_BEGUN = re.compile(
    r"BEGUN (?P<order>\d{1,9}) BEFORE (?P<before>\d{1,9}) (?P<contour>.+) ZONE (?P<zone>\d{1,9}) (?P<way>CW|CCW) "
    rf"FROM (?P<x0>{_NUMBER}) (?P<y0>{_NUMBER}) TO (?P<x1>{_NUMBER}) (?P<y1>{_NUMBER})",
    re.IGNORECASE,
)
_LeadKey = tuple[str, int, str]
_SLIT = re.compile(r"\.slit\d+$", re.IGNORECASE)


@dataclass(frozen=True, eq=False, slots=True)
class ResumeState:
    """The cuts made before, in order, the one that broke off, and what is wrong with how they are told."""

    cuts: tuple[Cut, ...] = ()
    broken_off: Cut | None = None
    violations: tuple[Violation, ...] = ()
    begun: tuple[tuple[int, Cut], ...] = ()


def read_resumed(nest: Nest, comments: Iterable[str]) -> ResumeState:
    """What the comments of a program say of the cuts before its first."""
    lines = list(comments)
    after = next((int(found["made"]) for found in map(_RESUME.fullmatch, lines) if found), None)
    if after is None:
        return ResumeState()
    ids = ids_by_name(nest, lines)
    leads, linked = _leads(lines)
    tabs: dict[tuple[str, int], tuple[Tab, ...]] = defaultdict(tuple)
    for found in filter(None, map(_TAB.fullmatch, lines)):
        tab = Tab((float(found["x"]), float(found["y"])), float(found["width"]))
        tabs[found["how"].upper(), int(found["order"])] += (tab,)
    cuts: dict[int, Cut] = {}
    broken_off: Cut | None = None
    wrong: list[str] = []
    for found in filter(None, map(_OUT.fullmatch, lines)):
        order, how, name = int(found["order"]), found["how"].upper(), ids.get(normalize_name(found["contour"]))
        if name is None:
            wrong.append(f"cut {order} is said to be of {found['contour']}, which the nest does not have")
            continue
        lead_in, lead_out = (leads.get((how, order, which)) for which in ("IN", "OUT"))
        pierce = (float(found["x"]), float(found["y"]))
        cut = Cut(
            name, nest.contour(name).curve.nearest(pierce if lead_in is None else lead_in.end), _way(found["way"]),
            pierce, lead_in, lead_out, int(found["zone"]), linked=(how, order, "IN") in linked, tabs=tabs[how, order],
        )  # fmt: skip
        if how == "BROKEN":
            broken_off = cut
        else:
            cuts[order] = cut
    if sorted(cuts) != list(range(1, after + 1)):
        wrong.append(f"it goes on after cut {after}, but lists {len(cuts)} cuts that are out")
    begun: list[tuple[int, Cut]] = []
    for found in filter(None, map(_BEGUN.fullmatch, lines)):
        order, name = int(found["order"]), ids.get(normalize_name(found["contour"]))
        if name is None:
            wrong.append(f"a stretch is said to be of {found['contour']}, which the nest does not have")
            continue
        begin, end = ((float(found[f"x{k}"]), float(found[f"y{k}"])) for k in (0, 1))
        lead_in, curve = leads.get(("BEGUN", order, "IN")), nest.contour(name).curve
        cut = Cut(
            name, curve.nearest(begin), _way(found["way"]),
            begin if lead_in is None else lead_in.start, lead_in, Curve.of([end], closed=False), int(found["zone"]),
            linked=("BEGUN", order, "IN") in linked, span=Span(begin, end),
        )  # fmt: skip
        begun.append((int(found["before"]), cut))
    violations = tuple(Violation(_RULE, (), text) for text in wrong)
    return ResumeState(tuple(cuts[k] for k in sorted(cuts)), broken_off, violations, tuple(begun))


@dataclass(frozen=True, eq=False, slots=True)
class BurntBefore:
    """What cuts before a stop have burnt: the ways round their contours, but for tabs, and other lines, as leads are.

    `out` are the ids of the contours that they cut.
    """

    rounds: tuple[shapely.LineString, ...] = ()
    others: tuple[shapely.LineString, ...] = ()
    out: frozenset[str] = frozenset()

    @property
    def lines(self) -> tuple[shapely.LineString, ...]:
        """All that is burnt."""
        return (*self.rounds, *self.others)


NOTHING_BURNT = BurntBefore()


def burnt_before(nest: Nest, cuts: Sequence[Cut], kerf_mm: float, begun: Sequence[tuple[int, Cut]] = ()) -> BurntBefore:
    """What cuts before a stop have burnt, those among `begun` too that came before the last of them."""
    rows = [(c, cut) for cut in cuts if cut.contour in nest.index and (c := nest.contour(cut.contour)).kind != "mark"]
    rings = torch_rings([contour for contour, _ in rows], kerf_mm)
    rounds: list[shapely.LineString] = []
    others = [lead.line() for cut in cuts for lead in (cut.lead_in, cut.lead_out) if lead is not None and lead.segments]
    for (contour, cut), ring in zip(rows, rings, strict=True):
        if ring is not None:
            (rounds if contour.encloses else others).extend(_lit(ring, cut, kerf_mm))
    for cut in (cut for k, cut in begun if k <= len(cuts) and cut.span is not None and cut.contour in nest.index):
        ring = torch_rings([nest.contour(cut.contour)], kerf_mm)[0]
        if ring is not None and cut.span is not None:
            others.append(_stretch(ring, cut.span.begin, cut.span.end, cut.direction == "ccw"))
        if cut.lead_in is not None and cut.lead_in.segments:
            others.append(cut.lead_in.line())
    return BurntBefore(tuple(rounds), tuple(others), frozenset(contour.id for contour, _ in rows))


def _lit(ring: shapely.LineString, cut: Cut, kerf_mm: float) -> Iterator[shapely.LineString]:
    """What of a contour's ring is burnt: all of it but for the tabs of its cut."""
    if not cut.tabs:
        yield ring
        return
    off = tab_intervals(ring, unlit_tabs(cut, kerf_mm), 0.0)
    yield from (substring(ring, low, high) for low, high in complement(off, ring.length).tolist())


def slit_ends(comments: Iterable[str]) -> Iterator[tuple[str, Point, Point]]:
    """Name, where its lead-in ends and where the torch went off, of each slit that comments say is already cut."""
    lines = list(comments)
    leads, _ = _leads(lines)
    for found in filter(None, map(_OUT.fullmatch, lines)):
        name = found["contour"]
        lead_in, lead_out = (leads.get(("OUT", int(found["order"]), which)) for which in ("IN", "OUT"))
        if found["how"].upper() == "OUT" and _SLIT.search(name) and lead_out is not None:
            pierce = (float(found["x"]), float(found["y"]))
            yield name, pierce if lead_in is None else lead_in.end, lead_out.end


def _way(word: str) -> Direction:
    return "cw" if word.upper() == "CW" else "ccw"


def _leads(lines: Iterable[str]) -> tuple[dict[_LeadKey, Curve], set[_LeadKey]]:
    """The leads that comments tell, by whose they are, its number, and in or out; and which of them are links."""
    rows: dict[_LeadKey, list[float]] = defaultdict(list)
    linked: set[_LeadKey] = set()
    for found in filter(None, map(_LEAD.fullmatch, lines)):
        key = found["how"].upper(), int(found["order"]), found["which"].upper()
        rows[key] += map(float, found["rows"].split())
        linked |= {key} if found["what"].upper() == "LINK" else set()
    whole = {key: numbers for key, numbers in rows.items() if len(numbers) % 3 == 0}  # x, y and bulge of each vertex
    return {key: Curve(np.array(numbers).reshape(-1, 3), closed=False) for key, numbers in whole.items()}, linked
