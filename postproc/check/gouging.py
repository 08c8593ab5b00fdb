"""What the torch burns besides its contours: parts that the kerf enters, touching edges."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.encoder.display import join_names
from kerfwise.encoder.geometry.curve import polygons_of
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest
from kerfwise.rules.judging.violation import Violation

from .contour_following import surely_beside
from .torch_run import Ring, TorchRun, rings_of, tolerance_mm

Pairs = frozenset[frozenset[str]]
"""Pairs of parts, by their ids."""

SLACK_MM = 0.01
"""What the chords of paths and contours may make of a depth."""
_CHORD_MM = 0.002
_STEP_MM = 0.1


@dataclass(frozen=True, slots=True)
class Gouges:
    """Violations of no-gouging, and warnings about parts that stand closer than the kerf is wide."""

    violations: tuple[Violation, ...]
    warnings: tuple[str, ...]


@dataclass(frozen=True, eq=False, slots=True)
class _Burn:
    """One path of a run, the round or a lead."""

    run: TorchRun
    line: shapely.LineString
    lead: bool


def gouges(
    nest: Nest,
    runs: Sequence[TorchRun],
    kerf_mm: float,
    shared: Pairs | None = frozenset(),
    losses_mm: Mapping[str, float] | None = None,
) -> Gouges:
    """Where the kerf, half its width to each side of the torch, reaches more than the tolerance into a part's metal.

    `shared` are pairs of parts whose metal the rounds of each may burn: those that the plan says are relaxed, or all
    (None) where the rule shared-metal is off. Where all may, a warning names those that do. What a lead burns beyond
    its round is a gouge there too. `losses_mm` are what parts may lose besides to passes along slots of their own, by
    the contour id of the pass.
    """
    half_mm, allowed_mm = kerf_mm / 2, tolerance_mm(kerf_mm) + SLACK_MM
    burns = [_Burn(run, run.loop, False) for run in runs if not run.marks]
    burns += [_Burn(run, lead, True) for run in runs if not run.marks for lead in run.leads]
    if kerf_mm <= 0 or not nest.parts:
        return Gouges((), ())
    metal = metal_of_parts(nest)
    burns = _not_clear(nest, burns, kerf_mm)
    lines = np.array([burn.line for burn in burns], dtype=object)
    rows, parts = shapely.STRtree(metal).query(lines, predicate="dwithin", distance=max(half_mm - allowed_mm, 0.0))
    violations: list[Violation] = []
    warned: dict[tuple[str, str], float] = {}
    for k, p in sorted(zip(rows.tolist(), parts.tolist(), strict=True)):
        burn, part, struck = burns[k], nest.parts[p].id, metal[p]
        own = burn.run.contour.part if burn.run.contour is not None else part
        pair = (min(own, part), max(own, part))
        let = own != part and (shared is None or frozenset(pair) in shared)
        slit = burn.run.contour is not None and burn.run.contour.kind == "slit"
        if (let or slit) and burn.lead:  # near its join a lead runs in the kerf of the round, or of the slit
            struck = shapely.difference(struck, shapely.buffer(burn.run.loop, half_mm))
        depth_mm, place = _deepest(burn.line, struck, half_mm)
        lost_mm = (losses_mm or {}).get(burn.run.name, 0.0) if own == part and not burn.lead else 0.0
        if depth_mm <= allowed_mm + lost_mm:
            continue
        if let and not burn.lead:
            warned[pair] = max(warned.get(pair, 0.0), depth_mm)
            continue
        burnt_mm2 = float(shapely.area(shapely.intersection(shapely.buffer(burn.line, half_mm), struck)))
        violations.append(_gouge(burn, part, depth_mm, burnt_mm2, place))
    warnings = [
        f"{a} and {b} are less than the kerf of {kerf_mm:g} mm apart: each cut takes metal of both, up to {mm:.3f} mm"
        for (a, b), mm in sorted(warned.items())
    ]
    return Gouges(tuple(violations), tuple(warnings) if shared is None else ())


def _not_clear(nest: Nest, burns: Sequence[_Burn], kerf_mm: float) -> list[_Burn]:
    """The burns without rounds that surely gouge nothing: they lie within the tolerance of a ring that is clear."""
    clear = _clear_rings(nest, kerf_mm)
    queries = [(k, burn) for k, burn in enumerate(burns) if not burn.lead and burn.run.contour is not None]
    rings = [(k, burn.run, ring) for k, burn in queries if (ring := clear.get(burn.run.name)) is not None]
    gone = {k for k, run, ring in rings if run.loop is ring or run.follows is ring}
    others = [row for row in rings if row[0] not in gone]
    loops, along = [run.loop for _, run, _ in others], [ring for *_, ring in others]
    beside = surely_beside(loops, along, 0.0, tolerance_mm(kerf_mm))
    gone |= {k for (k, _, _), near in zip(others, beside.tolist(), strict=True) if near}
    return [burn for k, burn in enumerate(burns) if k not in gone]


@cached_with_nest(most=1)
def _clear_rings(nest: Nest, kerf_mm: float) -> Mapping[str, Ring]:
    """Contour id → its torch ring, where no metal is nearer to that than half the kerf, but for what chords make of it.

    What lies within the tolerance of such a ring is no nearer to metal than a kerf may come.
    """
    rings = {c.id: ring for c, ring in zip(nest.contours, rings_of(nest, kerf_mm), strict=True) if ring and c.encloses}
    lines = np.array(list(rings.values()), dtype=object)
    away_mm = kerf_mm / 2 - SLACK_MM
    if away_mm <= 0 or not len(lines):
        return {}
    near = set(shapely.STRtree(metal_of_parts(nest)).query(lines, predicate="dwithin", distance=away_mm)[0].tolist())
    return {name: ring for k, (name, ring) in enumerate(rings.items()) if k not in near}


@cached_with_nest(most=1)
def metal_of_parts(nest: Nest) -> Any:
    """The metal of each part: a plan and its program ask for the same."""
    return part_metal(nest.parts)


def part_metal(parts: Sequence[Part]) -> Any:
    """The metal of each part in fine chords, whether shapely calls its rings valid or not."""
    curves = [contour.curve for part in parts for contour in (part.outer, *part.holes)]
    areas = shapely.make_valid(polygons_of(curves, _CHORD_MM))
    first = np.cumsum([0, *(1 + len(part.holes) for part in parts)])
    metal = areas[first[:-1]]
    for k, part in enumerate(parts):
        if part.holes:
            metal[k] = shapely.difference(metal[k], shapely.union_all(areas[first[k] + 1 : first[k + 1]]))
    return metal


def _deepest(line: shapely.LineString, metal: shapely.Geometry, half_mm: float) -> tuple[float, Point]:
    """How deep the kerf along a line reaches into metal (0 or less: not at all), mm, and where."""
    if metal.is_empty:
        return 0.0, (0.0, 0.0)
    gap_mm = float(shapely.distance(line, metal))
    if gap_mm > 0:
        x, y = shapely.get_coordinates(shapely.shortest_line(line, metal))[-1].tolist()
        return half_mm - gap_mm, (x, y)
    stands = line.length == 0  # for shapely such a line has nothing in common with any area
    inside = line if stands else shapely.segmentize(shapely.intersection(line, metal), _STEP_MM)
    points = shapely.get_coordinates(inside)
    if not len(points):  # they touch, to within what a number tells
        points = shapely.get_coordinates(shapely.shortest_line(line, metal))
    depths_mm = shapely.distance(shapely.boundary(metal), shapely.points(points))
    k = int(np.argmax(depths_mm))
    x, y = points[k].tolist()
    return half_mm + float(depths_mm[k]), (x, y)


def _gouge(burn: _Burn, part: str, depth_mm: float, burnt_mm2: float, place: Point) -> Violation:
    run = burn.run
    contours = () if run.contour is None else (run.contour.id,)
    what = "a lead" if burn.lead else "the kerf"
    text = (
        f"{what} of {run.name} reaches {depth_mm:.3f} mm into the metal of {part} at "
        f"({place[0]:z.1f}, {place[1]:z.1f}) and burns {burnt_mm2:.1f} mm² of it"
    )
    return run.wrong("no-gouging", text, *contours, f"{part}.outer")


def paths_off_sheet(nest: Nest, runs: Sequence[TorchRun], kerf_mm: float, run_up_mm: float = 0.0) -> list[Violation]:
    """Torch-on paths that leave the sheet, by more than paths may be off anyhow.

    What a lead-in that begins off the sheet has there is lawful where edge starts are, so where `run_up_mm` is over 0;
    no further from the sheet than that.
    """
    sheet = shapely.make_valid(nest.sheet.polygon)
    allowed = shapely.buffer(sheet, tolerance_mm(kerf_mm))
    shapely.prepare(allowed)
    found: list[Violation] = []
    paths = [[run.loop, *run.leads] for run in runs]
    inside = iter(shapely.covers(allowed, np.array([line for row in paths for line in row], dtype=object)).tolist())
    for run, row in zip(runs, paths, strict=True):
        for line in [line for line in row if not next(inside)]:
            off = shapely.get_parts(shapely.difference(line, sheet))
            if line is run.lead_in and run_up_mm and not run.linked:
                begin = shapely.get_point(line, 0)
                if shapely.distance(begin, sheet) <= run_up_mm:
                    off = off[shapely.distance(off, begin) > SLACK_MM]
            if not shapely.covers(allowed, off).all():
                out_mm = float(shapely.length(off).sum())
                found.append(run.wrong("on-sheet", f"{out_mm:.1f} mm of the path of {run.name} lie off the sheet"))
                break
    return found


# What parts that touch lose to the one cut between them: no more than half a kerf, and only along edges that touch.

_RULE = "edge-loss"
_LOSS_CHORD_MM, _SLACK_MM, _LEAST_MM2 = 0.001, 0.01, 0.01
_NAMED = 5
_MEETS, _SURELY = 2, 20
"""An edge that comes to another outline at a right angle is near it for twice as far as counts as touching; edges that
touch for 20 times as far do not only do so near a corner."""
_ALONG, _INSIDE_MM = math.sin(math.radians(0.19)), 0.002
"""Edges that turn by less, and are nearer by so much than counts as touching, do touch: at a larger angle they part."""


@dataclass(frozen=True, slots=True)
class Accepted:
    """Which losses are accepted: along edges that touch, within `touch_mm`, if one of the edges by which the parts hang
    together touches along `shortest_mm`, which is infinite where no loss is."""

    touch_mm: float
    shortest_mm: float


@dataclass(frozen=True, eq=False, slots=True)
class _Touching:
    """The straight edges of a drawn outline that touch others, those of them that surely do, along another edge and
    not only near a corner, the parts that they touch, and along how much at the most, mm."""

    edges: tuple[Segment, ...]
    surely: tuple[Segment, ...]
    others: tuple[int, ...]
    longest_mm: float


def wrong_edge_losses(nest: Nest, kerf_mm: float, accepted: Accepted) -> Iterator[Violation]:
    """Where a part that is judged is not the drawn one less half a kerf along straight edges that touch another part.

    Found from the areas of the drawn part and of the judged one, whoever made that: edges touch where another outline
    is no more than `touch_mm` away along some of them. The whole strip along such an edge has to be lost, nothing else
    may be, and the loss has to be one that is accepted.
    """
    drawn = nest.drawn
    if drawn is None:
        return
    pairs = enumerate(zip(drawn.parts, nest.parts, strict=True))
    changed = {
        k: (before, after)
        for k, (before, after) in pairs
        if after.outer.curve is not before.outer.curve and before.outer.bevel is None
    }
    if not changed:
        return
    outlines = [part.outer.curve.line(_LOSS_CHORD_MM) for part in drawn.parts]
    tree = shapely.STRtree(outlines)
    touching = {k: _touching(k, drawn, outlines, tree, accepted.touch_mm) for k in changed}
    longest_mm = _longest_mm(touching)
    for k, (before, after) in changed.items():
        name, along_mm = before.outer.id, longest_mm[k]
        if along_mm < accepted.shortest_mm - 2 * accepted.touch_mm:
            least = "the profile accepts no loss"
            if math.isfinite(accepted.shortest_mm):
                least = f"its parts touch along {along_mm:.2f} mm at the most, {accepted.shortest_mm:g} are asked"
            yield Violation(
                _RULE, (name,), f"{name} loses metal along its edges (cuts.common.accept_loss), and {least}"
            )
            continue
        for area, does in _wrongly(before.outer, after.outer, kerf_mm / 2, touching[k]):
            if area.area > _LEAST_MM2:
                x, y = area.centroid.coords[0]
                what = does.format(f"{area.area:.2f} mm² at ({x:z.1f}, {y:z.1f})")
                yield Violation(_RULE, (name,), f"{name} {what}")


def _wrongly(
    before: Contour, after: Contour, by_mm: float, touching: _Touching
) -> Iterator[tuple[shapely.Geometry, str]]:
    """Areas that a part loses, gains or keeps, and should not."""
    was, now = (contour.curve.polygon(_LOSS_CHORD_MM) for contour in (before, after))
    allowed = _strips(touching.edges, by_mm + _SLACK_MM, before.polygon.length)
    lost = shapely.intersection(_strips(touching.surely, by_mm - _SLACK_MM, 0.0), was)
    yield shapely.difference(shapely.difference(was, now), allowed), "loses {}, where no edge touches"
    yield shapely.difference(now, was), "gains {}, where no edge touches"
    yield shapely.intersection(now, lost), "keeps {}, beside an edge that touches"


def _touching(
    k: int, drawn: Nest, outlines: list[shapely.LineString], tree: shapely.STRtree, touch_mm: float
) -> _Touching:
    edges = [s for s in drawn.parts[k].outer.curve.segments if not s.is_arc]
    lines = shapely.linestrings([(s.start, s.end) for s in edges])
    near = [j for j in tree.query(outlines[k], "dwithin", distance=touch_mm).tolist() if j != k]
    meet_mm = np.array([
        shapely.length(shapely.intersection(lines, shapely.buffer(outlines[j], touch_mm))) for j in near
    ]).reshape(len(near), len(edges))  # fmt: skip
    own = tuple(edges[e] for e in np.flatnonzero((meet_mm > _MEETS * touch_mm).any(axis=0)).tolist())
    others_edges = [s for j in near for s in drawn.parts[j].outer.curve.segments if not s.is_arc]
    surely = tuple(edge for edge in own if _surely_touches(edge, others_edges, touch_mm))
    others = np.flatnonzero((meet_mm > _MEETS * touch_mm).any(axis=1)).tolist()
    return _Touching(own, surely, tuple(near[j] for j in others), float(meet_mm.max(initial=0.0)))


def _surely_touches(edge: Segment, others: Sequence[Segment], touch_mm: float) -> bool:
    """Whether an edge lies along one of others for as far as they look at each other."""
    if not others:
        return False
    along = np.array(edge.tangent_at(0.0))
    ends = np.array([(s.start, s.end) for s in others]) - np.array(edge.start)
    at_mm, off_mm = ends @ along, ends @ np.array([-along[1], along[0]])
    step_mm = at_mm[:, 1] - at_mm[:, 0]
    slope = np.divide(off_mm[:, 1] - off_mm[:, 0], step_mm, out=np.full(len(others), np.inf), where=step_mm != 0)
    low, high = np.maximum(at_mm.min(axis=1), 0.0), np.minimum(at_mm.max(axis=1), edge.length_mm)
    k = np.flatnonzero((np.abs(slope) <= _ALONG) & (high - low > _SURELY * touch_mm))
    off = [off_mm[k, 0] + slope[k] * (place_mm[k] - at_mm[k, 0]) for place_mm in (low, high)]
    return bool((np.abs(off).max(axis=0, initial=0.0) <= touch_mm - _INSIDE_MM).any())


def _longest_mm(touching: Mapping[int, _Touching]) -> dict[int, float]:
    """Along how much one of the edges touches, at the most, by which each part hangs together with others."""
    touched_by = defaultdict(list)
    for k, row in touching.items():
        for j in row.others:
            touched_by[j].append(k)
    found: dict[int, float] = {}
    for k in sorted(touching, key=lambda k: touching[k].longest_mm, reverse=True):
        ahead = [k]
        while ahead:
            if (one := ahead.pop()) not in found:
                found[one] = touching[k].longest_mm
                ahead += touched_by[one]
    return found


def _strips(edges: Sequence[Segment], wide_mm: float, further_mm: float) -> shapely.Geometry:
    """What lies so near to the lines of edges, that far beyond their ends."""
    lines = shapely.union_all([_line(s, further_mm) for s in edges])
    return shapely.buffer(lines, wide_mm, cap_style="flat")


def _line(s: Segment, by_mm: float) -> shapely.LineString:
    """The line of an edge, so much longer at both ends."""
    (x, y), (dx, dy) = s.start, s.tangent_at(0.0)
    far = s.length_mm + by_mm
    return shapely.LineString([(x - by_mm * dx, y - by_mm * dy), (x + far * dx, y + far * dy)])


def edge_loss_notes(nest: Nest) -> Iterator[str]:
    """That parts lose metal: a check never passes over it in silence."""
    if not nest.losses:
        return
    names = [f"{loss.contour} ({loss.loss_mm:.3g} mm)" for loss in nest.losses]
    parts = "a part that touches another loses" if len(names) == 1 else f"{len(names)} parts that touch others lose"
    yield f"{parts} half a kerf along those edges (cuts.common.accept_loss): {join_names(names, _NAMED)}"
    if marks := list(_marks_lost(nest)):
        yield f"made and then cut away, where the part loses its edge: {join_names(marks, _NAMED)}"


def _marks_lost(nest: Nest) -> Iterator[str]:
    """Marks of which something lies in what their part loses."""
    if nest.drawn is None:
        return
    losing = {loss.contour for loss in nest.losses}
    for before, after in zip(nest.drawn.parts, nest.parts, strict=True):
        if before.outer.id in losing:
            lost = shapely.difference(before.outer.polygon, after.outer.polygon)
            yield from (mark.id for mark in after.marks if shapely.intersection(mark.line, lost).length > _SLACK_MM)
