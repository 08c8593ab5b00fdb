"""All facts of a nest, family after family, and those of some of its contours alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.already_cut import AlreadyCut, loose_contours, rest_of
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.candidates.older_kerfs import OlderKerfs, older_kerfs
from kerfwise.encoder.candidates.stretches import StretchWays
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.identical_parts import Group
from kerfwise.encoder.nest import Nest

from .facts import Column, Copies, Facing, FactOptions, Facts, Past, Stretch
from .neighbours import cells_of, outlook_of, runs_of, stretch_of, surroundings_of
from .outlines import outlines_of
from .relations import closure_of, edge_gaps, heat, hull_pairs, level_ahead, long_parts, offcuts, parents_of, start_side
from .zones import respected_orders, zones_of


def compute_facts(
    nest: Nest,
    options: FactOptions,
    candidates: Sequence[Candidate] = (),
    heat_kj: Floats | None = None,
    met: OlderKerfs | None = None,
) -> Facts:
    """The facts of a nest and of the candidates of its contours.

    `nest`: a validated nest. `options`: thresholds, and what a profile fixes. `candidates`: sorted by contour index;
    may be empty. `heat_kj`: the most heat that cutting each contour leaves in the sheet, (n,), which the machine and
    the material decide. `met`: what the candidates meet of cuts made before them under the same options, where that is
    known already. Raises InputError if `options` name contours or parts that the nest does not have, or zones that
    contradict each other; ValueError if `options` give a zone a budget of heat, but `heat_kj` is missing.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> two = nest(400, 100, part("A", rect(10, 10, 80, 80)), part("B", rect(100, 10, 80, 80)))
    >>> facts = compute_facts(two, FactOptions())
    >>> facts.start_side, facts.start_side_because, facts.level_ahead.tolist()
    ('left', 'offcut', [[0, 1]])
    """
    if heat_kj is None:
        if options.zone_heat_kj is not None:
            raise ValueError("zones have a budget of heat, but the heat of the contours is not given")
        heat_kj = np.full(len(nest.contours), np.nan)
    outlines, sheet_mm = outlines_of(nest), nest.sheet.bounds
    parent = parents_of(outlines)
    contains = closure_of(parent)

    is_long = long_parts(outlines, options.long_ratio)
    edge_gap_mm = edge_gaps(outlines, sheet_mm)
    offcut_mm, offcut_large = offcuts(edge_gap_mm[outlines.outers], sheet_mm, options.offcut_share)
    heat_mm, heat_parts = heat(outlines, sheet_mm)
    side, because = start_side(sheet_mm, options, is_long, edge_gap_mm, offcut_large, heat_mm, heat_parts)

    ahead = level_ahead(outlines, parent, side)
    hull = hull_pairs(outlines, parent)
    respected = respected_orders(contains, ahead, hull, options)
    zone = zones_of(nest, outlines, parent, side, respected, options, heat_kj)

    rest_mm: dict[int, float] = {}
    for c in candidates:
        if c.along_mm and not nest.index.keys() >= {*c.out}:  # a way begins it
            rest_mm[c.contour] = min(c.along_mm, rest_mm.get(c.contour, c.along_mm))
    outlook = outlook_of(outlines, parent, nest.sheet, cells_of(outlines, rest_mm), options)
    surroundings = surroundings_of(outlines, parent, outlook)
    runs = runs_of(outlook)
    contour = np.fromiter((c.contour for c in candidates), np.int64, len(candidates))
    return Facts(
        nest=nest,
        options=options,
        parent=parent,
        contains=contains,
        start_side=side,
        start_side_because=because,
        level_ahead=ahead,
        in_hull=hull,
        neighbours=surroundings.neighbours,
        edge_gap_mm=edge_gap_mm,
        edge_length_mm=surroundings.edge_length_mm,
        solid_mm=surroundings.solid_mm,
        long=is_long,
        offcut_mm=offcut_mm,
        offcut_large=offcut_large,
        heat_mm=heat_mm,
        heat_parts=heat_parts,
        zone=zone,
        torch_heat_kj=heat_kj,
        candidates=tuple(candidates),
        first=np.searchsorted(contour, np.arange(outlines.n + 1)),
        head=stretch_of(outlines, runs, candidates, options.head_share, "head"),
        tail=stretch_of(outlines, runs, candidates, options.tail_share, "tail"),
        older_kerfs=_older_kerfs(nest, options, candidates, met),
        columns={name: column for own in options.columns for name, column in own(nest, options).items()},
    )


def _older_kerfs(
    nest: Nest, options: FactOptions, candidates: Sequence[Candidate], met: OlderKerfs | None
) -> OlderKerfs:
    if options.splash_mm is None:
        return OlderKerfs.none()
    return older_kerfs(nest, candidates, options.kerf_mm, options.splash_mm) if met is None else met


_OF_CONTOURS = ("edge_gap_mm", "edge_length_mm", "solid_mm", "long")
"""Facts with a row for each contour, of which a way has nothing."""


def _each(facts: Facts, names: Sequence[str], by: Callable[[Any], Any]) -> dict[str, Any]:
    return {name: by(getattr(facts, name)) for name in names}


def _columns(
    facts: Facts, of_contours: Callable[[Any], Any], of_pairs: Callable[[Any], Any] = lambda pairs: pairs
) -> dict[str, Column]:
    """The facts of single rules by other numbers."""
    return {
        name: replace(column, values=(of_pairs if column.pairs else of_contours)(column.values))
        for name, column in facts.columns.items()
    }


# The facts with ways along stretches of contours, which are cut before these are finished.


def with_ways(facts: Facts, ways: StretchWays, heat_kj: Floats) -> Facts:
    """The facts of the nest without its ways, with these behind all contours; `heat_kj` (m,) is that of each way.

    A way faces nothing and lies in nothing. It is in the first of the zones of what it begins.
    """
    nest, count, more = ways.nest, facts.n, len(ways.nest.stretches)
    zone = [min(int(facts.zone[nest.index[s.contour]]) for s in way.along) for way in nest.stretches]

    def grown(values: Any, by: float) -> Any:
        return np.concatenate([values, np.full((more, *values.shape[1:]), by, dtype=values.dtype)])

    def stretch(whole: Stretch) -> Stretch:
        none = np.zeros(len(ways.ways))
        total, edge, solid = (np.concatenate([mm, none]) for mm in (whole.total_mm, whole.edge_mm, whole.solid_mm))
        return Stretch(total, edge, solid, whole.neighbours)

    candidates = (*facts.candidates, *ways.ways)
    contour = np.array([c.contour for c in candidates], dtype=np.int64)
    paths = [shapely.LineString(link.path) for link in facts.links]
    burnt = shapely.union_all([way.line for way in nest.stretches])
    leads = [lead.line() for c in ways.ways for lead in (c.lead_in,) if lead is not None]
    off = (
        shapely.distance(np.array(paths, dtype=object), shapely.union_all([burnt, *leads])) > 2 * facts.options.kerf_mm
    )
    return replace(
        facts,
        nest=nest,
        parent=grown(facts.parent, -1),
        **_each(facts, _OF_CONTOURS, lambda values: grown(values, 0)),
        zone=np.concatenate([facts.zone, np.array(zone, dtype=np.int64)]),
        torch_heat_kj=np.concatenate([facts.torch_heat_kj, heat_kj]),
        candidates=candidates,
        first=np.searchsorted(contour, np.arange(count + more + 1)),
        head=stretch(facts.head),
        tail=stretch(facts.tail),
        columns=_columns(facts, lambda values: grown(values, 0)),
        older_kerfs=OlderKerfs.none() if ways.met is None else ways.met,
        links=tuple(link for link, free in zip(facts.links, off.tolist(), strict=True) if free),
    )


def without_ways(facts: Facts) -> Facts:
    """The same facts of the contours alone: all numbers stay, for ways come last."""
    if not facts.nest.stretches:
        return facts
    n, m = facts.n - len(facts.nest.stretches), int(facts.first[facts.n - len(facts.nest.stretches)])

    def stretch(whole: Stretch) -> Stretch:
        return Stretch(whole.total_mm[:m], whole.edge_mm[:m], whole.solid_mm[:m], whole.neighbours)

    rings, leads = facts.older_kerfs.rings, facts.older_kerfs.leads
    return replace(
        facts,
        nest=facts.nest.without_stretches,
        parent=facts.parent[:n],
        **_each(facts, (*_OF_CONTOURS, "zone", "torch_heat_kj"), lambda values: values[:n]),
        candidates=facts.candidates[:m],
        first=facts.first[: n + 1],
        head=stretch(facts.head),
        tail=stretch(facts.tail),
        columns=_columns(facts, lambda values: values[:n]),
        older_kerfs=OlderKerfs(rings[(rings[:, 0] < m) & (rings[:, 1] < n)], leads[(leads < m).all(axis=1)]),
    )


# The facts of some contours of a nest: those of the whole, by numbers of their own. Nothing is measured anew.


def new_numbers(count: int, left: Ints | Sequence[int]) -> Ints:
    """The new number of each of `count` things when those of `left` alone stay, in that order; -1 for others.

    Examples
    --------
    >>> new_numbers(4, [1, 3]).tolist()
    [-1, 0, -1, 1]
    """
    number = np.full(count, -1, dtype=np.int64)
    number[left] = np.arange(len(left))
    return number


def subset_candidates(whole: Facts, number: Ints) -> list[int]:
    """The candidates of contours that stay."""
    return [k for k, candidate in enumerate(whole.candidates) if number[candidate.contour] >= 0]


def subset_facts(whole: Facts, nest: Nest, number: Ints) -> Facts:
    """The facts of a nest that has some contours of the whole one, `number` from theirs to its own.

    Boundary that faces contours which are not there faces neither a neighbour nor solid metal; the start side and the
    zones are those of the whole sheet.
    """
    left = np.flatnonzero(number >= 0)
    kept = subset_candidates(whole, number)
    candidate = new_numbers(len(whole.candidates), kept)

    def pairs(rows: Ints) -> Ints:
        there = (number[rows] >= 0).all(axis=1)
        return np.asarray(number[rows[there]], dtype=np.int64).reshape(-1, 2)

    def facing(whole: Facing, rows: Ints) -> Facing:
        row = rows[whole.row]
        there = (number[whole.neighbour] >= 0) & (row >= 0)
        return Facing(row[there], number[whole.neighbour[there]], whole.length_mm[there], whole.gap_mm[there])

    def stretch(whole: Stretch) -> Stretch:
        faced = facing(whole.neighbours, candidate)
        return Stretch(whole.total_mm[kept], whole.edge_mm[kept], whole.solid_mm[kept], faced)

    met = whole.older_kerfs.of_kept(kept, len(whole.candidates))
    there = number[met.rings[:, 1]] >= 0
    parent = whole.parent[left]
    candidates = tuple(replace(whole.candidates[k], contour=int(number[whole.candidates[k].contour])) for k in kept)
    return replace(
        whole,
        nest=nest,
        parent=np.where(parent >= 0, number[parent], -1),
        **_each(whole, ("contains", "level_ahead", "in_hull"), pairs),
        neighbours=facing(whole.neighbours, number),
        **_each(whole, (*_OF_CONTOURS, "zone", "torch_heat_kj"), lambda values: values[left]),
        candidates=candidates,
        first=np.searchsorted(np.array([c.contour for c in candidates], dtype=np.int64), np.arange(len(left) + 1)),
        head=stretch(whole.head),
        tail=stretch(whole.tail),
        columns=_columns(whole, lambda values: values[left], pairs),
        older_kerfs=replace(met, rings=np.column_stack([met.rings[there, 0], number[met.rings[there, 1]]])),
    )


# The facts of what is left of a nest: those of the whole, less what is already cut.
#
# Nothing is measured anew. Boundary that faces a part which is out faces neither a neighbour nor solid metal any
# more, so that it counts as free; the start side and the zones are those of the whole sheet.


def loose_in(nest: Nest, out: frozenset[str]) -> dict[str, str]:
    """Contours that can no longer be cut, each with the contour around it that is out."""
    if not out:
        return {}
    nest = nest.without_stretches
    ids = [c.id for c in nest.contours]
    parents = parents_of(outlines_of(nest)).tolist()
    return loose_contours(nest, {ids[k]: ids[p] for k, p in enumerate(parents) if p >= 0}, out)


def remaining_facts(whole: Facts, already: AlreadyCut) -> Facts:
    """The facts of what is left; only contours that are left may have candidates.

    Examples
    --------
    >>> from kerfwise.encoder.cut import Cut
    >>> from kerfwise.encoder.facts import FactOptions, compute_facts
    >>> from kerfwise.rules.case import nest, part, rect
    >>> row = [part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABC")]
    >>> facts = compute_facts(nest(400, 100, *row), FactOptions())
    >>> left = remaining_facts(facts, AlreadyCut((Cut("A.outer", (10, 10), "cw", (5, 10)),)))
    >>> [c.id for c in left.nest.contours], facts.level_ahead.tolist(), left.level_ahead.tolist()
    (['B.outer', 'C.outer'], [[0, 1], [0, 2], [1, 2]], [[0, 1]])
    """
    out = already.contours
    loose = loose_in(whole.nest, out)
    nest = rest_of(whole.nest, out | loose.keys())
    number = new_numbers(whole.n, [whole.nest.index[c.id] for c in nest.contours])
    left = replace(subset_facts(whole, nest, number), past=Past(whole, already, number, tuple(loose.items())))
    if already.broken_off is None or already.broken_off.contour not in nest.index:
        return left
    return replace(left, zone=_opened_by(left, whole, already.broken_off.contour))


def _opened_by(left: Facts, whole: Facts, contour: str) -> Ints:
    """The zones of what is left with a contour in the first of them: it broke off, and is cut before all others.

    So is what shares its zone, as its part, host and guests, and what must go before any of these. The older plan may
    have had other zones, and kept them up to there.
    """
    top = np.array([_top(whole, whole.nest.index[c.id]) for c in left.nest.contours], dtype=np.int64)
    pairs = respected_orders(left.contains, left.level_ahead, left.in_hull, left.options)
    first, zone = left.nest.index[contour], left.zone.copy()
    lowest = int(zone.min())
    moved = np.flatnonzero(top == top[first])
    while True:
        before = pairs[np.isin(pairs[:, 1], moved), 0]
        more = np.flatnonzero(np.isin(top, top[np.union1d(moved, before[zone[before] > lowest])]))
        if len(more) == len(moved):
            break
        moved = more
    zone[moved] = np.minimum(zone[moved], lowest)
    return zone


def _top(whole: Facts, k: int) -> int:
    """The outermost contour around a contour of the whole nest, or itself."""
    while whole.parent[k] >= 0:
        k = int(whole.parent[k])
    return k


# The facts of what the first torch of a gantry cuts, where others cut copies together with it.


def nest_of_first(nest: Nest, groups: Sequence[Group]) -> Nest:
    """The nest without what further torches cut."""
    return rest_of(nest, frozenset(nest.contours[k].id for group in groups for k in group.contours[1:]))


def with_zones_of_first(whole: Facts, groups: Sequence[Group]) -> Facts:
    """The facts of the whole, where zones are those of what the first torch cuts, and copies are in the same zones."""
    nest = nest_of_first(whole.nest, groups)
    options = replace(_of_leaders(whole, groups, len(nest.contours)), start_side=whole.start_side)
    zones = compute_facts(nest, options).zone
    found = np.ones(whole.n, dtype=np.int64)
    for contour, zone in zip(nest.contours, zones.tolist(), strict=True):
        found[whole.nest.index[contour.id]] = zone
    for group in groups:
        found[list(group.contours)] = found[group.contours[0]]
    return replace(whole, zone=found)


def _of_leaders(whole: Facts, groups: Sequence[Group], left: int) -> FactOptions:
    """The options, where what a further torch cuts is named by what it is cut with; `left` contours are the first's.

    A place among all contours is one as far along among these.
    """
    contours, parts = whole.nest.contours, whole.nest.parts
    leader = {contours[k].id: contours[group.contours[0]].id for group in groups for k in group.contours}
    head = {parts[k].id: parts[group.parts[0]].id for group in groups for k in group.parts}
    pairs = ((leader.get(a, a), leader.get(b, b)) for a, b in whole.options.zone_pairs)
    places: dict[str, int] = {}
    for part, place in whole.options.zone_places:
        places.setdefault(head.get(part, part), 1 + (place - 1) * left // whole.n if place < whole.n else left)
    fixed = dict.fromkeys((head.get(part, part), zone) for part, zone in whole.options.zone_fixed)
    return replace(
        whole.options,
        zone_pairs=tuple(dict.fromkeys((a, b) for a, b in pairs if a != b)),
        zone_places=tuple(places.items()),
        zone_fixed=tuple(fixed),
    )


def first_torch_facts(whole: Facts, groups: Sequence[Group], step: Point) -> Facts:
    """The facts of what the first torch cuts, by numbers of their own.

    The contours of each group have the same candidates in `whole`, in the same order.
    """
    nest = nest_of_first(whole.nest, groups)
    own = new_numbers(whole.n, [whole.nest.index[c.id] for c in nest.contours])
    own_candidate = new_numbers(len(whole.candidates), subset_candidates(whole, own))
    number, candidate = own.copy(), own_candidate.copy()
    torch = np.ones(whole.n, dtype=np.int64)
    for group in groups:
        first = whole.candidates_of(group.contours[0])
        for k, contour in enumerate(group.contours[1:], 2):
            number[contour], torch[contour] = own[group.contours[0]], k
            span = whole.candidates_of(contour)
            candidate[span.start : span.stop] = own_candidate[first.start : first.stop]
    copies = Copies(whole, tuple(groups), number, candidate, torch, step)
    return replace(subset_facts(whole, nest, own), copies=copies)
