"""Bridges: strips of metal that join parts, so that outlines and strip become one part."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.measures import Circle, Line, crossings
from kerfwise.encoder.geometry.segment import Point, Segment
from kerfwise.encoder.geometry.tolerances import TOUCH_MM

from .contour_checks import thick
from .errors import InputError
from .nest import Bridge, Contour, Nest, Note, Part, Sheet


@dataclass(eq=False, slots=True)
class _Joined:
    """Some parts and the strips between them: ids in the order of the file, outline and pockets."""

    ids: list[str]
    outline: Curve
    pockets: list[Curve]


def with_bridges(nest: Nest) -> Nest:
    """The nest with the parts that its bridges join as one part each; the nest itself where it has none.

    Parts A and B become part `A+B` with the contour `A+B.outer`, in the place of the first of them; holes, marks and
    tabs keep names and places. Waste that two bridges enclose is a hole, `A+B.hole1`. The parts as they were drawn are
    kept as `apart`. Raises InputError for the first bridge that cannot be made, with its line.

    Examples
    --------
    >>> from kerfwise.rules.case import nest, part, rect
    >>> plate = nest(100, 50, part("A", rect(5, 5, 30, 20)), part("B", rect(45, 5, 30, 20)))
    >>> made = with_bridges(replace(plate, bridges=(Bridge(("A", "B"), (35, 15), (45, 15), 4.0, 1),)))
    >>> [c.id for c in made.contours], made.contour("A+B.outer").polygon.area
    (['A+B.outer'], 1240.0)
    """
    if not nest.bridges:
        return nest
    built: list[Bridge] = []
    parts = {p.id: p for p in nest.parts}
    place = {p.id: k for k, p in enumerate(nest.parts)}
    groups = {p.id: _Joined([p.id], p.outer.curve.towards("ccw"), []) for p in nest.parts}
    for drawn in nest.bridges:
        bridge = bridge_problem(drawn, parts, built, nest.sheet)
        one, other = (groups[name] for name in bridge.parts)
        before = shapely.union_all([one.outline.polygon(), other.outline.polygon(), bridge.strip])
        pockets: list[Curve] = []
        if one is other:
            one.outline, *pockets = ring_and_pocket(bridge, one.outline)
        else:
            one.outline = join_rings(bridge, one.outline, other.outline)
            one.ids = sorted((*one.ids, *other.ids), key=place.__getitem__)
            one.pockets += other.pockets
            groups |= dict.fromkeys(one.ids, one)
        _expect_union(bridge, one.outline, pockets, before)
        one.pockets += pockets
        built.append(bridge)
    whole = _in_place(nest.parts, groups)
    renamed = {f"{p.id}.outer": f"{_id(groups[p.id])}.outer" for p in nest.parts}
    return replace(
        nest,
        parts=whole,
        bridges=tuple(built),
        apart=nest.parts,
        notes=(*(_renamed(note, renamed) for note in nest.notes), *_differ(whole, groups, parts)),
    )


def _expect_union(bridge: Bridge, outline: Curve, pockets: Sequence[Curve], geometry: shapely.Geometry) -> None:
    """The outline is what the areas together are; any other is not to be cut."""
    own = shapely.Polygon(outline.flatten(), [pocket.flatten() for pocket in pockets])
    if not own.is_valid or thick(shapely.symmetric_difference(own, geometry)):
        raise bridge.refused("does not join the two outlines to one that can be cut: draw it elsewhere")


def _in_place(parts: Sequence[Part], groups: dict[str, _Joined]) -> tuple[Part, ...]:
    """Each group as a part, where its first part is."""
    of, taken = {p.id: p for p in parts}, {p.id for p in parts}
    whole = []
    for part in parts:
        group = groups[part.id]
        if len(group.ids) == 1:
            whole.append(part)
        elif group.ids[0] == part.id:
            if (name := _id(group)) in taken:
                raise InputError(f"bridges join parts to one called '{name}', and the nest has a part of that name")
            whole.append(_part(name, [of[one] for one in group.ids], group))
    return tuple(whole)


def _id(group: _Joined) -> str:
    return "+".join(group.ids)


def _part(name: str, drawn: Sequence[Part], group: _Joined) -> Part:
    def own(contours: Iterable[Contour]) -> tuple[Contour, ...]:
        return tuple(replace(contour, part=name) for contour in contours)

    pockets = [Contour(f"{name}.hole{k}", name, "hole", curve) for k, curve in enumerate(group.pockets, 1)]
    attributes: dict[str, object] = {}
    for part in drawn:
        attributes = part.attributes | attributes
    return Part(
        name,
        Contour(f"{name}.outer", name, "outer", group.outline, source=drawn[0].outer.source),
        (*own(hole for part in drawn for hole in part.holes), *pockets),
        own(mark for part in drawn for mark in part.marks),
        attributes,
        tabs=tuple(tab for part in drawn for tab in part.tabs),
    )


def _renamed(note: Note, names: dict[str, str]) -> Note:
    return replace(note, contours=tuple(names.get(one, one) for one in note.contours))


def _differ(whole: Sequence[Part], groups: dict[str, _Joined], parts: dict[str, Part]) -> list[Note]:
    """A word on each attribute that parts of one group say differently; the first in the file counts."""
    notes = []
    for part in whole:
        ids = () if part.id in parts else next(group.ids for group in groups.values() if _id(group) == part.id)
        for name in ids:
            for key, value in parts[name].attributes.items():
                if value != part.attributes[key]:
                    text = f"part {name}, which bridges join to {part.id}, has another '{key}' than a part before it"
                    notes.append(Note("warning", f"{text}: that of the earlier one counts"))
    return notes


# Whether a bridge can be made where it is drawn.

ALONG_MM = 1.0
"""A side of a strip that runs so far along an outline meets it nowhere in particular."""


def bridge_problem(bridge: Bridge, parts: Mapping[str, Part], earlier: Sequence[Bridge], sheet: Sheet) -> Bridge:
    """The bridge, its start in the first of its parts.

    `bridge`: one whose parts are among these. `parts`: parts that are sound, by id, as they are drawn. `earlier`: the
    bridges before it. `sheet`: a sheet that is sound. Raises InputError with the line, if it does not reach both parts,
    or meets anything else; and for what else it cannot be.
    """
    for name in bridge.parts:
        if name not in parts:
            near = difflib.get_close_matches(name, parts, n=1)
            meant = f": is '{near[0]}' meant?" if near else ""
            raise bridge.refused(f"names a part '{name}' that is not there{meant}")
    if bridge.parts[0] == bridge.parts[1]:
        raise bridge.refused("joins a part with itself: it joins two parts that lie side by side")
    if bridge.length_mm <= TOUCH_MM or bridge.width_mm <= TOUCH_MM:
        raise bridge.refused(f"has no length or no width: both are more than {TOUCH_MM:g} mm")
    one, other = (parts[name] for name in bridge.parts)
    _expect_beside(bridge, one, other)
    if not _in(one, bridge.start) and _in(other, bridge.start) and _in(one, bridge.end):
        bridge = replace(bridge, start=bridge.end, end=bridge.start)
    for part, at, corners in zip((one, other), (bridge.start, bridge.end), ends_of(bridge), strict=True):
        _expect_reaches(bridge, part, at, corners)
        _expect_across(bridge, part)
    _expect_clear(bridge, (one, other), parts.values(), earlier, sheet)
    return bridge


def expect_wider(nest: Nest, kerf_mm: float) -> None:
    """Refuse a bridge that is narrower than the kerf: with a kerf on both sides the heat takes it.

    Raises InputError with its line.
    """
    for bridge in nest.bridges:
        if bridge.width_mm < kerf_mm:
            raise bridge.refused(f"is {bridge.width_mm:g} mm wide, less than the kerf of {kerf_mm:g} mm: make it wider")


def _expect_beside(bridge: Bridge, one: Part, other: Part) -> None:
    for host, guest in ((one, other), (other, one)):
        if shapely.contains(host.outer.polygon, guest.outer.polygon):
            text = f"joins parts of which {guest.id} lies in a hole of {host.id}"
            raise bridge.refused(f"{text}: a bridge joins parts that lie side by side")


def _in(part: Part, at: Point) -> bool:
    return bool(shapely.distance(part.outer.polygon, shapely.Point(at)) <= TOUCH_MM)


def _expect_reaches(bridge: Bridge, part: Part, at: Point, corners: Sequence[Point]) -> None:
    if not _in(part, at):
        off_mm = shapely.distance(part.outer.polygon, shapely.Point(at))
        text = f"does not reach part {part.id}: its end at ({at[0]:z.3f}, {at[1]:z.3f}) is {off_mm:.3f} mm from it"
        raise bridge.refused(f"{text}; let it end in the part or on its edge")
    for x, y in corners:
        if not _in(part, (x, y)):
            off_mm = shapely.distance(part.outer.polygon, shapely.Point(x, y))
            text = f"is wider than part {part.id} where it ends: its corner at ({x:z.3f}, {y:z.3f}) is {off_mm:.3f} mm"
            raise bridge.refused(f"{text} outside; make it narrower, or let it end further in the part")


def _expect_across(bridge: Bridge, part: Part) -> None:
    edge = shapely.buffer(part.outer.line, TOUCH_MM, quad_segs=2)
    for left in (False, True):
        beside = shapely.intersection(shapely.LineString(bridge.side(left, ALONG_MM)), edge)
        if any(piece.length > ALONG_MM for piece in shapely.get_parts(beside)):
            raise bridge.refused(f"runs along an edge of part {part.id} {_on(beside)}: make it narrower, or move it")


def _expect_clear(
    bridge: Bridge, own: Sequence[Part], parts: Iterable[Part], earlier: Sequence[Bridge], sheet: Sheet
) -> None:
    strip = bridge.strip
    for part in own:
        for hole in part.holes:
            if shapely.distance(strip, hole.polygon) <= TOUCH_MM:
                raise bridge.refused(
                    f"meets {hole.id} {_on(shapely.intersection(strip, hole.polygon), strip)}: move it"
                )
    for part in parts:
        if part not in own and shapely.distance(strip, part.polygon) <= TOUCH_MM:
            text = f"meets a third part, {part.id}, {_on(shapely.intersection(strip, part.polygon), strip)}"
            raise bridge.refused(f"{text}: lead it past, or join the parts one by one")
    for before in earlier:
        if shapely.distance(strip, before.strip) <= TOUCH_MM:
            raise bridge.refused(f"meets {before.name}: keep them apart")
    if not shapely.covers(shapely.buffer(sheet.polygon, TOUCH_MM, quad_segs=2), strip):
        raise bridge.refused(f"runs off the sheet {_on(shapely.difference(strip, sheet.polygon))}")


def _on(shape: shapely.Geometry, instead: shapely.Geometry | None = None) -> str:
    """A place on a shape, for messages; on another one where it is empty."""
    at = shapely.point_on_surface(shape if not shape.is_empty or instead is None else instead)
    return f"at ({at.x:z.1f}, {at.y:z.1f})"


# Two rings and the sides of a strip become one ring, or a ring and a pocket: lines stay lines, arcs stay arcs.

BEYOND_MM = 2 * TOUCH_MM
"""A strip that ends on an edge goes on by so much, so that its sides meet the edge."""
_SAME_MM = 1e-6

Met = tuple[float, float]
"""How far along a side, and how far along the ring, mm."""


def join_rings(bridge: Bridge, one: Curve, other: Curve) -> Curve:
    """The counter-clockwise outline of what two such outlines enclose, and the strip between them.

    Raises InputError if a side of the strip leaves the one, or enters the other, more or less than once.

    Examples
    --------
    >>> a, b = (Curve.of([(x, 0), (x + 10, 0), (x + 10, 10), (x, 10)]) for x in (0, 15))
    >>> join_rings(Bridge(("A", "B"), (10, 5), (15, 5), 4, 1), a, b).signed_area_mm2
    220.0
    """
    names = bridge.parts
    leaves = {left: _once(bridge, ring_crossings(bridge, one, left), names[0]) for left in (False, True)}
    enters = {left: _once(bridge, ring_crossings(bridge, other, left), names[1]) for left in (False, True)}
    for left in (False, True):
        _expect_a_gap(bridge, leaves[left], enters[left])
    first = _stretch(one, leaves[True][1], leaves[False][1])
    second = _stretch(other, enters[False][1], enters[True][1])
    return Curve.of([*first.vertices.tolist(), *second.vertices.tolist()])


def ring_and_pocket(bridge: Bridge, ring: Curve) -> tuple[Curve, Curve]:
    """The counter-clockwise outline, and the waste that it encloses then, of an outline with a strip across its waste.

    Raises InputError if a side of the strip meets the outline more or less often than twice.
    """
    found = {}
    for left in (False, True):
        sides = ring_crossings(bridge, ring, left)
        if len(sides) != 2:
            raise bridge.refused(_too_often(len(sides), " and ".join(bridge.parts)))
        _expect_a_gap(bridge, *sides)
        found[left] = sides
    (_, one_right), (_, other_right) = found[False]
    (_, one_left), (_, other_left) = found[True]
    loops = [_stretch(ring, one_left, other_left), _stretch(ring, other_right, one_right)]
    curves = sorted((Curve.of(loop.vertices.tolist()) for loop in loops), key=lambda c: c.signed_area_mm2)
    return curves[1], curves[0]


def ring_crossings(bridge: Bridge, ring: Curve, left: bool) -> list[Met]:
    """Where a side of a strip meets a ring, in the order along the side."""
    begin, end = bridge.side(left, BEYOND_MM)
    length_mm = math.dist(begin, end)
    along = ((end[0] - begin[0]) / length_mm, (end[1] - begin[1]) / length_mm)
    found: list[Met] = []
    for start_mm, segment in zip(ring.starts_mm.tolist(), ring.segments, strict=False):
        for x, y in crossings(Line(begin, along), _track(segment)):
            at_mm = (x - begin[0]) * along[0] + (y - begin[1]) * along[1]
            share, off_mm = segment.project((x, y))
            if off_mm <= _SAME_MM and -_SAME_MM <= at_mm <= length_mm + _SAME_MM:
                found.append((at_mm, (start_mm + share * segment.length_mm) % ring.length_mm))
    found.sort()
    return [one for k, one in enumerate(found) if k == 0 or one[0] - found[k - 1][0] > _SAME_MM]


def _track(segment: Segment) -> Line | Circle:
    if segment.is_arc:
        return Circle(segment.centre, segment.radius_mm, 1 if segment.bulge > 0 else -1)
    return Line(segment.start, segment.tangent_at(0.0))


def _once(bridge: Bridge, found: list[Met], part: str) -> Met:
    if len(found) != 1:
        raise bridge.refused(_too_often(len(found), part))
    return found[0]


def _too_often(times: int, part: str) -> str:
    if not times:
        return f"does not meet the outline of {part}: begin and end it in the parts, on both sides of the gap"
    return (
        f"crosses the outline of {part} more often than once on one side: it may be too wide there, or run through a "
        "notch; begin it nearer to the gap, or make it narrower"
    )


def _expect_a_gap(bridge: Bridge, leaves: Met, enters: Met) -> None:
    if enters[0] - leaves[0] <= TOUCH_MM:
        raise bridge.refused("crosses no gap: the parts touch there, or overlap")


def _stretch(ring: Curve, begin_mm: float, end_mm: float) -> Curve:
    """The stretch of a closed ring from one place to another, the way it runs."""
    return ring.between(begin_mm, (end_mm - begin_mm) % ring.length_mm)


def ends_of(bridge: Bridge) -> tuple[tuple[Point, Point], tuple[Point, Point]]:
    """The two corners at either end of a strip."""
    right, left = bridge.side(left=False), bridge.side(left=True)
    return (right[0], left[0]), (right[1], left[1])
