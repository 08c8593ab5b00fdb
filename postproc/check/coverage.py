"""Every contour once: burns that cut several contours, and contours that several burns cut."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.cut import Cut, CutSequence, Direction, Span, Tab
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.postproc.check.reader.program import Burn
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.registry import RULES

from .burn_pieces import Piece, Stretch, adds_mm, find_shared_burns, is_whole, pieces, stretches_of
from .matching import Match
from .plan_runs import NOTHING_BURNT, BurntBefore
from .result import RelaxedStatement
from .ring_coverage import (
    NONE,
    Covered,
    chords_of_lines,
    chords_of_paths,
    covered,
    intersection,
    rounds,
    tab_intervals,
    total_mm,
    union,
)
from .torch_run import TorchRun, line_of, tolerance_mm, torch_rings

_RULE = "every-contour-once"


def coverage(nest: Nest, cuts: CutSequence, relaxed: Sequence[RelaxedStatement] = ()) -> list[Violation]:
    """Contours left out, cut again, or not in the nest.

    One may be left out if the plan says so, naming with it the contour that it lies in, which was cut before a stop.
    """
    found: list[Violation] = []
    first: dict[str, int] = {}
    for position, cut in enumerate(cuts, 1):
        if cut.contour not in nest.index and nest.drawn is not None and cut.contour in nest.drawn.index:
            text = f"cut {position} is of {cut.contour}, which the profile leaves out"
        elif cut.contour not in nest.index:
            text = f"cut {position} is of {cut.contour}, which the nest does not have"
        elif cut.contour in first:
            text = f"{cut.contour} is cut again as cut {position}; it was cut as cut {first[cut.contour]}"
        else:
            first[cut.contour] = position
            continue
        found.append(Violation(_RULE, (cut.contour,), text, (position,)))
    cut_names = {cut.contour for cut in cuts[: cuts.made]}
    of_fallen_metal = {name for name, rule in RULES.items() if rule.of_fallen_metal}
    loose = {r.contours[0] for r in relaxed if r.rule in of_fallen_metal and _dropped(nest, r.contours, cut_names)}
    for contour in nest.contours:
        if contour.id not in first and contour.id not in loose:
            found.append(Violation(_RULE, (contour.id,), f"{contour.id} is not {_done(contour.kind)}"))
    return found


def _dropped(nest: Nest, contours: Sequence[str], names: Set[str]) -> bool:
    """Whether the first of two contours lies inside the second, which is cut through and out."""
    if len(contours) != 2 or not {*contours} <= nest.index.keys() or contours[1] not in names:
        return False
    inner, outer = (nest.contour(name) for name in contours)
    return outer.encloses and bool(outer.polygon.covers(inner.line))


def _done(kind: str) -> str:
    return "marked" if kind == "mark" else "cut"


def first_cuts(nest: Nest, cuts: CutSequence) -> CutSequence:
    """The cuts that rules can judge: those of the nest's contours, each the first time it is cut."""
    kept: dict[str, Cut] = {}
    places = {1: 1}  # of each cut, and of what comes after the last, among those that are kept
    for k, cut in enumerate(cuts, 2):
        if cut.contour in nest.index:
            kept.setdefault(cut.contour, cut)
        places[k] = len(kept) + 1
    past = len(kept) - len(cuts)  # a damaged plan names places that no cut has
    begun = tuple((places.get(k, k + past), cut) for k, cut in cuts.begun)
    pierces = tuple(replace(hole, before=places.get(hole.before, hole.before + past)) for hole in cuts.pierces)
    made = places.get(cuts.made + 1, 1) - 1
    return replace(cuts, cuts=tuple(kept.values()), made=made, begun=begun, pierces=pierces)


# What burns make of rings that no burn covers alone: stretches left open, burnt again, and tabs that are not there.

Tabs = Mapping[str, Sequence[Tab]]
_NAMED = 3


@dataclass(frozen=True, eq=False, slots=True)
class _Burnt:
    """One line that is burnt: by which run (None for what was cut before a stop), and whether of a whole round."""

    run: TorchRun | None
    line: shapely.LineString
    whole: bool


@dataclass(frozen=True, eq=False, slots=True)
class BurntRings:
    """Rings that several burns have to do with, what is burnt near them in order of time, and what that covers."""

    contours: tuple[Contour, ...]
    rings: tuple[shapely.LineString, ...]
    burnt: tuple[_Burnt, ...]
    coverage: tuple[Covered, ...]
    tabs: Tabs
    within_mm: float


def burnt_rings(
    contours: Iterable[Contour],
    runs: Sequence[TorchRun],
    before: BurntBefore,
    kerf_mm: float,
    tabs: Tabs,
) -> BurntRings:
    """The rings that runs share, of these contours, and those of parts that tabs hold since `before` a stop.

    None in an ordinary program.
    """
    within_mm = tolerance_mm(kerf_mm)
    named = [run for run in runs if run.contour is not None and not run.marks]
    shared = [run for run in named if run.linked or run.partial or run.name in tabs]
    held = before.out & tabs.keys()
    if not shared and not held:
        return BurntRings((), (), (), (), tabs, within_mm)
    closed = [c for c in contours if c.encloses]
    paired = [(c, r) for c, r in zip(closed, torch_rings(closed, kerf_mm), strict=True) if r is not None]
    tree = shapely.STRtree([r for _, r in paired])
    lines = np.array([line for run in shared for line in (run.loop, *run.leads)], dtype=object)
    of_held = [k for k, (contour, _) in enumerate(paired) if contour.id in held]
    near = np.union1d(tree.query(lines, "dwithin", distance=within_mm)[1], of_held).astype(np.int64).tolist()
    rings = tuple(paired[k][1] for k in near)
    burnt = list(_burnt(runs, before))
    by = np.unique(shapely.STRtree([b.line for b in burnt]).query(rings, "dwithin", distance=within_mm)[1]).tolist()
    burnt = [burnt[k] for k in by]
    free = [
        union(np.concatenate([rounds(ring, c), tab_intervals(ring, tabs.get(c.id, ()), within_mm)]))
        for c, ring in (paired[k] for k in near)
    ]
    coverage = covered(rings, free, chords_of_lines([b.line for b in burnt]), within_mm)
    return BurntRings(tuple(paired[k][0] for k in near), rings, tuple(burnt), tuple(coverage), tabs, within_mm)


def _burnt(runs: Sequence[TorchRun], before: BurntBefore) -> Iterator[_Burnt]:
    yield from (_Burnt(None, line, True) for line in before.rounds)
    yield from (_Burnt(None, line, False) for line in before.others)
    for run in runs:
        if not run.marks:
            all_round = run.between_tabs or not run.partial
            for line, whole in ((run.lead_in, False), (run.loop, all_round), (run.lead_out, False)):
                if line is not None and line.length > 0:
                    yield _Burnt(run, line, whole and run.contour is not None)


def open_contours(found: BurntRings, positions: Mapping[str, int]) -> Iterator[Violation]:
    """Contours of which burns cut something, but not all; `positions` are those of cuts."""
    for contour, ring, done in zip(found.contours, found.rings, found.coverage, strict=True):
        own = [b.run for b in found.burnt if b.run is not None and b.run.contour is contour]
        if done.out is not None or not own or contour.id not in positions:
            continue
        low, high = max(done.open, key=lambda stretch: stretch[1] - stretch[0])
        x, y = _at(ring, (low + high) / 2)
        by = list(dict.fromkeys(run.where for run in own))
        text = " and ".join(by[:_NAMED]) + (" and others" if len(by) > _NAMED else "")
        yield Violation(
            "every-contour-once",
            (contour.id,),
            f"{contour.id} is not cut all along: {done.open_mm:.1f} mm are left, at ({x:z.1f}, {y:z.1f}); "
            f"{text} cut it",
            (positions[contour.id],),
        )


def finished_by_others(found: BurntRings, positions: Mapping[str, int]) -> Iterator[Violation]:
    """Contours of a plan that are out only with a later cut of another contour; `positions` are those of cuts."""
    for contour, done in zip(found.contours, found.coverage, strict=True):
        own = [k for k, b in enumerate(found.burnt) if b.run is not None and b.run.contour is contour]
        if done.out is None or not own or done.out[0] <= own[-1] or contour.id not in positions:
            continue
        last = found.burnt[done.out[0]].run
        assert last is not None  # what was burnt before a stop comes before every run
        text = (
            f"{contour.id} is not out with its own cut {positions[contour.id]}: {last.where} of {last.name} finishes it"
        )
        yield Violation(_RULE, (contour.id, last.name), text, (positions[contour.id],))


def burnt_twice(found: BurntRings, allowed_mm: float) -> Iterator[Violation]:
    """Stretches of rings that are burnt again for more than overcuts and leads are long.

    Two contours that stand a kerf apart may each be cut all round.
    """
    worst: dict[int, tuple[float, str, Point]] = {}
    for contour, ring, done in zip(found.contours, found.rings, found.coverage, strict=True):
        for k, again in done.again.items():
            mine = found.burnt[k]
            if mine.run is None:
                continue
            if mine.whole:
                before = [
                    rows for j, rows in done.new.items() if j < k and not _round_another(found.burnt[j], mine.run)
                ]
                again = intersection(again, union(np.concatenate([np.empty((0, 2)), *before])))
            longest_mm = total_mm(again)
            if longest_mm > allowed_mm and longest_mm > worst.get(k, (0.0,))[0] + 1e-6:
                low, high = max(again.tolist(), key=lambda stretch: stretch[1] - stretch[0])
                worst[k] = longest_mm, contour.id, _at(ring, (low + high) / 2)
    for k, (again_mm, name, (x, y)) in sorted(worst.items()):
        run = found.burnt[k].run
        assert run is not None
        yield run.wrong("burnt-twice", f"{again_mm:.1f} mm of {name} are burnt again, at ({x:z.1f}, {y:z.1f})", name)


def _round_another(burnt: _Burnt, run: TorchRun) -> bool:
    """Whether a line goes all round another contour than a run does."""
    return burnt.whole and (burnt.run is None or burnt.run.contour is not run.contour)


def burnt_tabs(found: BurntRings) -> Iterator[Violation]:
    """Tabs that are burnt, in part at least."""
    for contour, ring, done in zip(found.contours, found.rings, found.coverage, strict=True):
        burnt = union(np.concatenate([np.empty((0, 2)), *done.new.values()]))
        for tab in found.tabs.get(contour.id, ()):
            place = tab_intervals(ring, [tab], 0.0)
            lost_mm = total_mm(intersection(place, burnt))
            if lost_mm > 2 * found.within_mm:
                x, y = tab.at
                text = (
                    f"{lost_mm:.2f} of {tab.width_mm:g} mm of the tab of {contour.id} at ({x:z.1f}, {y:z.1f}) are cut"
                )
                yield Violation("tabs", (contour.id,), text)


def _at(ring: shapely.LineString, at_mm: float) -> Point:
    point = shapely.line_interpolate_point(ring, at_mm % ring.length)
    return point.x, point.y


Rings = Sequence[shapely.LineString | None]


@dataclass(frozen=True, eq=False, slots=True)
class CutOut:
    """One contour that is out, or a stretch of one that is not: how it is cut, and the torch's path.

    `begun` are the stretches of contours that a burn cuts which finishes none, each as a cut of its own, linked.
    """

    contour: Contour
    cut: Cut
    out: bool
    run: TorchRun
    begun: tuple[Cut, ...] = ()


def shared_cuts(
    nest: Nest,
    burns: Sequence[Burn],
    lines: Sequence[shapely.LineString],
    matches: Sequence[Match | None],
    rings: Rings,
    kerf_mm: float,
    before: BurntBefore = NOTHING_BURNT,
) -> dict[int, list[CutOut]]:
    """For each burn that does not cut one contour all by itself, what it cuts, in order; the others are left out.

    What was burnt `before` a stop is burnt; contours that were cut then are out, and not cut by what runs along them.
    """
    within_mm = tolerance_mm(kerf_mm)
    paths = [burn.path if burn.tool == 0 else None for burn in burns]
    around = [ring if contour.encloses else None for ring, contour in zip(rings, nest.contours, strict=True)]
    own = _own(matches, lines, within_mm)
    left = [None if contour.id in before.out else ring for ring, contour in zip(around, nest.contours, strict=True)]
    burnt = _burnt_on(left, before.lines, within_mm)
    odd = find_shared_burns(paths, lines, around, own, within_mm, burnt.keys() - set(own))
    if not odd.burns:
        return {}
    free: dict[int, Floats] = {}
    taken, cut = set(odd.burns), set(odd.rings)
    coverage: dict[int, Covered] = {}
    while more := cut - coverage.keys():
        free |= dict.fromkeys(more, NONE)
        coverage |= _coverage(sorted(more), around, _with(free, burnt), paths, lines, within_mm)
        open_yet = sorted(k for k in more if coverage[k].out is None)
        free |= {k: union(np.concatenate([free[k], rounds(around[k], nest.contours[k])])) for k in open_yet}
        coverage |= _coverage(open_yet, around, _with(free, burnt), paths, lines, within_mm)
        finishing = {done.out[0] for done in coverage.values() if done.out is not None} - taken
        taken |= finishing
        cut |= {ring for burn in finishing if (ring := own[burn]) is not None}
    coverage = {k: _given_up(done, around[k]) for k, done in coverage.items()}
    along = {**odd.along, **stretches_of(paths, around, sorted(taken - odd.along.keys()), within_mm)}
    by_path = {}
    for burn in sorted(taken):
        path = burns[burn].path
        row = pieces(burn, path, along.get(burn, []), coverage, around, kerf_mm, within_mm)
        whole = [
            (ring := around[piece.ring]) is not None
            and piece.out
            and is_whole(piece, coverage[piece.ring], burn, ring, free[piece.ring], within_mm)
            for piece in row
        ]
        by_path[burn] = list(_cut_out(nest, burns[burn], row, whole, rings))
        if by_path[burn] and not any(cut.out for cut in by_path[burn]):
            begun = tuple(_begun(nest, burns[burn], _new_along(along.get(burn, []), coverage, burn, within_mm), rings))
            by_path[burn][0] = replace(by_path[burn][0], begun=begun)
    return {burn: cuts for burn, cuts in by_path.items() if cuts}


def _new_along(
    row: Sequence[Stretch], coverage: Mapping[int, Covered], burn: int, within_mm: float
) -> Iterator[Stretch]:
    """The stretches of a burn that cover something of a ring which nothing has covered before."""
    for stretch in row:
        new = coverage[stretch.ring].new.get(burn) if stretch.ring in coverage else None
        if new is not None and adds_mm(stretch, new) > 2 * within_mm:
            yield stretch


def _begun(nest: Nest, burn: Burn, row: Iterable[Stretch], rings: Rings) -> Iterator[Cut]:
    """The stretches of a burn as cuts that leave their contours unfinished, in order."""
    path, at_mm = burn.path, 0.0
    for k, stretch in enumerate(row):
        contour = nest.contours[stretch.ring]
        low_mm, high_mm = float(stretch.low_mm), float(min(stretch.high_mm, path.length_mm))
        join, followed = path.point_at(low_mm), _between(path, low_mm, high_mm)
        lead_in = _between(path, at_mm, low_mm) if low_mm > at_mm else None
        yield Cut(
            contour.id, contour.curve.nearest(join),
            _direction(contour, followed, rings[stretch.ring], False), path.point_at(min(at_mm, low_mm)), lead_in,
            Curve.of([path.point_at(high_mm)], closed=False), 0, _when_s(burn, min(at_mm, low_mm)),
            _when_s(burn, high_mm), linked=k > 0, span=Span(join, path.point_at(high_mm)),
        )  # fmt: skip
        at_mm = high_mm


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


def _own(matches: Sequence[Match | None], lines: Sequence[shapely.LineString], within_mm: float) -> list[int | None]:
    """For each burn the ring that it covers by itself, on whichever side of its contour.

    One that is too short covers none; where another burn cuts some of the ring, a lead may have made up the length.
    """
    pairs = list(zip(matches, lines, strict=True))
    short = [
        m is None or m.deviation_mm > within_mm or line.length < m.ring.length - 4 * within_mm for m, line in pairs
    ]
    doubted = {m.contour for (m, _), is_short in zip(pairs, short, strict=True) if m is not None and is_short}
    return [
        None
        if m is None or is_short or (m.contour in doubted and _uncut_mm(m.ring, line, within_mm) > 4 * within_mm)
        else m.contour
        for (m, line), is_short in zip(pairs, short, strict=True)
    ]


def _uncut_mm(ring: shapely.LineString, line: shapely.LineString, within_mm: float) -> float:
    return float(shapely.difference(ring, shapely.buffer(line, 2 * within_mm)).length)


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
    entry = contour.curve.nearest(join)
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
