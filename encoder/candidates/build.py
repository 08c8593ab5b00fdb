"""All candidates of a nest."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
import shapely

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.scrap import carrying, severed_lines, skeleton
from kerfwise.encoder.torch_path import compensated, unlit_length_mm

from .candidate import Candidate, LeadOptions
from .common_edges import CommonEdges
from .common_paths import common_cut_paths, with_neighbours_in
from .entries import IN_PROFILE, Approaches, Joints, Outline
from .lead_search import LeadAttempt, reachable_candidates, try_leads
from .leads import lead_outs, least_clearance_mm
from .obstacles import BurntArea, Surroundings
from .older_kerfs import OlderKerfs, older_kerfs, resolve_lead_conflicts
from .tab_places import TabPlaces


def build_candidates(nest: Nest, options: LeadOptions) -> tuple[Candidate, ...]:
    """The ways to cut each contour: entries well spread around it, each in every direction allowed.

    A pierce lies in waste and keeps clear of every contour and of the sheet's edges (Petunin 2009, section 2); the kerf
    of a lead touches no contour but its own. Leads keep out of the way of those of other contours, as far as streets
    have room for both, since what is burnt before is void. Where the options allow it, the sheet's outline is stated
    and the machine is known to reach there, edge starts come in from outside that edge besides and pierce nothing.

    Returns
    -------
    Sorted by contour, then by entry along it; the same for the same nest and options.

    Raises InputError for contours that the kerf leaves nothing of, that have no room for a lead, and holes too small to
    be cut: in groups, with the option that frees each.

    Examples
    --------
    >>> from kerfwise.encoder.nest import Contour, Part, Sheet
    >>> square = Contour("P.outer", "P", "outer", Curve.of([(50, 50), (90, 50), (90, 90), (50, 90)]))
    >>> nest = Nest(Sheet.rectangle(200, 200), (Part("P", square),))
    >>> found = build_candidates(nest, LeadOptions(entries=4))
    >>> [(c.entry, c.direction) for c in found][:3]
    [((50.0, 50.0), 'cw'), ((50.0, 50.0), 'ccw'), ((90.0, 50.0), 'cw')]
    """
    return build_with_older_kerfs(nest, options)[0]


def build_with_older_kerfs(nest: Nest, options: LeadOptions) -> tuple[tuple[Candidate, ...], OlderKerfs | None]:
    """The same, and what the candidates meet of cuts made before them; None where the options do not ask for that."""
    return CandidateBuilder(nest, options).build()


class CandidateBuilder:
    """The same of one nest, whichever of its contours are cut along stretches: leads are looked for once for all.

    Of what is `already` cut there are none, nor of what is `loose`; the others pierce, and lead, where there is still
    metal. A cut that broke off is pierced anew beside its old kerf; where there is no room for that, as in a small
    hole, it begins where it began.
    """

    def __init__(
        self, nest: Nest, options: LeadOptions, already: AlreadyCut = NOTHING_CUT, loose: Collection[str] = ()
    ) -> None:
        _check(options, nest)
        if not nest.sheet.stated or options.reach is None or not all(map(math.isfinite, options.reach)):
            options = replace(options, edge_start=False)
        self._nest, self._options, self._already = nest, options, already
        if not nest.contours:
            return
        gone = already.contours.union(loose)
        self._left = left = [k for k, c in enumerate(nest.contours) if c.id not in gone]
        uncuttable = scrap_problems(nest, options.kerf_mm)
        if uncuttable:
            raise InputError(
                "the skeleton cannot be cut up as it is drawn", file=nest.file or None, details=tuple(uncuttable)
            )
        burnt = BurntArea.of(nest, already, options.kerf_mm, options.splash_mm or 0.0)
        self._around = around = Surroundings.of(nest, burnt)
        held = TabPlaces.of(nest, left, options.tabs, options.kerf_mm, options.entry_points)
        self._options = options = replace(options, tab_places=held)
        self._tried = try_leads(nest, left, around, options)
        if spoilt := _spoilt_by_tabs(nest, self._tried, around, options):
            raise InputError(
                "a tab leaves no room to cut a part" if len(spoilt) == 1 else "tabs leave no room to cut parts",
                file=nest.file or None,
                details=spoilt,
            )
        self._again = recut(nest, already.broken_off, self._tried, options.kerf_mm)

    @cached_property
    def _with_leads(self) -> list[Candidate]:
        found = _candidates(self._tried.found, self._tried.outlines, self._around, self._options)
        return list(reachable_candidates(found, self._options.reach))

    def build(
        self, in_ways: Collection[str] = (), led: Collection[str] = ()
    ) -> tuple[tuple[Candidate, ...], OlderKerfs | None]:
        """The candidates; of contours that are cut along stretches, `in_ways`, only those that are `led` have any.

        Those too have them only if there is room for leads.
        """
        nest, options, already = self._nest, self._options, self._already
        if not nest.contours:
            return (), OlderKerfs.none()
        tried, again = self._tried, self._again
        out = [k for k, c in enumerate(nest.contours) if c.id in already.contours]
        stretched = {nest.index[name] for name in in_ways}
        unled = stretched - {nest.index[name] for name in led}
        before = [*(nest.index[cut.contour] for cut in already.cuts if cut.tabs), *stretched]
        edges, along = common_cut_paths(nest, sorted(tried.outlines), options, out, before)
        along = reachable_candidates(along, options.reach)
        redone = {*stretched, *(c.contour for c in (*again, *along))}
        shut = {k: why for k, why in tried.shut.items() if k not in redone}
        tried = replace(tried, bare=tuple(k for k in tried.bare if k not in redone), shut=shut)
        if tried.faulty:
            from .lead_errors import refusal

            raise refusal(nest, tried, self._around, options)
        bare_lines = [(k, nest.contours[k]) for k in self._left if nest.contours[k].kind in ("mark", "scrap")]
        marks = [c for k, line in bare_lines for c in mark_candidates(k, line, options)]
        whole = [c for c in self._with_leads if c.contour not in unled]
        reached = [*with_neighbours_in(nest, whole, edges, out), *tried.slits, *again]
        if shut_in := _shut_in(nest, edges, reached, out):
            raise InputError(
                "of parts that are cut with common edges none can be pierced",
                file=nest.file or None,
                details=shut_in,
            )
        if lost := sorted(set(tried.outlines) - stretched - {c.contour for c in (*reached, *along)}):
            details = tuple(f"{nest.contours[k].id}: {_why_lost(edges, k, out)}" for k in lost)
            from .lead_errors import cannot_be_cut

            raise InputError(cannot_be_cut(len(lost)), file=nest.file or None, details=details)
        if options.splash_mm is None:
            return tuple(sorted([*marks, *reached, *along], key=lambda c: c.contour)), None
        met = older_kerfs(nest, reached, options.kerf_mm, options.splash_mm, self._around)
        kept = resolve_lead_conflicts(reached, met, _locked(reached, tried.locked))
        every = [*reached, *marks, *along]
        places = sorted([*range(len(reached), len(every)), *kept], key=lambda k: every[k].contour)
        return tuple(every[k] for k in places), met.of_kept(places, len(every))


def _why_lost(edges: CommonEdges, number: int, out: Collection[int]) -> str:
    if edges.of.get(number, {}).keys().isdisjoint(out):
        return "no lead to it stays within the machine's travel"
    return (
        "neighbours with common edges are out, and leave several stretches of it, or nothing: cut it by hand, or say "
        "cuts.common.shortest: off"
    )


def _shut_in(
    nest: Nest, edges: CommonEdges, candidates: Sequence[Candidate], out: Collection[int] = ()
) -> tuple[str, ...]:
    """Groups of parts with common edges of which none is out, or can be cut first, each with what to do."""
    label = weak_components(len(nest.contours), edges.pairs)
    begun = {int(label[k]) for k in (*(c.contour for c in candidates), *out) if k in edges.of}
    first = {int(label[k]): k for k in sorted(edges.of, reverse=True)}
    return tuple(
        f"{nest.contours[k].id} and those that it has edges in common with: no lead to any of them has room; leave "
        f"more web beside one of them, or shorten {IN_PROFILE['lead_in_mm']}"
        for group, k in sorted(first.items())
        if group not in begun
    )


def _spoilt_by_tabs(nest: Nest, tried: LeadAttempt, around: Surroundings, options: LeadOptions) -> tuple[str, ...]:
    """Contours that could be cut if they had no tabs, each with what to do."""
    places = options.tab_places
    unmet = {int(tried.locked.contour[i]) for i in tried.unmet}
    wanting = [] if places is None else sorted((unmet | set(tried.bare)) & places.wanted.keys())
    if not wanting:
        return ()
    free = try_leads(nest, wanting, around, replace(options, tab_places=None))
    where = "of the entry that is locked" if unmet else "of any entry"
    return tuple(
        f"{nest.contours[k].id}: its tab has no room beside the lead-in {where}: make the tab narrower, lower "
        f"corner of {IN_PROFILE['tabs']}, or lock the part to have none (tab: off)"
        for k in wanting
        if k not in free.faulty
    )


def _locked(candidates: Sequence[Candidate], locked: Joints) -> set[int]:
    """The numbers of the candidates at entries that an operator asks for."""
    locked_entries = set(zip(locked.contour.tolist(), locked.entry_mm.tolist(), strict=True))
    return {k for k, c in enumerate(candidates) if (c.contour, c.entry_mm) in locked_entries}


def _check(options: LeadOptions, nest: Nest) -> None:
    """Refuse options that no nest, or not this one, can satisfy."""
    shortest_mm = least_clearance_mm(options) - options.kerf_mm / 2
    unknown = sorted(set(options.entry_points) - set(nest.index))
    if unknown:
        raise InputError(f"entry points are given for contours that are not in the nest: {', '.join(unknown)}")
    idle = sorted({c.kind for c in nest.contours if not options.directions[c.kind]})
    if idle:
        raise InputError(f"no direction is given to cut a contour of this kind in: {', '.join(idle)}")
    if options.entries < 1:
        raise InputError(f"leads.entries must be at least 1, not {options.entries}")
    if options.lead != "none" and options.lead_in_min_mm <= 0:
        raise InputError(f"{IN_PROFILE['lead_in_min_mm']} must be more than 0 mm, not {options.lead_in_min_mm:g} mm")
    if options.lead != "none" and options.lead_in_min_mm > options.lead_in_mm:
        raise InputError(
            f"{IN_PROFILE['lead_in_min_mm']}, {options.lead_in_min_mm:g} mm, is more than {IN_PROFILE['lead_in_mm']}, "
            f"{options.lead_in_mm:g} mm: lower it"
        )
    if options.lead != "none" and options.lead_in_mm < shortest_mm:
        raise InputError(
            f"{IN_PROFILE['lead_in_mm']}, {options.lead_in_mm:g} mm, does not bring the pierce "
            f"{IN_PROFILE['pierce_clearance_mm']}, {options.pierce_clearance_mm:g} mm, away from the contour: "
            f"it must be at least {shortest_mm:g} mm"
        )


def _candidates(
    found: Approaches, outlines: Mapping[int, Outline], around: Surroundings, options: LeadOptions
) -> list[Candidate]:
    joints, leads, ccw = found.ways.joints, found.leads, found.ways.ccw.tolist()
    tails, tail_mm, leaves = lead_outs(found, outlines, around, options)
    numbers = joints.contour.tolist()
    around_mm = np.array([outlines[k].path.length_mm for k in numbers])
    cut_mm = (leads.length_mm + around_mm + tail_mm).tolist()
    rows = np.stack(
        [np.column_stack([leads.pierce, leads.bulge]), np.column_stack([leads.join, leads.bulge * 0])], axis=1
    )
    led, edge, leads_on = (leads.length_mm > 0).tolist(), found.edge.tolist(), leaves.tolist()
    at = zip(joints.entry_mm.tolist(), joints.entry.tolist(), leads.pierce.tolist(), strict=True)
    candidates = []
    places = options.tab_places or TabPlaces()
    for i, (number, tail, (entry_mm, (x, y), (px, py))) in enumerate(zip(numbers, tails, at, strict=True)):
        left = places.on(number, outlines[number], float(joints.join_mm[i]), ccw[i])
        leads_out, tail_i_mm = leads_on[i], 0.0
        if left is not None and left.stop is not None:
            tail_i_mm, leads_out = float(tail_mm[i]), False
            tail = Curve(np.array([[*left.stop, 0.0]]), closed=False)
        candidates.append(
            Candidate(
                contour=number,
                entry_mm=entry_mm,
                entry=(x, y),
                direction="ccw" if ccw[i] else "cw",
                pierce=(px, py),
                lead_in=Curve(rows[i], closed=False) if led[i] else None,
                lead_out=tail,
                end=tail.end,
                cut_mm=cut_mm[i] if left is None else cut_mm[i] - tail_i_mm - left.unlit_mm,
                edge_start=edge[i],
                leaves=leads_out,
                tabs=() if left is None else left.tabs,
            )
        )
    return candidates


# A cut that broke off, made again as it was: for contours that have no room for a pierce beside the old kerf.


def recut(nest: Nest, cut: Cut | None, tried: LeadAttempt, kerf_mm: float) -> list[Candidate]:
    """The cut that broke off as the only way to cut its contour, where none was found; marks are made anew anyway."""
    if cut is None or (contour := nest.contour(cut.contour)).kind == "mark":
        return []
    number = nest.index[cut.contour]
    if number not in tried.bare and number not in tried.shut:
        return []
    ring = compensated(contour, kerf_mm)
    entry_mm, _ = contour.curve.project(cut.entry)
    leads_mm = math.fsum(lead.length_mm for lead in (cut.lead_in, cut.lead_out) if lead is not None)
    edge_start = not bool(shapely.contains_xy(nest.sheet.polygon, *cut.pierce))
    return [
        Candidate(
            contour=number,
            entry_mm=entry_mm,
            entry=cut.entry,
            direction=cut.direction,
            pierce=cut.pierce,
            lead_in=cut.lead_in,
            lead_out=cut.lead_out,
            end=cut.end,
            cut_mm=ring.length_mm + leads_mm - math.fsum(unlit_length_mm(tab, kerf_mm) for tab in cut.tabs),
            edge_start=edge_start,
            tabs=cut.tabs,
        )
    ]


# Candidates of marks and of scrap lines, which are neither compensated nor led into.

CLOSED_ENTRIES = 4
"""Where a closed mark may be begun."""


def mark_candidates(index: int, contour: Contour, options: LeadOptions) -> list[Candidate]:
    """An open line from either end ("ccw" along it as drawn, "cw" against it), a closed mark from a few points.

    The lead-out of an open line is its other end alone, so that a cut made of it knows where it ends.
    """
    curve, length_mm = contour.curve, contour.curve.length_mm
    found = []
    if curve.closed:
        count = min(options.entries, CLOSED_ENTRIES)
        at_mm = [length_mm * k / count for k in range(count)]
        locked = options.entry_points.get(contour.id)
        if locked is not None:
            at_mm = [curve.project(locked)[0], *at_mm]
        for s_mm in at_mm:
            at = curve.point_at(s_mm)
            for direction in options.directions[contour.kind]:
                found.append(Candidate(index, s_mm, at, direction, at, None, None, at, length_mm))
        return found
    for direction in options.directions[contour.kind]:
        s_mm = 0.0 if direction == "ccw" else length_mm
        at, end = curve.point_at(s_mm), curve.point_at(length_mm - s_mm)
        off = Curve(np.array([[*end, 0.0]]), closed=False)
        found.append(Candidate(index, s_mm, at, direction, at, None, off, end, length_mm))
    return found


# Lines that cut up the skeleton, with their kerf: that of none may come near a part, and none may sever another.


def scrap_problems(nest: Nest, kerf_mm: float) -> list[str]:
    """A sentence for each scrap line and part that are less than the kerf apart, and for each line that others sever.

    One kerf from the part is where the part's own kerf ends; a line that ends there meets that kerf.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> square = part("A", rect(50, 50, 50, 50))
    >>> scrap_problems(nest(200, 150, square, scrap=[[(0, 75), (48.5, 75)]]), 1.5)
    []
    >>> print(*scrap_problems(nest(200, 150, square, scrap=[[(0, 75), (49, 75)]]), 1.5))
    scrap1 comes within 1.000 mm of A.outer at (50.0, 75.0), less than the kerf of 1.5 mm: keep it a kerf away
    >>> crossed = nest(200, 150, scrap=[[(90, 0), (90, 150)], [(0, 60), (90, 60)], [(90, 60), (200, 60)]])
    >>> print(*scrap_problems(crossed, 1.5))
    scrap1 is cut in two by the lines that end on it at (90.0, 60.0): draw it as two lines that meet there
    """
    return [*_near_parts(nest, kerf_mm), *_severed(nest, kerf_mm)]


def _severed(nest: Nest, kerf_mm: float) -> list[str]:
    lines = [c.line for c in nest.scrap]
    if len(lines) < 2:  # nothing else ends on it
        return []
    metal = carrying(skeleton(nest.sheet.polygon, [part.outer.polygon for part in nest.parts], kerf_mm), kerf_mm)
    found = []
    for k, places_mm in severed_lines(lines, metal, kerf_mm).items():
        points = shapely.get_coordinates(shapely.line_interpolate_point(lines[k], places_mm)).tolist()
        places = " and ".join(f"({x:z.1f}, {y:z.1f})" for x, y in points)
        text = f"{nest.scrap[k].id} is cut in two by the lines that end on it at {places}"
        found.append(f"{text}: draw it as {'two' if len(points) == 1 else len(points) + 1} lines that meet there")
    return found


def _near_parts(nest: Nest, kerf_mm: float) -> list[str]:
    if not nest.scrap or not nest.parts:
        return []
    lines = np.array([c.line for c in nest.scrap], dtype=object)
    outers = np.array([part.outer.line for part in nest.parts], dtype=object)
    least_mm = kerf_mm - tolerance_mm(kerf_mm)
    row, other = shapely.STRtree(outers).query(lines, predicate="dwithin", distance=least_mm)
    found = []
    for k, p in sorted(zip(row.tolist(), other.tolist(), strict=True)):
        gap_mm = float(shapely.distance(lines[k], outers[p]))
        x, y = shapely.get_coordinates(shapely.shortest_line(lines[k], outers[p]))[-1].tolist()
        found.append(
            f"{nest.scrap[k].id} comes within {gap_mm:.3f} mm of {nest.parts[p].outer.id} at ({x:z.1f}, {y:z.1f}), "
            f"less than the kerf of {kerf_mm:g} mm: keep it a kerf away"
        )
    return found
