"""Ways along what is left of a contour once some of its neighbours are out that have edges in common with it."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kerfwise.encoder.cut import Direction, Span
from kerfwise.encoder.geometry.concavity import concavity_pairs
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.geometry.tolerances import tolerance_mm
from kerfwise.encoder.graphs import weak_components
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.torch_path import TabOptions, compensated

from .candidate import Candidate, CommonOptions, LeadOptions
from .common_edges import CommonEdges, Junction, Stretches, common_edges, rounds_at_corners

_MOST_ORDERS = 4000
"""So many sets of parts that are out are tried, to see whether a group with common edges can be cut at all."""
_MOST_STATES = 64
"""Sets of neighbours that are out for which a contour has ways, at the most: a rectangle among four has 12."""

Run = tuple[float, float]
"""Where a stretch of a ring begins, and how long it is, mm."""


def common_cut_paths(
    nest: Nest,
    left: Collection[int],
    options: LeadOptions,
    gone: Collection[int] = (),
    held_before: Collection[int] = (),
) -> tuple[CommonEdges, list[Candidate]]:
    """The common edges of the contours that are left to be cut, and the ways along what they leave of rings.

    Each way begins and ends in the kerf of a neighbour that is out. It is lawful for exactly one set of these. There is
    none where they leave several stretches of a ring, or nothing. What is `gone` was cut before, and is out in all of
    them; it changes nothing about which edges are common. Parts that tabs hold, or `held_before`, have none, nor have
    those that hang together with them.
    """
    common = options.common
    if common is None:
        return CommonEdges({}), []
    held = {*held_before, *(() if options.tab_places is None else options.tab_places.wanted)}
    edges, found = _cut_once(nest, sorted({*left, *gone}), options.kerf_mm, common, held)
    found |= {
        k: _sets(nest, edges, k, options.kerf_mm, out)
        for k, beside in edges.of.items()
        if (out := beside.keys() & set(gone))
    }
    ways = [
        way
        for number in edges.of
        if number in left
        for out, run in found[number]
        for way in along_the_rest(nest, number, out, edges, run, options, common)
    ]
    return edges, ways


def whole_for_tabs(nest: Nest, kerf_mm: float, options: CommonOptions, tabs: TabOptions) -> tuple[list[str], list[str]]:
    """Ids of the contours that have common edges but for tabs, and of those among them that tabs hold.

    Raises InputError if the kerf leaves nothing of a contour to cut.
    """
    numbers = [nest.index[part.outer.id] for part in nest.parts]
    held = {k for k, part in zip(numbers, nest.parts, strict=True) if tabs.reason(part) is not None}
    if not held:
        return [], []
    free = _cut_once(nest, numbers, kerf_mm, options, ())[0].of.keys()
    lost = sorted(free - _cut_once(nest, numbers, kerf_mm, options, held)[0].of.keys()) if free & held else []
    return [nest.contours[k].id for k in lost], [nest.contours[k].id for k in lost if k in held]


def whole_for_want_of_an_order(nest: Nest, kerf_mm: float, options: CommonOptions, held: Collection[int]) -> list[str]:
    """Ids of the contours with common edges that are yet cut all round, for no order cuts every edge once.

    Raises InputError if the kerf leaves nothing of a contour to cut.
    """
    numbers = [nest.index[part.outer.id] for part in nest.parts]
    every = common_edges(nest, numbers, kerf_mm, options, held).of.keys()
    return [nest.contours[k].id for k in sorted(every - _cut_once(nest, numbers, kerf_mm, options, held)[0].of.keys())]


Sets = list[tuple[frozenset[int], Run]]


def _cut_once(
    nest: Nest, numbers: Sequence[int], kerf_mm: float, options: CommonOptions, held: Collection[int]
) -> tuple[CommonEdges, dict[int, Sets]]:
    """The common edges of these contours, but for those `held`; and the sets of neighbours that leave one stretch."""
    edges = common_edges(nest, numbers, kerf_mm, options, held)
    found = {number: _sets(nest, edges, number, kerf_mm, ()) for number in edges.of}
    first = _in_mouths(nest, list(edges.of)) if options.mouths_first else {}
    return _that_have_an_order(nest, edges, found, first), found


def _in_mouths(nest: Nest, numbers: Sequence[int]) -> dict[int, frozenset[int]]:
    """Hollow contours among these, and those that sit in the concavity of each."""
    contours = [nest.contours[k] for k in numbers]
    line, polygon = (np.array(of, dtype=object) for of in ([c.line for c in contours], [c.polygon for c in contours]))
    found: dict[int, set[int]] = {}
    for j, i in concavity_pairs(line, polygon).tolist():
        found.setdefault(numbers[i], set()).add(numbers[j])
    return {k: frozenset(before) for k, before in found.items()}


def _sets(nest: Nest, edges: CommonEdges, number: int, kerf_mm: float, out: Collection[int]) -> Sets:
    ring = compensated(nest.contours[number], kerf_mm)
    return list(states(ring, edges.of[number], kerf_mm, edges.junctions[number], out))


def _that_have_an_order(
    nest: Nest,
    edges: CommonEdges,
    found: Mapping[int, Sequence[tuple[frozenset[int], Run]]],
    first: Mapping[int, frozenset[int]],
) -> CommonEdges:
    """The common edges but for groups that no order cuts: whatever is out, some part is left with two stretches to cut.

    Contours may come only when those are out that come `first`.

    So are a channel and the plate that both its legs end at, and plates with rounded corners in a grid: where two
    neighbours of one are out, its corner between them is left apart from the rest. Such groups are cut by whole rounds.
    """
    label = weak_components(len(nest.contours), edges.pairs)
    groups: dict[int, list[int]] = {}
    for number in edges.of:
        groups.setdefault(int(label[number]), []).append(number)
    spoilt = {
        name
        for name, group in groups.items()
        if not _may_be_cut(
            {k: frozenset(edges.of[k]) for k in group},
            {k: {out for out, _ in found[k]} for k in group},
            {k: first.get(k, frozenset()).intersection(group) for k in group},
        )
    }
    if not spoilt:
        return edges
    kept = {k: beside for k, beside in edges.of.items() if int(label[k]) not in spoilt}
    return CommonEdges(kept, {k: edges.junctions[k] for k in kept})


def _may_be_cut(
    beside: Mapping[int, frozenset[int]],
    states_of: Mapping[int, set[frozenset[int]]],
    first: Mapping[int, frozenset[int]],
) -> bool:
    """Whether some order cuts each part of a group whole first, or with such neighbours out as leave one stretch.

    A part comes only when those are out that come `first`. Orders are tried within bounds; where these do not tell,
    there may be one.
    """
    if not any(beside[k] in states_of[k] for k in beside):  # the last one has all its neighbours out
        return False
    tried: set[frozenset[int]] = set()
    waiting = [frozenset[int]()]
    while waiting:
        out = waiting.pop()
        if len(out) == len(beside) or len(tried) > _MOST_ORDERS:
            return True
        tried.add(out)
        for k in sorted(beside.keys() - out, reverse=True):
            now = beside[k] & out
            if first[k] <= out and (not now or now in states_of[k]) and (more := out | {k}) not in tried:
                waiting.append(more)
    return False


def with_neighbours_in(
    nest: Nest, candidates: Collection[Candidate], edges: CommonEdges, gone: Collection[int] = ()
) -> list[Candidate]:
    """Candidates that go all round; those of contours with common edges may be used while all neighbours are in.

    Where one is `gone`, there are none.
    """
    return [
        replace(c, still_in=_ids(nest, edges.of[c.contour].keys())) if c.contour in edges.of else c
        for c in candidates
        if edges.of.get(c.contour, {}).keys().isdisjoint(gone)
    ]


def states(
    ring: Curve,
    beside: Mapping[int, Stretches],
    kerf_mm: float,
    junctions: Collection[Junction] = (),
    gone: Collection[int] = (),
) -> Iterator[tuple[frozenset[int], Run]]:
    """The sets of neighbours that are out together and leave one stretch of a ring, and that stretch.

    Only those are found that come about neighbour after neighbour with one stretch left each time, those `gone` first.

    Examples
    --------
    >>> ring = Curve.of([(0, 0), (40, 0), (40, 20), (0, 20)])
    >>> row = {7: ((40.0, 20.0),), 9: ((100.0, 20.0),)}
    >>> [(sorted(out), run) for out, run in states(ring, row, 1.0)]
    [([7], (60.0, 100.0)), ([9], (0.0, 100.0))]
    """
    rounds = rounds_at_corners(ring, kerf_mm)

    def left(out: frozenset[int]) -> Run | None:
        covered = [run for k in sorted(out) for run in beside[k]]
        covered += [junction.stretch for junction in junctions if {junction.one, junction.other} <= out]
        runs = uncovered_stretches(ring.length_mm, covered, rounds, tolerance_mm(kerf_mm))
        return runs[0] if len(runs) == 1 and runs[0][1] > 2 * kerf_mm else None

    first = frozenset(gone)
    seen: set[frozenset[int]] = {first}
    waiting: list[frozenset[int]] = [first]
    found = 0
    if first and (run := left(first)) is not None:
        yield first, run
    while waiting and found < _MOST_STATES:
        before = waiting.pop(0)
        for neighbour in sorted(beside.keys() - before) if len(seen) < _MOST_STATES**2 else ():
            out = before | {neighbour}
            if out in seen:
                continue
            seen.add(out)
            run = left(out)
            if run is not None:
                yield out, run
                waiting.append(out)
                found += 1


def uncovered_stretches(
    around_mm: float, covered: Collection[Run], rounds: Collection[Run], within_mm: float
) -> list[Run]:
    """The stretches of a ring that are not covered; a round at a corner is none where both of its ends are covered.

    Examples
    --------
    >>> uncovered_stretches(100.0, [(90.0, 15.0), (6.0, 20.0)], [(5.0, 1.0), (26.0, 1.0)], 0.05)
    [(26.0, 64.0)]
    """
    runs = _rest(around_mm, covered, within_mm)
    return [run for run in runs if not any(_same(run, one, around_mm, within_mm) for one in rounds)]


def _same(one: Run, other: Run, around_mm: float, within_mm: float) -> bool:
    apart_mm = (one[0] - other[0] + around_mm / 2) % around_mm - around_mm / 2
    return abs(apart_mm) <= within_mm and abs(one[1] - other[1]) <= 2 * within_mm


def _rest(around_mm: float, covered: Collection[Run], within_mm: float) -> list[Run]:
    """What of a ring is not covered, but for what is shorter than the tolerance."""
    if not covered:
        return [(0.0, around_mm)]
    rows = sorted((low % around_mm, length) for low, length in covered)
    begin = rows[0][0]
    runs, reached = [], begin
    for low, length in rows:
        if low - reached > within_mm:
            runs.append((reached, low - reached))
        reached = max(reached, low + length)
    if begin + around_mm - reached > within_mm:
        runs.append((reached % around_mm, begin + around_mm - reached))
    return runs


def along_the_rest(
    nest: Nest,
    number: int,
    out: Collection[int],
    edges: CommonEdges,
    run: Run,
    options: LeadOptions,
    common: CommonOptions,
) -> Iterator[Candidate]:
    """Both ways along a stretch of a ring, the rest of it being cut with those that are `out`."""
    contour, drawn = nest.contours[number], nest.contours[number].curve
    ring, corners = compensated(contour, options.kerf_mm), common.corners
    still_in = edges.of[number].keys() - set(out)
    (low, first), (high, last) = _straight_ends(ring, number, out, still_in, edges, run, options.kerf_mm)
    first_mm, last_mm = (drawn.project(ring.point_at(mm))[0] for mm in (low, high))
    for onwards in (True, False):
        way: Direction = "ccw" if drawn.is_ccw == onwards else "cw"
        if way not in options.directions[contour.kind]:
            continue
        join, leave = (ring.point_at(mm) for mm in ((low, high) if onwards else (high, low)))
        begin, end = (first, last) if onwards else (last, first)
        entry_mm = first_mm if onwards else last_mm
        stretch = ring.between(low, high - low)
        leads_mm = sum(math.dist(a, b) for a, b in ((begin, join), (leave, end)) if a is not None and b is not None)
        yield Candidate(
            contour=number,
            entry_mm=entry_mm,
            entry=drawn.point_at(entry_mm),
            direction=way,
            pierce=join if begin is None else begin,
            lead_in=None if begin is None else Curve.of([begin, join], closed=False),
            lead_out=Curve.of([leave] if end is None else [leave, end], closed=False),
            end=leave if end is None else end,
            cut_mm=high - low + leads_mm,
            span=Span(join, leave),
            along_mm=(last_mm - first_mm) % drawn.length_mm,
            kerf_start=common.kerf_start,
            out=_ids(nest, out),
            still_in=_ids(nest, still_in),
            corner_mm=None if corners is None else corners.more_mm(stretch),
        )


def _straight_ends(
    ring: Curve,
    number: int,
    out: Collection[int],
    still_in: Collection[int],
    edges: CommonEdges,
    run: Run,
    kerf_mm: float,
) -> tuple[tuple[float, Point | None], tuple[float, Point | None]]:
    """Where a stretch begins and ends, without its rounds where it goes straight on over a junction, and to where."""
    low, high = run[0], run[0] + run[1]
    first: Point | None = None
    last: Point | None = None
    within_mm = 2 * tolerance_mm(kerf_mm)
    ends = [
        (near, far)
        for k in sorted(still_in)
        for junction in edges.junctions[k]
        for own, other, near, far in (
            (junction.one, junction.other, junction.begin, junction.end),
            (junction.other, junction.one, junction.end, junction.begin),
        )
        if own == number and other in out
    ]
    for begin_mm, length_mm in rounds_at_corners(ring, kerf_mm):
        for near, far in ends:
            before, after = (math.dist(ring.point_at(mm), near) for mm in (begin_mm, begin_mm + length_mm))
            if _apart(begin_mm, run[0], ring) <= within_mm and after <= within_mm:
                low, first = run[0] + length_mm, far
            if _apart(begin_mm + length_mm, run[0] + run[1], ring) <= within_mm and before <= within_mm:
                high, last = run[0] + run[1] - length_mm, far
    return (low, first), (high, last)


def _apart(one_mm: float, other_mm: float, ring: Curve) -> float:
    half_mm = ring.length_mm / 2
    return abs((one_mm - other_mm + half_mm) % ring.length_mm - half_mm)


def _ids(nest: Nest, numbers: Collection[int]) -> tuple[str, ...]:
    return tuple(nest.contours[k].id for k in sorted(numbers))
