"""Whether tilted torches have room: what they burn at every depth, held against all parts, the sheet and other ways."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import shapely

from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut
from kerfwise.encoder.display import join_names
from kerfwise.encoder.errors import InputError
from kerfwise.encoder.nest import Contour, Nest, Part, cached_with_nest

from .bevel import BevelPass
from .cut_nest import BevelOptions, bevelled
from .round import SHARP_RAD, Loops, Round, pass_along, round_alone, run_along
from .tilted_path import Step, TiltedPath, within_turns

_RUNS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0)
"""How many times the least run loops are tried with."""
_SLACK_MM = 0.03
"""What chords, and mitres drawn in 0.01 mm, may make of a distance."""
MITRE = 20.0


def section(part: Part, depth_mm: float, thickness_mm: float) -> shapely.Geometry:
    """The metal of a part as drawn at a depth: outlines and holes, each with its bevel."""
    metal = _bevelled_area(part.outer, depth_mm, thickness_mm, outwards=False)
    holes = [_bevelled_area(hole, depth_mm, thickness_mm, outwards=True) for hole in part.holes]
    return shapely.difference(metal, shapely.union_all(holes)) if holes else metal


def _bevelled_area(contour: Contour, depth_mm: float, thickness_mm: float, outwards: bool) -> shapely.Geometry:
    area = shapely.make_valid(contour.polygon)
    if contour.edge_bevels:
        taken = list(_strips(contour, depth_mm, thickness_mm))
        return shapely.union_all([area, *taken]) if outwards else shapely.difference(area, shapely.union_all(taken))
    if contour.bevel is None or not (by_mm := contour.bevel.inset_mm(depth_mm, thickness_mm)):
        return area
    return shapely.buffer(area, by_mm if outwards else -by_mm, join_style="mitre", mitre_limit=MITRE)


def _strips(contour: Contour, depth_mm: float, thickness_mm: float) -> Iterator[shapely.Geometry]:
    """What the bevels of single edges take off the part at a depth, each as far as its edge goes.

    Past a corner that sticks out the slope goes on, as far as the part does.
    """
    segments, each = contour.curve.segments, contour.bevel_of_edge
    side = 1.0 if contour.curve.is_ccw == (contour.kind == "outer") else -1.0  # the part is on the left
    for k, (segment, bevel) in enumerate(zip(segments, each, strict=True)):
        by_mm = 0.0 if bevel is None else bevel.inset_mm(depth_mm, thickness_mm)
        if by_mm <= 0:
            continue
        points = list(segment.flatten(_SLACK_MM / 3).tolist())
        points = [segment.start, *map(tuple, points)]
        share = [0.0, *(segment.project(at)[0] for at in points[1:])]
        normals = [(-side * y, side * x) for x, y in map(segment.tangent_at, share)]
        inner = [(x + by_mm * nx, y + by_mm * ny) for (x, y), (nx, ny) in zip(points, normals, strict=True)]
        yield shapely.make_valid(shapely.Polygon([*points, *inner[::-1]]))
        for other, end, towards in ((segments[k - 1], 0, -1.0), (segments[(k + 1) % len(segments)], -1, 1.0)):
            pair = (other, segment) if end == 0 else (segment, other)
            (ax, ay), (bx, by) = pair[0].tangent_at(1.0), pair[1].tangent_at(0.0)
            turn = side * math.atan2(ax * by - ay * bx, ax * bx + ay * by)
            if turn >= SHARP_RAD:
                x, y = segment.tangent_at(share[end])
                far = towards * by_mm / math.tan(max(turn, SHARP_RAD)) if turn < math.pi / 2 else 0.0
                corner = [points[end], inner[end]]
                yield shapely.Polygon([*corner, *((px + far * x, py + far * y) for px, py in corner[::-1])])


@dataclass(frozen=True, eq=False, slots=True)
class Bevelling:
    """How the contours of a nest with bevels are cut: which corners by loops, the same every way round.

    `loops` are by contour id, those of each pass; `taken` is what loops burn at any depth, by contour id.
    """

    options: BevelOptions
    loops: dict[str, tuple[Loops, ...]] = field(default_factory=dict)
    taken: dict[str, shapely.Geometry] = field(default_factory=dict)

    def passes_of(self, drawn: Contour, cut: Cut) -> tuple[TiltedPath, ...]:
        """The passes of a cut of a contour with a bevel, which is as drawn.

        Raises InputError if the torch cannot go so, with why.
        """
        return tilted_paths(drawn, cut, self.loops[drawn.id], self.options)

    def reasons(self, nest: Nest) -> dict[str, str]:
        """For every contour with a bevel its passes and what becomes of sharp corners, in a sentence."""
        found = {}
        for drawn in bevelled(nest):
            rounds = self.options.rounds(drawn, ccw=True)
            tilts = [max((one.tilt_deg for one in (r.lean, *r.leans)), key=abs) for r in rounds]
            if self.options.block is not None:
                tilts = [one.tilt_deg for one in self.options.leans(drawn)]
            count, loops = len(tilts), sum(map(len, self.loops[drawn.id]))
            passes = "in one pass" if count == 1 else f"in {count} passes, one after the other,"
            if self.options.block is not None:
                passes = f"by {'one torch' if count == 1 else f'{count} torches'} of the block together,"
            angles = ", ".join(f"{tilt:g} degrees" if tilt else "upright" for tilt in tilts)
            sharp = sum(len(list(r.sharp_corners())) for r in rounds if r.tilted)
            corners = f"; loops at {loops} of {sharp} sharp corners" if sharp else ""
            found[drawn.id] = f"bevel {_named(drawn)}: cut {passes} at {angles}{corners}"
        return found


def _named(drawn: Contour) -> str:
    """What bevels a contour has: of all of it, or each with how many edges have it."""
    if drawn.bevel is not None:
        return str(drawn.bevel)
    counts = Counter(str(one) for one in drawn.bevel_of_edge if one is not None)
    of = len(drawn.bevel_of_edge)
    return " and ".join(f"{name} on {count} of {of} edges" for name, count in counts.items())


def tilted_paths(drawn: Contour, cut: Cut, loops: Sequence[Loops], options: BevelOptions) -> tuple[TiltedPath, ...]:
    """The passes of a contour with a bevel, in order, those of the same cut.

    Raises InputError if the torch cannot go so, with why.
    """
    main_mm, rounds = options.main_half_mm(drawn), options.rounds(drawn, cut.direction == "ccw")
    try:
        paths = [
            run_along(of, options.run_mm) if of.run else pass_along(of, cut, main_mm)
            for of in (replace(r, loops=found) for r, found in zip(rounds, loops, strict=True))
        ]
    except ValueError as error:
        raise InputError(f"{drawn.id}: {error}") from None
    turned = within_turns(paths, options.most_turn_deg)
    if turned is None:
        raise InputError(
            f"{drawn.id}: the head would turn more than cuts.bevel.most_turn, {options.most_turn_deg:g} degrees"
        )
    ways = tuple(replace(path, thickness_mm=options.thickness_mm) for path in turned)
    return ways if options.block is None else options.block.torches(ways[0], options.leans(drawn), rounds[0].lean)


class _Metal:
    """Parts at every depth, and what is near a line there."""

    def __init__(self, nest: Nest, options: BevelOptions) -> None:
        self.nest, self.options = nest.drawn or nest, options
        self.sheet = shapely.make_valid(nest.sheet.polygon)
        self.parts = {part.id: part for part in self.nest.parts}
        areas = [shapely.make_valid(part.polygon) for part in self.nest.parts]
        self.tree, self.names = shapely.STRtree(areas), [part.id for part in self.nest.parts]
        self.section = cache(self._section)

    def _section(self, part: str, depth_mm: float) -> shapely.Geometry:
        return shapely.buffer(section(self.parts[part], depth_mm, self.options.thickness_mm), -_SLACK_MM)

    def hit(self, path: TiltedPath, own: str, along: bool | None, apart_mm: float) -> str | None:
        """What a path burns that it may not, and where; None where it has room.

        Ways that do not cut the contour keep `apart_mm` from other parts, whose kerfs lie beside them.
        """
        for depth_mm in self.options.depths_mm():
            if (burnt := path.burnt(depth_mm, along)) is None:
                continue
            at = f"{depth_mm:g} mm below the top face"
            if not shapely.covers(self.sheet, shapely.buffer(burnt, -_SLACK_MM)):
                return f"the torch would burn beyond the sheet, {at}"
            near = {self.names[k] for k in self.tree.query(shapely.buffer(burnt, apart_mm))}
            for name in sorted(near | {own}):
                metal = self.section(name, depth_mm)
                reach = burnt if name == own or not apart_mm else shapely.buffer(burnt, apart_mm)
                if shapely.intersects(metal, reach):
                    what = f"come within {apart_mm:g} mm of" if name != own and apart_mm else "burn into"
                    return f"the torch would {what} {name}, {at}{_place(shapely.intersection(metal, reach))}"
        return None

    def no_room(self, path: TiltedPath, drawn: Contour, others: shapely.Geometry) -> str | None:
        """Why a path's loops and leads have no room, beside what `others` burn aside."""
        apart_mm = self.options.kerfs[0][1] + _SLACK_MM
        hit = self.hit(path, drawn.part, along=False, apart_mm=apart_mm)
        if hit is None and shapely.intersects(_swept(path, self.options), others):
            return "it would cross the loop of another contour"
        return hit


@cached_with_nest(most=2)
def _metal_of(nest: Nest, options: BevelOptions) -> _Metal:
    """The parts of a nest at every depth: what is found there once serves loops, passes and leads."""
    return _Metal(nest, options)


def _place(area: shapely.Geometry) -> str:
    x, y = (float(v) for v in shapely.get_coordinates(shapely.point_on_surface(area))[0])
    return f" at ({x:.1f}, {y:.1f})"


@cached_with_nest(most=2)
def plan_bevels(nest: Nest, options: BevelOptions) -> Bevelling:
    """Which corners of which contours are cut by loops, and that all passes have room on their way round.

    Raises InputError with a line for each contour that cannot be cut as it is drawn, and what to do.
    """
    metal, found, wrong = _metal_of(nest, options), Bevelling(options), list[str]()
    for drawn in bevelled(nest):
        found.taken[drawn.id] = shapely.GeometryCollection()
        try:
            found.loops[drawn.id] = tuple(_loops_and_room(drawn, metal, found))
        except (InputError, ValueError) as error:
            wrong.append(f"{drawn.id}, bevel {_named(drawn)}: {error}")
    if wrong:
        raise InputError(
            "a bevel cannot be cut as it is drawn" if len(wrong) == 1 else "bevels cannot be cut as they are drawn",
            file=nest.file or None,
            details=tuple(wrong),
        )
    return found


def _loops_and_room(drawn: Contour, metal: _Metal, found: Bevelling) -> Iterator[Loops]:
    """The loops of each pass."""
    options = metal.options
    part = metal.parts[drawn.part]
    for depth_mm in (0.0, options.thickness_mm):
        if shapely.is_empty(section(part, depth_mm, options.thickness_mm)):
            face = "top" if depth_mm == 0 else "bottom"
            raise InputError(
                f"nothing of {part.id} would be left at the {face} face; a smaller angle, or a land, would do"
            )
    _expect_walls(part, options)
    rounds = options.rounds(drawn, ccw=True)
    several = sum(not r.run for r in rounds)
    if {k for r in rounds for k in r.run} == {*range(len(drawn.bevel_of_edge))}:
        several = len(rounds)  # the last of them cuts loose what runs have cut out
    if options.block is not None:
        options.block.expect_fit(drawn)
        several = len(options.leans(drawn))  # those behind the first cut its last piece loose
    mass_kg, least_kg = options.mass_kg(part), options.lies_still_kg
    if several > 1 and (least_kg is None or mass_kg < least_kg):
        less = "and nobody says" if least_kg is None else f"less than {least_kg:g} kg, which is"
        raise InputError(
            f"the first of its {several} passes sets loose what the others cut: {part.id} weighs {mass_kg:.3g} kg, "
            f"{less} from which mass on a loose part lies still (cuts.bevel.lies_still); a bevel V has one pass"
        )
    others = shapely.union_all([area for name, area in found.taken.items() if name != drawn.id])
    for way in rounds:
        if not way.tilted:
            yield ()
            continue
        loops: list[tuple[tuple[float, float], float]] = []
        for corner in way.sharp_corners() if way.apart_mm or options.corner != "turn" else ():
            why = "no loop has room"
            for times in _RUNS:
                run_mm = way.apart_mm + times * options.run_mm
                try:
                    ways = _torches(round_alone(replace(way, loops=((corner, run_mm),), run=())), drawn, options)
                except ValueError as error:  # too short a run
                    why = str(error)
                    continue
                hit = next(filter(None, (metal.no_room(path, drawn, others) for path in ways)), None)
                if hit is None:
                    loops.append((corner, run_mm))
                    swept = [found.taken[drawn.id], *(_swept(path, options) for path in ways)]
                    found.taken[drawn.id] = shapely.union_all(swept)
                    break
                why = hit if times == _RUNS[0] else why
            else:
                x, y = corner
                if way.apart_mm:
                    raise InputError(f"no loop of the block has room at the corner ({x:.1f}, {y:.1f}): {why}")
                if options.corner == "loop":
                    raise InputError(
                        f"no loop has room at the corner ({x:.1f}, {y:.1f}): {why}; leave more web, shorten "
                        "cuts.bevel.run, or say cuts.bevel.corner: either"
                    )
        for path in _alone(replace(way, loops=tuple(loops)), drawn, options):
            hit = metal.hit(path, drawn.part, along=None if way.apart_mm else True, apart_mm=0.0)
            if hit is None and way.run:
                hit = metal.no_room(path, drawn, others)
                found.taken[drawn.id] = shapely.union(found.taken[drawn.id], _swept(path, options))
            if hit is not None:
                raise InputError(f"{hit}; leave more web, or change the bevel")
        yield tuple(loops)


def _torches(path: TiltedPath, drawn: Contour, options: BevelOptions) -> tuple[TiltedPath, ...]:
    """The path, or those of the torches of a block that goes along it."""
    if options.block is None:
        return (path,)
    return options.block.torches(path, options.leans(drawn), options.lean(BevelPass(0.0, 0.0)))


def _alone(way: Round, drawn: Contour, options: BevelOptions) -> Iterator[TiltedPath]:
    """The pass whatever the cut's leads are: of a run both ways along it, since it begins and ends otherwise."""
    if not way.run:
        yield from _torches(round_alone(way), drawn, options)
        return
    for ccw in (True, False):
        yield run_along(replace(way, ccw=ccw), options.run_mm)


def _expect_walls(part: Part, options: BevelOptions) -> None:
    """Refuse bevels that meet another contour of their part at a face, where no wall is left between them."""
    thickness_mm, kerf_mm = options.thickness_mm, options.kerfs[0][1]
    for face, depth_mm in (("top", 0.0), ("bottom", thickness_mm)):
        outline = _bevelled_area(part.outer, depth_mm, thickness_mm, outwards=False)
        areas = [(hole, _bevelled_area(hole, depth_mm, thickness_mm, outwards=True)) for hole in part.holes]
        for k, (hole, area) in enumerate(areas):
            near = [other for other, of in areas[:k] if shapely.dwithin(area, of, kerf_mm)]
            near += [] if shapely.contains(shapely.buffer(outline, -kerf_mm), area) else [part.outer]
            if near and any(one.bevelled for one in (hole, *near)):
                raise InputError(
                    f"at the {face} face it leaves less than a kerf of wall between {near[0].id} and {hole.id}"
                )


def _swept(path: TiltedPath, options: BevelOptions) -> shapely.Geometry:
    """What the loops of a path burn, at all depths together."""
    areas = [path.burnt(depth_mm, along=False) for depth_mm in options.depths_mm()]
    return shapely.union_all([area for area in areas if area is not None])


def kept_candidates(
    nest: Nest,
    candidates: Sequence[Candidate],
    bevelling: Bevelling,
    reach: tuple[float, float, float, float] | None = None,
) -> list[int]:
    """The numbers of the candidates that have room for tilted torches: their own, and the loops of others.

    Raises InputError for contours of which none is left, each with why.
    """
    options, metal = bevelling.options, _metal_of(nest, bevelling.options)
    drawn = {contour.id: contour for contour in bevelled(nest)}
    kerf_mm = options.kerfs[0][1]
    burnt = [area for area in bevelling.taken.values() if not area.is_empty]
    taken, names = shapely.STRtree(burnt), [name for name, area in bevelling.taken.items() if not area.is_empty]
    kept: list[int] = []
    whys: dict[int, list[str]] = defaultdict(list)
    for number, candidate in enumerate(candidates):
        contour = nest.contours[candidate.contour]
        why = _crossed(candidate, contour, taken, names, kerf_mm)
        if why is None and contour.id in drawn:
            why = _no_room(candidate, drawn[contour.id], bevelling, metal, reach)
        if why is None:
            kept.append(number)
        whys[candidate.contour].append(why or "")
    lost = sorted(k for k, found in whys.items() if all(found))
    if lost:
        details = tuple(f"{nest.contours[k].id}: {join_names(sorted(set(whys[k])), 2)}" for k in lost)
        raise InputError("beside bevels there is no room for a lead", file=nest.file or None, details=details)
    return kept


def _crossed(
    candidate: Candidate, contour: Contour, taken: shapely.STRtree, names: Sequence[str], kerf_mm: float
) -> str | None:
    """Whose loop the leads of a candidate would meet."""
    paths = [path.line() for path in (candidate.lead_in, candidate.lead_out) if path is not None and path.segments]
    for line in (*paths, shapely.Point(candidate.pierce)):
        for k in taken.query(line, predicate="dwithin", distance=kerf_mm):
            if names[k] != contour.id or line.geom_type == "Point":
                return f"a lead would meet a loop of {names[k]}"
    return None


def _no_room(
    candidate: Candidate,
    drawn: Contour,
    bevelling: Bevelling,
    metal: _Metal,
    reach: tuple[float, float, float, float] | None,
) -> str | None:
    """Why a contour with a bevel cannot be cut so."""
    if candidate.edge_start:
        return "a tilted torch is not brought in from the sheet's edge"
    try:
        paths = bevelling.passes_of(drawn, candidate.as_cut(drawn.id))
    except InputError as error:
        return error.message
    apart_mm = bevelling.options.kerfs[0][1] + _SLACK_MM
    rounds = bevelling.options.rounds(drawn, ccw=True) * (len(paths) if bevelling.options.block is not None else 1)
    for path, way in zip(paths, rounds, strict=True):
        if way.run:
            continue
        leads = replace(path, steps=tuple(_leads(path)))
        if leads.steps and path.tilt_deg and (hit := metal.hit(leads, drawn.part, along=False, apart_mm=apart_mm)):
            return hit
        if reach is not None and path.tilt_deg:
            x0, y0, x1, y1 = path.curve.line().bounds
            if x0 < reach[0] or y0 < reach[1] or x1 > reach[2] or y1 > reach[3]:
                return "the tilted torch would leave the machine's travel"
    return None


def _leads(path: TiltedPath) -> Iterator[Step]:
    """The steps of the leads: those before the contour, and behind it."""
    cuts = [k for k, step in enumerate(path.steps) if step.along]
    first, last = (cuts[0], cuts[-1]) if cuts else (len(path.steps), -1)
    return (step for k, step in enumerate(path.steps) if k < first or k > last)
