"""Whether a bridge can be made where it is drawn."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import shapely

from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest, Part, Sheet
from kerfwise.encoder.validate.tolerances import TOUCH_MM

from .bridge import Bridge
from .rings import ends_of

ALONG_MM = 1.0
"""A side of a strip that runs so far along an outline meets it nowhere in particular."""


def lawful(bridge: Bridge, parts: Mapping[str, Part], earlier: Sequence[Bridge], sheet: Sheet) -> Bridge:
    """The bridge, its start in the first of its parts.

    Parameters
    ----------
    bridge
        One whose parts are among these.
    parts
        Parts that are sound, by id, as they are drawn.
    earlier
        The bridges before it.
    sheet
        A sheet that is sound.

    Raises
    ------
    InputError
        With the line, if it does not reach both parts, or meets anything else; and for what else it cannot be.
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

    Raises
    ------
    InputError
        With its line.
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
