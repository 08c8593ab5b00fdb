"""The torch over the sheet and its loose pieces, and contours cut twice."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import shapely

from kerfwise.tests.metal.arcs import Point
from kerfwise.tests.metal.burns import Burn
from kerfwise.tests.metal.drawing import Drawing
from kerfwise.tests.metal.findings import Finding
from kerfwise.tests.metal.pieces import Pieces
from kerfwise.tests.metal.tolerances import CROSSED_MM, HELD_BY_MM2, NUMERIC_MM, OVERCUT_MM, RING_MM

_ROUND = 0.97
"""A contour is cut all round if so much of it is: the rest is for tabs."""


def off_sheet(burn: Burn, sheet: shapely.Polygon, edge_starts: bool) -> Iterator[Finding]:
    """Where the torch is lit off the sheet; a run-up from outside is lawful where edge starts are."""
    off = burn.line.difference(sheet)
    if burn.line.geom_type == "Point" and not off.is_empty:
        yield Finding("off-sheet", burn.cut, (burn.name,), burn.pierce, 0.0, "mm", "the torch is lit off the sheet")
        return
    runs = [run for run in shapely.get_parts(off) if not run.is_empty]
    if edge_starts:
        runs = [run for run in runs if run.distance(shapely.Point(burn.pierce)) > NUMERIC_MM]
    length = sum(run.length for run in runs)
    if length > CROSSED_MM:
        text = "the torch is lit off the sheet for"
        yield Finding("off-sheet", burn.cut, (burn.name,), _first(runs[0]), float(length), "mm", text)


def on_loose(burn: Burn, pieces: Pieces, drawing: Drawing) -> Iterator[Finding]:
    """Loose pieces that a burn runs over: the part or slug has dropped, tipped or moved.

    Where the torch is in a part's own metal it burns that, loose or not, which is another finding.
    """
    for piece, over in pieces.under(burn.line):
        lost = [name for name, part in drawing.parts.items() if piece.intersects(part.representative_point())]
        for name in lost:
            over = over.difference(drawing.parts[name])
        if over.is_empty or (over.length <= CROSSED_MM and not over.intersects(shapely.Point(burn.pierce))):
            continue
        kind = "loose-part-burnt" if lost else "loose-waste-burnt"
        what = f"a piece with {', '.join(lost)}" if lost else f"a piece of waste of {piece.area:.0f} mm²"
        text = f"{what} has come loose before; the torch runs over it for"
        yield Finding(kind, burn.cut, (burn.name,), _first(over), float(over.length), "mm", text)


def not_free(drawing: Drawing, pieces: Pieces, cut: set[str], tabbed: Collection[str] = ()) -> Iterator[Finding]:
    """Parts whose outer contour was cut and that yet hold to the sheet or to each other; with tabs, those loose."""
    inside: dict[str, str] = {}
    for name, part in drawing.parts.items():
        outer = next(c.id for c in drawing.closed if c.part == name and c.kind == "outer")
        if outer not in cut:
            continue
        point = part.representative_point()
        x, y = float(point.x), float(point.y)
        if outer in tabbed:
            own = [piece for piece in (*pieces.held, *pieces.loose) if piece.intersects(point)]
            if not any(piece.area > part.area + HELD_BY_MM2 for piece in own):
                yield Finding(
                    "part-not-held", 0, (outer,), (x, y), 0.0, "", "the part has tabs, and is loose at the end"
                )
            continue
        if any(piece.intersects(point) for piece in pieces.held):
            text = "the part still holds to the sheet at the end"
            yield Finding("part-not-free", 0, (outer,), (x, y), 0.0, "", text)
        for k in (k for k, piece in enumerate(pieces.loose) if piece.intersects(point)):
            if str(k) in inside:
                text = "the two parts still hold together at the end"
                yield Finding("part-not-free", 0, (inside[str(k)], outer), (x, y), 0.0, "", text)
            inside[str(k)] = outer


def cut_apart(drawing: Drawing, pieces: Pieces) -> Iterator[Finding]:
    """Parts that a bridge joins and that are in two pieces at the end."""
    for name, *ends in drawing.bridged:
        points = [end.representative_point() for end in ends]
        own = [{k for k, piece in enumerate((*pieces.held, *pieces.loose)) if piece.intersects(p)} for p in points]
        if not own[0] & own[1]:
            at = (float(points[0].x), float(points[0].y))
            yield Finding("bridge-cut", 0, (name,), at, 0.0, "", "its parts hang together no more")


def twice(burns: Sequence[Burn], overcut_mm: float = OVERCUT_MM) -> Iterator[tuple[int, Finding]]:
    """Contours of which more is cut again than where a ring closes, each with the place of the burn in the row."""
    done: dict[str, float] = {}
    for k, burn in enumerate(burns):
        if burn.contour is None:
            continue
        name = burn.contour.id
        before = done.get(name, 0.0)
        done[name] = before + burn.on_ring_mm
        again = min(done[name] - burn.ring_mm, burn.on_ring_mm)
        if again > overcut_mm:
            yield k, Finding("cut-twice", burn.cut, (name,), burn.pierce, again, "mm", "the contour is cut again for")


def _all_round(burns: Sequence[Burn]) -> set[str]:
    """The contours that are cut all round, but for tabs, whatever lies beside them."""
    on_ring_mm: dict[str, float] = {}
    for burn in burns:
        if burn.contour is not None:
            on_ring_mm[burn.contour.id] = on_ring_mm.get(burn.contour.id, 0.0) + burn.on_ring_mm
    return {b.contour.id for b in burns if b.contour is not None and on_ring_mm[b.contour.id] > _ROUND * b.ring_mm}


def along_older(burns: Sequence[Burn], overcut_mm: float = OVERCUT_MM) -> Iterator[tuple[int, Finding]]:
    """Burns that run along the path of an older one for more than a ring closes over, each with its place.

    Two parts a kerf apart may each be cut all round, as beside one that tabs hold.
    """
    tree = shapely.STRtree([burn.line for burn in burns])
    whole = _all_round(burns)
    for k, burn in enumerate(burns):
        near = sorted(j for j in tree.query(burn.line, "dwithin", distance=RING_MM).tolist() if j < k)
        older = [burns[j].line for j in near if not {burn.name, burns[j].name} <= whole or burn.name == burns[j].name]
        again = burn.line.intersection(shapely.buffer(shapely.GeometryCollection(older), RING_MM)) if older else None
        if again is not None and again.length > overcut_mm:
            text = "the torch runs along an older kerf for"
            yield k, Finding("cut-twice", burn.cut, (burn.name,), _first(again), float(again.length), "mm", text)


def _first(where: shapely.Geometry) -> Point:
    x, y = shapely.get_coordinates(where)[0]
    return float(x), float(y)
