"""What the torch burns besides its contours: parts that the kerf enters, and places beyond the sheet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kerfwise.encoder.geometry.curve import polygons_of
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.kept import kept_with_nest
from kerfwise.encoder.nest import Nest, Part
from kerfwise.rules.rule import Violation

from .followed_contours import surely_beside
from .program_rules import tolerance_mm
from .rings import Ring, rings_of
from .torch_run import TorchRun

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
    if kerf_mm <= 0 or not burns or not nest.parts:
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
    asked = [(k, burn) for k, burn in enumerate(burns) if not burn.lead and burn.run.contour is not None]
    rings = [(k, burn.run, ring) for k, burn in asked if (ring := clear.get(burn.run.name)) is not None]
    gone = {k for k, run, ring in rings if run.loop is ring or run.follows is ring}
    others = [row for row in rings if row[0] not in gone]
    loops, along = [run.loop for _, run, _ in others], [ring for *_, ring in others]
    beside = surely_beside(loops, along, 0.0, tolerance_mm(kerf_mm))
    gone |= {k for (k, _, _), near in zip(others, beside.tolist(), strict=True) if near}
    return [burn for k, burn in enumerate(burns) if k not in gone]


@kept_with_nest(most=1)
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


@kept_with_nest(most=1)
def metal_of_parts(nest: Nest) -> Any:
    """The metal of each part: a plan and its program ask for the same."""
    return every_metal_of(nest.parts)


def every_metal_of(parts: Sequence[Part]) -> Any:
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
    depths_mm = shapely.distance(shapely.boundary(metal), shapely.points(points))
    k = int(np.argmax(depths_mm))
    x, y = points[k].tolist()
    return half_mm + float(depths_mm[k]), (x, y)


def _gouge(burn: _Burn, part: str, depth_mm: float, burnt_mm2: float, place: Point) -> Violation:
    run = burn.run
    contours = () if run.contour is None else (run.contour.id,)
    what = "a lead" if burn.lead else "the kerf"
    return Violation(
        "no-gouging",
        (*contours, f"{part}.outer"),
        f"{run.where}: {what} of {run.name} reaches {depth_mm:.3f} mm into the metal of {part} at "
        f"({place[0]:z.1f}, {place[1]:z.1f}) and burns {burnt_mm2:.1f} mm² of it",
        (run.position,) if run.position else (),
    )


def off_sheet(nest: Nest, runs: Sequence[TorchRun], kerf_mm: float, run_up_mm: float = 0.0) -> list[Violation]:
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
                contours = () if run.contour is None else (run.contour.id,)
                out_mm = float(shapely.length(off).sum())
                text = f"{run.where}: {out_mm:.1f} mm of the path of {run.name} lie off the sheet"
                found.append(Violation("on-sheet", contours, text, (run.position,) if run.position else ()))
                break
    return found
