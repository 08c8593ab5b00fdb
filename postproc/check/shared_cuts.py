"""Burns that cut several contours, and contours that several burns cut, as cuts: one a contour, when it is out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut, Direction, Span, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.postproc.check.reader.program import Burn

from .covering.chords import chords_of_lines, chords_of_paths
from .covering.covered import Covered, covered
from .covering.free import at_tabs, rounds
from .covering.intervals import NONE, total_mm, union
from .covering.pieces import Piece, is_whole, pieces
from .covering.sharing import shared, stretches_of
from .matching import Match
from .program_rules import tolerance_mm
from .resumed import NOTHING_BURNT, BurntBefore
from .torch_run import TorchRun, line_of

Rings = Sequence[shapely.LineString | None]
Tabs = Mapping[str, Sequence[Tab]]


@dataclass(frozen=True, eq=False, slots=True)
class CutOut:
    """One contour that is out, or a stretch of one that is not: how it is cut, and the torch's path."""

    contour: Contour
    cut: Cut
    out: bool
    run: TorchRun


def shared_cuts(
    nest: Nest,
    burns: Sequence[Burn],
    lines: Sequence[shapely.LineString],
    matches: Sequence[Match | None],
    rings: Rings,
    kerf_mm: float,
    tabs: Tabs | None = None,
    before: BurntBefore = NOTHING_BURNT,
) -> dict[int, list[CutOut]]:
    """For each burn that does not cut one contour all by itself, what it cuts, in order; the others are left out.

    What was burnt `before` a stop is burnt; contours that were cut then are out, and not cut by what runs along them.
    """
    within_mm = tolerance_mm(kerf_mm)
    paths = [burn.path if burn.tool == 0 else None for burn in burns]
    around = [ring if contour.encloses else None for ring, contour in zip(rings, nest.contours, strict=True)]
    own = [_own(match, line, within_mm) for match, line in zip(matches, lines, strict=True)]
    tabbed = frozenset(k for k, contour in enumerate(nest.contours) if tabs and contour.id in tabs)
    left = [None if contour.id in before.out else ring for ring, contour in zip(around, nest.contours, strict=True)]
    burnt = _burnt_on(left, before.lines, within_mm)
    odd = shared(paths, lines, around, own, within_mm, tabbed | (burnt.keys() - set(own)))
    if not odd.burns:
        return {}
    free: dict[int, Floats] = {}
    taken, cut = set(odd.burns), set(odd.rings)
    coverage: dict[int, Covered] = {}
    while more := cut - coverage.keys():
        free |= {k: at_tabs(around[k], (tabs or {}).get(nest.contours[k].id, ()), within_mm) for k in more}
        coverage |= _coverage(sorted(more), around, _with(free, burnt), paths, lines, within_mm)
        open_yet = sorted(k for k in more if coverage[k].out is None)
        free |= {k: union(np.concatenate([free[k], rounds(around[k], nest.contours[k])])) for k in open_yet}
        coverage |= _coverage(open_yet, around, _with(free, burnt), paths, lines, within_mm)
        finishing = {done.out[0] for done in coverage.values() if done.out is not None} - taken
        taken |= finishing
        cut |= {ring for burn in finishing if (ring := own[burn]) is not None}
    coverage = {k: _given_up(done, around[k]) for k, done in coverage.items()}
    along = {**odd.along, **stretches_of(paths, around, sorted(taken - odd.along.keys()), within_mm)}
    made = {}
    for burn in sorted(taken):
        path = burns[burn].path
        row = pieces(burn, path, along.get(burn, []), coverage, around, kerf_mm, within_mm)
        whole = [
            (ring := around[piece.ring]) is not None
            and piece.out
            and is_whole(piece, coverage[piece.ring], burn, ring, free[piece.ring], within_mm)
            for piece in row
        ]
        made[burn] = list(_cut_out(nest, burns[burn], row, whole, rings))
    return {burn: cuts for burn, cuts in made.items() if cuts}


def _burnt_on(rings: Rings, before: Sequence[shapely.LineString], within_mm: float) -> dict[int, Floats]:
    """The stretches of rings that were burnt before, by the numbers of the rings."""
    if not before:
        return {}
    around = {k: ring for k, ring in enumerate(rings) if ring is not None}
    numbers = np.array(list(around), dtype=np.int64)
    near = np.unique(shapely.STRtree(list(around.values())).query(before, "dwithin", distance=within_mm)[1])
    met = numbers[near].tolist()
    found = covered([around[k] for k in met], [NONE] * len(met), chords_of_lines(before), within_mm)
    rows = {k: union(np.concatenate([NONE, *done.new.values()])) for k, done in zip(met, found, strict=True)}
    return {k: stretches for k, stretches in rows.items() if total_mm(stretches) > 2 * within_mm}


def _with(free: Mapping[int, Floats], more: Mapping[int, Floats]) -> dict[int, Floats]:
    return {k: union(np.concatenate([rows, more[k]])) if k in more else rows for k, rows in free.items()}


def _own(match: Match | None, line: shapely.LineString, within_mm: float) -> int | None:
    """The ring that a burn covers by itself, on whichever side of its contour; one that is too short does not."""
    if match is None or match.deviation_mm > within_mm or line.length < match.ring.length - 4 * within_mm:
        return None
    return match.contour


def _given_up(done: Covered, ring: shapely.LineString | None) -> Covered:
    """Where the most of a ring is covered, but not all, it counts as cut with the last burn that covers some of it."""
    if done.out is not None or ring is None or done.open_mm > ring.length / 2:
        return done
    last = max(done.new)
    return replace(done, out=(last, done.until_mm[last]))


def _coverage(
    numbers: Sequence[int],
    rings: Rings,
    free: Mapping[int, Floats],
    paths: Sequence[Curve | None],
    lines: Sequence[shapely.LineString],
    within_mm: float,
) -> dict[int, Covered]:
    """What all burns that come near some rings make of them."""
    if not numbers:
        return {}
    around = [ring for k in numbers if (ring := rings[k]) is not None]
    torch = [k for k, path in enumerate(paths) if path is not None and path.segments]
    tree = shapely.STRtree([lines[k] for k in torch])
    near = np.unique(tree.query(around, "dwithin", distance=within_mm)[1])
    burns = [torch[k] for k in near.tolist()]
    chords = chords_of_paths([path for k in burns if (path := paths[k]) is not None])
    found = covered(around, [free[k] for k in numbers], chords, within_mm)
    return {k: done.numbered(burns) for k, done in zip(numbers, found, strict=True)}


def _cut_out(nest: Nest, burn: Burn, row: Sequence[Piece], whole: Sequence[bool], rings: Rings) -> Iterator[CutOut]:
    path, begin_mm = burn.path, 0.0

    def piece_of(low_mm: float, high_mm: float) -> Curve:
        return _between(path, low_mm, high_mm)

    for number, piece in enumerate(row):
        contour = nest.contours[piece.ring]
        loop = piece_of(piece.join_mm, piece.leave_mm)
        alone = whole[number]
        run = TorchRun(
            0, f"line {burn.line}", contour, line_of(piece_of(piece.start_mm, piece.join_mm)),
            line_of(loop) or _dot(path.point_at(piece.join_mm)), line_of(piece_of(piece.leave_mm, piece.end_mm)),
            linked=number > 0, partial=not alone,
        )  # fmt: skip
        cut = _cut(contour, burn, piece, begin_mm, alone, rings, piece_of)
        yield CutOut(contour, cut, piece.out, run)
        begin_mm = piece.end_mm if piece.out else begin_mm


def _cut(
    contour: Contour,
    burn: Burn,
    piece: Piece,
    begin_mm: float,
    alone: bool,
    rings: Rings,
    piece_of: Callable[[float, float], Curve],
) -> Cut:
    path, since_mm = burn.path, piece.since_mm
    join, leave = path.point_at(since_mm), path.point_at(piece.leave_mm)
    followed = piece_of(since_mm, piece.leave_mm)
    entry = contour.curve.point_at(contour.curve.project(join)[0])
    lead_in = piece_of(begin_mm, since_mm)
    return Cut(
        contour.id, entry, _direction(contour, followed, rings[piece.ring], alone), path.point_at(begin_mm),
        lead_in if lead_in.segments else None, piece_of(piece.leave_mm, piece.end_mm), 0, _when_s(burn, begin_mm),
        _when_s(burn, piece.end_mm), linked=begin_mm > 0, span=None if alone else Span(join, leave),
    )  # fmt: skip


def _direction(contour: Contour, followed: Curve, ring: shapely.LineString | None, alone: bool) -> Direction:
    """Which way round a contour a path goes, be it all the way or along a stretch."""
    if alone or ring is None or not followed.segments:
        return "ccw" if followed.is_ccw else "cw"
    points = followed.flatten()
    at_mm = shapely.line_locate_point(ring, shapely.points(points))
    steps = np.diff(at_mm)
    steps = (steps + ring.length / 2) % ring.length - ring.length / 2
    ways = np.hypot(*np.diff(points, axis=0).T)
    onwards = float(steps[np.abs(steps) <= ways * 1.5 + 1e-6].sum()) > 0
    return "ccw" if onwards == bool(shapely.is_ccw(shapely.LinearRing(ring.coords))) else "cw"


def _when_s(burn: Burn, at_mm: float) -> float:
    """When a burn is so far along its path, were it to run evenly from its pierce on."""
    if at_mm <= 0:
        return burn.start_s
    return burn.end_s - burn.moving_s * (1 - at_mm / burn.path.length_mm)


def _between(path: Curve, low_mm: float, high_mm: float) -> Curve:
    """A piece of a path; where it goes nowhere, its one point."""
    if high_mm - low_mm > 1e-6:
        return path.between(low_mm, min(high_mm, path.length_mm) - low_mm)
    return Curve.of([path.point_at(low_mm)], closed=False)


def _dot(at: Point) -> shapely.LineString:
    return shapely.LineString([at, at])
