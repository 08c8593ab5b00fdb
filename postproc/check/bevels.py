"""Bevels as a program cuts them: held against parts and sheet at every depth, and made plain for the rest of the check.

A tilted torch burns elsewhere at every depth. What it burns there is found here anew, from the program's own words and
the nest as drawn: no pass enters a part or leaves the sheet, each bevel is cut on all of its face, and loops and leads
lie in waste that no other cut has burnt. The other promises and the rules then see one upright burn along each contour
in the place of its tilted passes.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import ops

from kerfwise.arrays import Floats
from kerfwise.encoder.geometry.curve import Curve, lines_of
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.postproc.check.reader.program import Burn, NcProgram
from kerfwise.postproc.dialects import pierce_dwell_of
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.technique import Technique

from .jets import (
    ANGLE_DEG,
    Jet,
    Root,
    Slope,
    cut_away_mm,
    face_area,
    half_width_mm,
    jet_of,
    root_ring,
    roots_of,
    section_of,
    sides_of,
    slopes_of,
    torch_burns,
)
from .torch_run import tolerance_mm

_RULE = "bevels"
_SHARE = 0.8
"""A pass follows a contour where it covers so much of the way that it should go."""
_SAMPLE_MM, _NEAR_MM, _WAIT_S = 0.5, 0.06, 2e-3
_STEPS = 17
"""Depths that are looked at, beside the roots, for each 20 mm and at the least."""
_KG = 1e-9


# The judgement, and the program that the rest of the check sees.


@dataclass(frozen=True, eq=False, slots=True)
class BevelsJudged:
    """A program with one upright burn along each contour, and what is wrong with its bevels; None without any."""

    program: NcProgram
    violations: tuple[Violation, ...] | None = None


def upright(nest: Nest, program: NcProgram, profile: Technique) -> NcProgram:
    """The program with one upright burn along each contour with a bevel, for those who look for its cuts."""
    return judge_bevels(nest, program, profile, {}).program


def judge_bevels(
    nest: Nest, program: NcProgram, profile: Technique, shares: Mapping[str, tuple[float, float]]
) -> BevelsJudged:
    """Judge the tilted burns of a program; `nest` has its bevels as they are drawn.

    `shares` are the least and the greatest share of the cut feed at which small holes are cut.
    """
    drawn = nest.drawn or nest
    bevelled = [c for c in drawn.contours if c.bevelled]
    found: list[tuple[tuple[str, ...], str]] = []
    together: dict[int, Burn] = {}  # the burns of a block's torches, each with that of the block
    if profile.cuts.bevel.head == "block":
        each = list(torch_burns(program, profile, found))
        program = replace(program, burns=tuple(burn for burn, _ in each))
        together = {k: block for k, (_, block) in enumerate(each) if block is not None}
    tilted = [k for k, burn in enumerate(program.burns) if burn.tilted]
    if not bevelled and not tilted:
        return BevelsJudged(program)
    jets = {k: jet_of(program.burns[k], profile) for k in tilted}
    passes = _passes(bevelled, jets, profile, found)
    for k, jet in jets.items():
        if not any(k in of for of in passes.values()):
            found.append(((), f"line {jet.burn.line}: a tilted burn follows no bevel of the nest"))
    share_of = {k: shares.get(name, (1.0, 1.0)) for name, of in passes.items() for k in of}
    for k in share_of.keys() & together.keys():  # they go as fast as the one that leans most
        slowest = min(jets[j].burn.lean_share for j in jets if together.get(j) is together[k])
        low, high = share_of[k]
        by = slowest / jets[k].burn.lean_share
        share_of[k] = low * by, high * by
    changes = {k for contour in bevelled if contour.edge_bevels for k in passes[contour.id]}
    found += _unsteady(jets, share_of, changes, profile)
    uprights, upright_line = _upright_of(bevelled, program, profile)
    found += _loose(drawn, program, bevelled, passes, uprights, profile)
    found += _metal(drawn, bevelled, jets, passes, upright_line, profile)
    found += _meeting(program, jets, passes, bevelled, uprights, profile)
    burns: list[Burn] = []
    contours = {c.id: c for c in bevelled}
    last = {max(of) if contours[name].edge_bevels else of[-1]: (name, of) for name, of in passes.items() if of}
    for k, burn in enumerate(program.burns):
        if k in last and k in together:
            slowest = min(jets[j].burn.lean_share for j in jets if together.get(j) is together[k])
            made = _made_upright(jet_of(together[k], profile), contours[last[k][0]], profile)
            burns.append(replace(made, step_feeds_mm_s=tuple(feed / slowest for feed in made.step_feeds_mm_s)))
        elif k not in jets and k not in together:
            burns.append(burn)
        elif k in last:
            contour = contours[last[k][0]]
            slopes, square = slopes_of(contour.bevel, profile.material.thickness_mm)
            if contour.id not in uprights and (contour.edge_bevels or (not square and len(last[k][1]) == len(slopes))):
                burns.append(_made_upright(jets[k], contour, profile))
    violations = tuple(Violation(_RULE, names, text) for names, text in found)
    return BevelsJudged(replace(program, burns=tuple(burns)), violations)


def _passes(
    bevelled: Sequence[Contour], jets: dict[int, Jet], profile: Technique, found: list[tuple[tuple[str, ...], str]]
) -> dict[str, list[int]]:
    """The burns that make each bevel, in the order of its slopes."""
    taken: dict[str, list[int]] = {}
    for contour in bevelled:
        taken[contour.id] = []
        for root in roots_of(contour, profile):
            slope, line = root.slope, root.line
            near = []
            for k, jet in jets.items():
                if line is None or not shapely.dwithin(shapely.box(*line.bounds), jet.line(slope.root_mm), 1.0):
                    continue
                along_mm = shapely.intersection(line, shapely.buffer(jet.leaning(slope), _NEAR_MM)).length
                if along_mm > 0 and along_mm >= _SHARE * (line.length - root.rest_mm):
                    near.append(k)
            if not near:
                text = (
                    f"{contour.id}: no pass that leans by {slope.lean_deg:g} degrees is along it {slope.root_mm:g} mm"
                )
                found.append(((contour.id,), f"{text} below the top face"))
                continue
            if len(near) > 1:
                lines = " and ".join(str(jets[k].burn.line) for k in near)
                found.append(((contour.id,), f"{contour.id}: the same slope is cut more than once, in lines {lines}"))
            taken[contour.id] += [] if near[0] in taken[contour.id] else [near[0]]
    return taken


def _unsteady(
    jets: dict[int, Jet], shares: Mapping[int, tuple[float, float]], changes: Collection[int], profile: Technique
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Burns whose torch changes its lean, turns too far, or waits or moves otherwise than it should.

    It `changes` its lean where single edges have bevels.
    """
    machine, most = profile.machine, profile.cuts.bevel.most_turn
    waits_s = machine.pierce_time_s if pierce_dwell_of(profile) == "program" else 0.0
    for k, jet in jets.items():
        burn = jet.burn
        where = f"line {burn.line}"
        if not jet.steady and k not in changes:
            yield (), f"{where}: the torch changes its lean while it burns"
        turned = max(abs(turn) for _, turn in burn.axes)
        if turned > most + ANGLE_DEG:
            yield (), f"{where}: the head turns to {turned:g} degrees, cuts.bevel.most_turn is {most:g}"
        said = set[float]()
        for lean_deg, other in _paces(burn):
            feed = machine.cut_feed_mm_s * math.cos(math.radians(lean_deg))
            low, high = (feed * share for share in shares.get(k, (1.0, 1.0)))
            if not low * (1 - 1e-3) - 1e-2 <= other <= high * (1 + 1e-3) + 1e-2 and other not in said:
                said.add(other)
                yield (), f"{where}: it cuts at {other * 60:.0f} mm/min, at its lean that should be {high * 60:.0f}"
        if abs(burn.pierce_s - waits_s) > _WAIT_S:
            yield (), f"{where}: the torch stands for {burn.pierce_s:g} s before it moves, expected {waits_s:g} s"


def _paces(burn: Burn) -> list[tuple[float, float]]:
    """The greatest lean and the speed of each line and arc of a burn, each pair once."""
    rows = burn.path.vertices[:, :2].tolist()
    moves = [k for k in range(len(rows) - 1) if math.dist(rows[k], rows[k + 1]) > 1e-9]
    leans = [max(abs(burn.axes[k][0]), abs(burn.axes[k + 1][0])) for k in moves]
    return sorted({(round(lean, 6), feed) for lean, feed in zip(leans, burn.step_feeds_mm_s, strict=False)})


def _upright_of(
    bevelled: Sequence[Contour], program: NcProgram, profile: Technique
) -> tuple[dict[str, int], dict[str, shapely.Geometry]]:
    """The upright burn along each contour that has a square face, and its way."""
    kerf_mm, found, lines = profile.material.kerf_mm, dict[str, int](), dict[str, shapely.Geometry]()
    plain = [k for k, burn in enumerate(program.burns) if not burn.tilted and burn.tool == 0 and burn.path.segments]
    paths = lines_of([program.burns[k].path for k in plain], 0.005)
    for contour in bevelled:
        if not all(slopes_of(bevel, profile.material.thickness_mm)[1] for bevel in {*contour.bevel_of_edge}):
            continue
        ring = root_ring(contour, Slope(0.0, 0.0), profile)
        for k, line in zip(plain, paths, strict=True):
            if ring is None or not shapely.dwithin(shapely.box(*ring.bounds), line, 1.0):
                continue
            if shapely.intersection(ring, shapely.buffer(line, tolerance_mm(kerf_mm))).length >= _SHARE * ring.length:
                found[contour.id], lines[contour.id] = k, line
                break
    return found, lines


def _loose(
    nest: Nest,
    program: NcProgram,
    bevelled: Sequence[Contour],
    passes: dict[str, list[int]],
    upright: dict[str, int],
    profile: Technique,
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Several passes: they follow each other, and what the first of them sets loose lies still by its weight."""
    material, least_kg = profile.material, profile.cuts.bevel.lies_still
    for contour in bevelled:
        of = [*passes[contour.id], *([upright[contour.id]] if contour.id in upright else [])]
        if len(of) < 2:
            continue
        if max(of) - min(of) != len(of) - 1:
            yield (contour.id,), f"{contour.id}: other cuts come between the passes of its bevel"
        if contour.edge_bevels:
            last = [slopes_of(bevel, material.thickness_mm) for bevel in contour.bevel_of_edge]
            if [k for k in sorted(of) if _goes_round(program.burns[k], nest, contour, profile)] != [max(of)]:
                yield (contour.id,), f"{contour.id}: an edge is cut on after the round that sets the part loose"
            if any(len(slopes) + square < 2 for slopes, square in last):
                continue  # the round that comes last cuts the other edges
        part = next(p for p in nest.parts if p.id == contour.part)
        mass_kg = part.polygon.area * material.thickness_mm * profile.plant.plate.density_kg_m3 * _KG
        if least_kg is None or mass_kg < least_kg - 1e-6:
            says = "nobody says when a part does" if least_kg is None else f"from {least_kg:g} kg on parts do"
            yield (
                (contour.id,),
                f"{contour.id}: its passes after the first cut in loose metal, and {part.id} of {mass_kg:.3g} kg does "
                f"not lie still: {says} (cuts.bevel.lies_still)",
            )


def _goes_round(burn: Burn, nest: Nest, contour: Contour, profile: Technique) -> bool:
    """Whether a burn alone cuts a contour loose: at the top face it closes round what is inside of it."""
    inside = contour.polygon
    if contour.kind == "outer":
        part = next(p for p in nest.parts if p.id == contour.part)
        section = section_of(part, 0.0, profile.material.thickness_mm)
        inside = max(shapely.get_parts(section), key=shapely.area)  # slopes may leave lines and specks beside it
    middle = shapely.get_point(shapely.maximum_inscribed_circle(inside), 0)
    (line,) = lines_of([burn.path], 0.005)
    burnt = shapely.buffer(line, profile.material.kerf_mm / 2)
    return not shapely.intersects(burnt, middle) and shapely.covers(shapely.Polygon(burnt.exterior), middle)


def _depths(bevelled: Sequence[Contour], thickness_mm: float) -> list[float]:
    count = _STEPS * max(1, math.ceil(thickness_mm / 20))
    bevels = {bevel for c in bevelled for bevel in c.bevel_of_edge}
    roots = {slope.root_mm for bevel in bevels for slope in slopes_of(bevel, thickness_mm)[0]}
    return sorted({*np.linspace(0.0, thickness_mm, count).round(6).tolist(), *roots})


def _metal(
    nest: Nest,
    bevelled: Sequence[Contour],
    jets: dict[int, Jet],
    passes: dict[str, list[int]],
    upright: dict[str, shapely.Geometry],
    profile: Technique,
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Parts that are burnt, burns off the sheet, and faces that are not cut: each once, at the first depth found."""
    thickness_mm, kerf_mm = profile.material.thickness_mm, profile.material.kerf_mm
    allowed = tolerance_mm(kerf_mm)
    sheet = shapely.buffer(shapely.make_valid(nest.sheet.polygon), allowed)
    shapely.prepare(sheet)
    tree = shapely.STRtree([part.outer.polygon for part in nest.parts])
    said: set[tuple[str, int | str]] = set()
    for depth_mm in _depths(bevelled, thickness_mm):
        sections: dict[int, shapely.Geometry] = {}
        burnt = {k: jet.burnt(depth_mm) for k, jet in jets.items()}
        at = f"{depth_mm:.3g} mm below the top face"
        for k, area in burnt.items():
            where = f"line {jets[k].burn.line}"
            if ("sheet", k) not in said and not shapely.covers(sheet, area):
                said.add(("sheet", k))
                yield (), f"{where}: it burns beyond the sheet, {at}"
            for number in tree.query(area).tolist():
                part = nest.parts[number]
                if number not in sections:
                    sections[number] = shapely.buffer(section_of(part, depth_mm, thickness_mm), -allowed)
                if (part.id, k) not in said and shapely.intersects(sections[number], area):
                    said.add((part.id, k))
                    x, y = shapely.get_coordinates(
                        shapely.point_on_surface(shapely.intersection(sections[number], area))
                    )[0]
                    yield (), f"{where}: it burns into {part.id} {at}, at ({x:.1f}, {y:.1f})"
        for contour in bevelled:
            of = [burnt[k] for k in passes[contour.id]]
            if contour.id in upright:
                of.append(shapely.buffer(upright[contour.id], kerf_mm / 2))
            if not of or ("face", contour.id) in said:
                continue
            half_mm = max([jets[k].half_mm for k in passes[contour.id]] or [0.0])
            if (place := _left(contour, depth_mm, thickness_mm, shapely.union_all(of), half_mm, allowed)) is not None:
                said.add(("face", contour.id))
                x, y = place
                text = f"{contour.id}: its face is not cut {at}, at ({x:.1f}, {y:.1f})"
                yield (contour.id,), text


def _left(
    contour: Contour, depth_mm: float, thickness_mm: float, burnt: shapely.Geometry, half_mm: float, allowed: float
) -> Point | None:
    """A place of the face at a depth that no burn comes near, but for what a round jet leaves of inner corners.

    Where two edges bend into the part the jet turns about one place of the root, from which the face is no further than
    it lies behind the contour, and half the jet.
    """
    if contour.edge_bevels:
        for side in sides_of(contour):
            rest_mm = (6 if min(side.turns_rad) < -1.7 else 3) * half_mm
            points = shapely.points(side.face(cut_away_mm(side.bevel, depth_mm, thickness_mm), rest_mm))
            if (far := ~shapely.dwithin(burnt, points, allowed)).any():
                return _at(points[far][0])
        return None
    away_mm = cut_away_mm(contour.bevel, depth_mm, thickness_mm)
    inside = face_area(contour, away_mm, sharp=False)
    ring = shapely.segmentize(shapely.boundary(inside), _SAMPLE_MM)
    points = shapely.points(shapely.get_coordinates(ring))
    far = ~shapely.dwithin(burnt, points, allowed)
    if not far.any():
        return None
    drawn = shapely.make_valid(contour.polygon)
    waste = shapely.difference(shapely.buffer(drawn, 9 * half_mm), drawn) if contour.kind == "outer" else drawn
    middles = shapely.buffer(waste, -half_mm, quad_segs=32)  # where the middle of the jet may be at the root
    far &= shapely.dwithin(middles, points, half_mm + away_mm + allowed / 2)
    if not far.any():
        return None
    return _at(points[far][0])


def _at(point: shapely.Point) -> Point:
    x, y = shapely.get_coordinates(point)[0].tolist()
    return float(x), float(y)


def _meeting(
    program: NcProgram,
    jets: dict[int, Jet],
    passes: dict[str, list[int]],
    bevelled: Sequence[Contour],
    upright: dict[str, int],
    profile: Technique,
) -> Iterator[tuple[tuple[str, ...], str]]:
    """Loops and leads of tilted burns that meet another cut: there the jet would find no metal, or leave it early."""
    thickness_mm, kerf_mm = profile.material.thickness_mm, profile.material.kerf_mm
    contours = {c.id: c for c in bevelled}
    aside: dict[int, shapely.Geometry] = {}
    whole: dict[int, shapely.Geometry] = {}
    own: dict[int, set[int]] = {}
    depths = _depths(bevelled, thickness_mm)
    for name, of in passes.items():
        mine = {*of, *([upright[name]] if name in upright else [])}
        roots = list(roots_of(contours[name], profile))
        for k in of:
            own[k] = mine
            off = list(_off(jets[k], contours[name], roots, profile))
            areas = [jets[k].burnt(z, some) for z in depths for some in off]
            aside[k] = shapely.union_all(areas) if areas else shapely.Point()
            whole[k] = shapely.union_all([jets[k].burnt(z) for z in depths])
    lines = lines_of([b.path for b in program.burns if b.path.segments], 0.005)
    drawn = dict(zip([k for k, b in enumerate(program.burns) if b.path.segments], lines, strict=True))
    for k, area in aside.items():
        for other, line in drawn.items():
            if other in own.get(k, {k}) or other == k or program.burns[other].tool != 0:
                continue
            burnt = whole.get(other)
            if burnt is None:
                burnt = shapely.buffer(line, kerf_mm / 2)
            if shapely.intersects(area, burnt):
                one, two = program.burns[k].line, program.burns[other].line
                yield (), f"line {one}: a loop or a lead of a tilted burn meets what is cut from line {two} on"


def _on(jet: Jet, contour: Contour, roots: Sequence[Root], profile: Technique) -> NDArray[np.bool_]:
    """Which points of a burn run along its contour: at the root of a slope, or upright beside it."""
    on = np.zeros(len(jet.at), np.bool_)
    for root in roots:
        if root.line is None:
            continue
        leaning = np.sign(jet.leans_deg) == np.sign(root.slope.lean_deg)
        steady = np.abs(jet.leans_deg - root.slope.lean_deg) <= ANGLE_DEG
        near_mm = np.where(steady, _NEAR_MM, 1.0)  # on its way to another lean its cut is narrower
        points = shapely.points(jet.at + root.slope.root_mm * jet.aside)
        on |= leaning & (shapely.distance(root.line, points) <= near_mm)
    if contour.edge_bevels and (ring := root_ring(contour, Slope(0.0, 0.0), profile)) is not None:
        on |= (np.abs(jet.leans_deg) <= ANGLE_DEG) & (shapely.distance(ring, shapely.points(jet.at)) <= _NEAR_MM)
    return on


def _off(jet: Jet, contour: Contour, roots: Sequence[Root], profile: Technique) -> Iterator[slice]:
    """The stretches of a burn that do not run along its contour: leads and loops."""
    near = _on(jet, contour, roots, profile)
    k = 0
    while k < len(near):
        if near[k]:
            k += 1
            continue
        end = k
        while end < len(near) and not near[end]:
            end += 1
        yield slice(max(k - 1, 0), min(end + 1, len(near)))
        k = end


def _made_upright(jet: Jet, contour: Contour, profile: Technique) -> Burn:
    """The burn as an upright one at its root, without its loops: they are judged above."""
    roots = list(roots_of(contour, profile))
    square = slopes_of(contour.bevel, profile.material.thickness_mm)[1]
    slope = Slope(0.0, 0.0) if contour.edge_bevels or (square and not jet.burn.tilted) else roots[-1].slope
    ring = root_ring(contour, slope, profile)
    assert ring is not None
    points = jet.at + slope.root_mm * jet.aside
    if not jet.burn.tilted:  # the upright torch of a block: its plain cut would be as wide as that of the last slope
        turn, wider_mm = np.radians(jet.turns_deg), half_width_mm(slope.lean_deg, profile) - half_width_mm(0, profile)
        points = jet.at + wider_mm * np.column_stack([np.cos(turn), np.sin(turn)])
        near = shapely.distance(ring, shapely.points(points)) <= _NEAR_MM
    else:
        near = _on(jet, contour, roots if contour.edge_bevels else roots[-1:], profile)
    on = np.flatnonzero(near)
    if contour.edge_bevels:  # beside its edges, as an upright torch would be
        points = _at_roots(jet, roots)
        at_mm = shapely.line_locate_point(ring, shapely.points(points[on]))
        points[on] = shapely.get_coordinates(shapely.line_interpolate_point(ring, at_mm))
    rows: list[tuple[float, float]] = [(float(x), float(y)) for x, y in points[: on[0]]]
    for a, b in zip(on, [*on[1:], None], strict=True):
        rows.append((float(points[a, 0]), float(points[a, 1])))
        if b is not None and (b > a + 1 or (contour.edge_bevels and math.dist(points[a], points[b]) > 1e-6)):
            rows += _short_way(ring, points[a], points[b])
    rows += [(float(x), float(y)) for x, y in points[on[-1] + 1 :]]
    kept = [rows[0], *(q for p, q in pairwise(rows) if math.dist(p, q) > 1e-7)]
    path = Curve.of(kept, closed=False)
    lean_deg, feed = max(_paces(jet.burn), key=lambda pace: pace[1])
    feed /= math.cos(math.radians(lean_deg))
    return replace(jet.burn, path=path, axes=(), torches=(), torch=1, step_feeds_mm_s=(feed,) * len(path.segments))


def _at_roots(jet: Jet, roots: Sequence[Root]) -> Floats:
    """The points of a burn at the root of that slope, leaning its way, that is nearest to each."""
    found, least = jet.at.copy(), np.full(len(jet.at), np.inf)
    for root in roots:
        points = jet.at + root.slope.root_mm * jet.aside
        away = shapely.distance(root.line, shapely.points(points))
        new = (np.sign(jet.leans_deg) == np.sign(root.slope.lean_deg)) & (away < least)
        found[new], least[new] = points[new], away[new]
    return found


def _short_way(ring: shapely.LinearRing, begin: Floats, end: Floats) -> list[tuple[float, float]]:
    """The points of a ring between two places on it, the shorter way."""
    line = shapely.LineString(ring.coords)
    low, high = (float(line.project(shapely.Point(at))) for at in (begin, end))
    turned = low > high
    low, high = min(low, high), max(low, high)
    if high - low <= line.length / 2:
        points = list(ops.substring(line, low, high).coords)
    else:
        points = [*ops.substring(line, high, line.length).coords, *ops.substring(line, 0.0, low).coords]
        turned = not turned
    return [(float(x), float(y)) for x, y in (points[::-1] if turned else points)[1:-1]]
