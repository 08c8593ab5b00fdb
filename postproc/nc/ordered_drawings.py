"""Drawings in cutting order: a DXF or SVG file's own lines, or a plan's torch paths."""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import total_ordering
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from kerfwise.encoder.errors import InputError
from kerfwise.encoder.files import read_limited
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Nest
from kerfwise.encoder.readers.json_nest import dxf_in_mm
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.profile.technique import Technique

from .toolpaths import Toolpath, toolpaths

_NEAR_MM = 0.03
"""How far a drawn line may lie off the contour that it is a piece of, besides what loose ends are joined over."""
_SAMPLES = 9


@total_ordering
@dataclass(frozen=True, slots=True)
class DrawnPlace:
    """The cut that a line belongs to, from 1 on, and how far after the entry its middle comes, mm.

    0 for what the plan does not cut: the sheet's outline, left out layers, writing. `dropped` is a line of a contour
    that the drawing has and the plan leaves uncut.
    """

    position: int
    along_mm: float = 0.0
    dropped: str = ""

    def __lt__(self, other: DrawnPlace) -> bool:
        return (self.position, self.along_mm) < (other.position, other.along_mm)


class DrawnOrder:
    """The contours of a nest as it is drawn, in the order of a plan, to find the places of a drawing's lines."""

    def __init__(self, plan: Plan, nest: Nest, options: ReadOptions) -> None:
        drawn = nest.drawn or nest
        self._cuts = {planned.cut.contour: (k, planned.cut) for k, planned in enumerate(plan.cuts, 1)}
        self._kinds = {contour.id: contour.kind for contour in nest.contours}
        self._contours = drawn.contours
        self._tree = shapely.STRtree([contour.curve.line(_NEAR_MM / 4) for contour in drawn.contours])
        self._off_mm = options.join_tolerance_mm + (options.refit_arcs_mm or 0.0) + _NEAR_MM

    def place(self, curve: Curve) -> DrawnPlace:
        """The place of a drawn line; where contours of two parts share it, that of the one that is cut first."""
        places = [self._place_on(int(k), curve) for k in self._along(curve)]
        cut = [place for place in places if place.position]
        return min(cut or places, default=DrawnPlace(0))

    def _along(self, curve: Curve) -> Iterable[int]:
        """The contours that all of a curve runs along."""
        lengths = np.linspace(0.0, curve.length_mm, _SAMPLES)
        points = shapely.points([curve.point_at(s) for s in lengths.tolist()]) if curve.segments else np.array([])
        which, found = self._tree.query(points, predicate="dwithin", distance=self._off_mm)
        numbers, counts = np.unique(np.unique(np.column_stack([found, which]), axis=0)[:, 0], return_counts=True)
        return numbers[counts == len(points)].tolist() if len(points) else ()

    def _place_on(self, number: int, curve: Curve) -> DrawnPlace:
        contour = self._contours[number]
        if contour.id not in self._cuts or self._kinds.get(contour.id) != contour.kind:
            return DrawnPlace(0, dropped=contour.id)
        position, cut = self._cuts[contour.id]
        ring = contour.curve
        if ring.closed:
            ring = ring.towards(cut.direction)
        elif cut.direction == "cw":
            ring = ring.reversed()
        middle_mm = ring.project(curve.point_at(curve.length_mm / 2))[0]
        entry_mm = ring.project(cut.entry)[0] if ring.closed else 0.0
        return DrawnPlace(position, (middle_mm - entry_mm) % ring.length_mm if ring.closed else middle_mm)


def contours_in_order(plan: Plan, nest: Nest) -> Iterator[tuple[Contour, Curve]]:
    """Every contour that the plan cuts, with its curve from the entry on in the cut's direction."""
    for planned in plan.cuts:
        contour, cut = nest.contour(planned.cut.contour), planned.cut
        ring = contour.curve
        if ring.closed:
            opened = ring.towards(cut.direction).opened_at(ring.towards(cut.direction).project(cut.entry)[0])
            yield contour, Curve(opened.vertices[:-1], closed=True)
        else:
            yield contour, ring if cut.direction == "ccw" else ring.reversed()


@dataclass(frozen=True, slots=True)
class Reordered:
    """A drawing in cutting order: the content of its file, and what the user should know of it."""

    content: bytes
    notes: tuple[str, ...] = ()


def notes_of(dropped: Iterable[str]) -> tuple[str, ...]:
    """That contours are left out which the plan does not cut as they are drawn."""
    names = sorted(set(dropped))
    if not names:
        return ()
    shown = ", ".join(names[:3]) + (", …" if len(names) > 3 else "")
    return (f"the plan does not cut {shown} as drawn: the reordered drawing is without",)


# A plan's torch paths as a drawing, for controls and CAM systems that take DXF: a polyline a cut, in cutting order.

LAYERS: Mapping[str, str] = {
    "outer": "CUT_OUTER",
    "hole": "CUT_HOLE",
    "slit": "CUT_SLIT",
    "mark": "MARK",
    "scrap": "CUT_SCRAP",
}
"""The layer of each kind of contour."""


def write_dxf(plan: Plan, nest: Nest, profile: Technique) -> str:
    """The torch paths of `plan` as DXF R12, in mm: polylines in the order of the cuts, each in its direction.

    Each begins at the pierce and ends where the torch goes off, leads included, kerf allowed for; arcs are bulges. What
    is linked is one polyline. Coordinates are the program's. The same plan gives the same bytes. Raises InputError if
    the plan was made from another nest, or for several torches, which no drawing can tell.
    """
    if any(planned.cut.torch > 1 for planned in plan.cuts):
        raise InputError("a drawing of the torch's paths knows one torch, and the plan uses several (machine.torches)")
    from ezdxf.addons.r12writer import r12writer  # loaded by those who ask for a drawing only

    profile = profile.at_origin(plan.origin)
    x, y = profile.frame_on(profile.as_cut(nest)).corner
    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        for toolpath in _burns(toolpaths(plan, nest, profile)):
            for piece in toolpath.pieces[::2]:
                rows = piece.moved(-x, -y).vertices.tolist()
                drawing.add_polyline_2d(rows, format="xyb", closed=False, layer=LAYERS[toolpath.planned.kind])
    return dxf_in_mm(text.getvalue())


def _burns(paths: Iterable[Toolpath]) -> Iterator[Toolpath]:
    """The paths, what is linked as one, of the kind of its first."""
    burn: Toolpath | None = None
    for toolpath in paths:
        if burn is not None and toolpath.linked:
            rows = np.vstack([burn.path.vertices[:-1], toolpath.path.vertices])
            burn = replace(burn, path=Curve(rows, closed=False))
            continue
        if burn is not None:
            yield burn
        burn = toolpath
    if burn is not None:
        yield burn


# A DXF drawing in cutting order: its own entities, untouched but for their order, or a nest's contours.

SHEET_LAYER = "SHEET"
_BY_BLOCK, _BY_LAYER = 0, 256
"""Numbers of colours that say whose colour an entity has."""


def reordered_dxf(plan: Plan, nest: Nest, file: str | Path, options: ReadOptions) -> Reordered:
    """The drawing of a nest with its entities in the order of the plan.

    Entities of a DXF keep geometry, layer, colour and all else; blocks that hold contours are taken apart. What the
    plan does not cut stays in front. Another kind of nest file is drawn from its contours: a polyline each, arcs as
    bulges, from its entry on and in its direction. The same plan gives the same bytes. Raises InputError if the file
    cannot be read any more.
    """
    if Path(file).suffix.lower() != ".dxf":
        return Reordered(_from_contours(plan, nest))
    from kerfwise.encoder.readers.dxf import document_of, mm_per_unit

    document = document_of(Path(file))
    space = document.modelspace()
    order = DrawnOrder(plan, nest, options)
    scale = mm_per_unit(Path(file), document, options)
    lost: set[str] = set()
    moved: list[tuple[DrawnPlace, int, Any]] = []
    for entity in list(space):
        pieces = list(_pieces(entity, document, order, scale))
        lost.update(place.dropped for _, place in pieces if place.dropped)
        if not any(place.position or place.dropped for _, place in pieces):
            continue
        if pieces[0][0] is not entity:
            space.delete_entity(entity)
        else:
            space.unlink_entity(entity)
        moved += [(place, len(moved) + k, piece) for k, (piece, place) in enumerate(pieces) if not place.dropped]
    for _, _, entity in sorted(moved, key=lambda row: row[:2]):
        space.add_entity(entity)
    text = io.StringIO()
    with _without_dates():
        document.write(text)
    return Reordered(document.encode(text.getvalue()), notes_of(lost))


def _pieces(entity: Any, document: Any, order: DrawnOrder, scale: float) -> Iterator[tuple[Any, DrawnPlace]]:
    """The entity with its place; of a block all that it holds, each on the layer that it is seen on."""
    from kerfwise.encoder.readers.dxf import hidden_layers
    from kerfwise.encoder.readers.dxf_entities import Unread, curve, entities

    for placed in entities([entity], hidden_layers(document), Unread()):
        piece = placed.entity
        if piece.dxftype() == "ATTRIB":  # stands in no drawing without its block
            continue
        drawn = curve(piece, scale)
        if piece is not entity:
            piece.dxf.layer = placed.layer
            if piece.dxf.get("color", _BY_LAYER) == _BY_BLOCK:
                piece.dxf.color = entity.dxf.get("color", _BY_LAYER)
        yield piece, DrawnPlace(0) if drawn is None else order.place(drawn)


@contextmanager
def _without_dates() -> Iterator[None]:
    """The library writes when and by whom a drawing was saved, unless it is told that this is a test."""
    import ezdxf

    options: Any = vars(ezdxf)["options"]
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def _from_contours(plan: Plan, nest: Nest) -> bytes:
    from ezdxf.addons.r12writer import r12writer

    text = io.StringIO(newline="")
    with r12writer(text) as drawing:
        for curve in (nest.sheet.outline, *nest.sheet.holes) if nest.sheet.stated else ():
            drawing.add_polyline_2d(curve.vertices.tolist(), format="xyb", closed=True, layer=SHEET_LAYER)
        for contour, curve in contours_in_order(plan, nest):
            rows = curve.vertices.tolist()
            drawing.add_polyline_2d(rows, format="xyb", closed=curve.closed, layer=LAYERS[contour.kind])
    return dxf_in_mm(text.getvalue()).encode("ascii")


SVG_SHEET_LAYER = "SHEET"
_THIN = ' fill="none" stroke="#000000" stroke-width="0.2"'


@dataclass(frozen=True, slots=True)
class _Path:
    """One path: the layer it is on, its commands in mm from the page's upper left corner, and how it is painted."""

    layer: str
    commands: str
    look: str


def reordered_svg(plan: Plan, nest: Nest, file: str | Path, options: ReadOptions) -> Reordered:
    """The drawing of a nest with its shapes in the order of the plan, in mm.

    Shapes of an SVG keep their geometry, arcs and Bézier curves too, their layer and colours; each subpath is a path of
    its own. What the plan does not cut stays in front; writing and images are left out. Another kind of nest file is
    drawn from its contours, arcs as arcs, from their entries on and in their directions. The same plan gives the same
    bytes. Raises InputError if the file cannot be read any more.
    """
    if Path(file).suffix.lower() != ".svg":
        left, bottom, right, top = nest.sheet.bounds
        return Reordered(_document(_svg_from_contours(plan, nest, (-left, -top)), (right - left, top - bottom)))
    return _from_drawing(plan, nest, Path(file), options)


def _from_drawing(plan: Plan, nest: Nest, file: Path, options: ReadOptions) -> Reordered:
    import svgelements

    from kerfwise.encoder.readers.read import unpacked
    from kerfwise.encoder.readers.svg import curves, parsed_svg, shown_elements
    from kerfwise.encoder.readers.svg_viewports import page_of

    svg = parsed_svg(unpacked(read_limited(file), file))
    page, order = page_of(svg, options), DrawnOrder(plan, nest, options)
    x0, y0, x1, y1 = page.sheet.bounds if page.sheet is not None else nest.sheet.bounds
    lost: set[str] = set()
    found: list[tuple[DrawnPlace, int, _Path]] = []
    for shown in shown_elements(svg):
        if not isinstance(shown.element, svgelements.Shape):
            continue
        for subpath in abs(svgelements.Path(shown.element) * page.to_mm).as_subpaths():
            drawn = curves(svgelements.Path(subpath), svgelements.Matrix())
            piece = abs(svgelements.Path(subpath) * svgelements.Matrix(1, 0, 0, 1, -x0, -y1))
            place = order.place(drawn[0]) if drawn else DrawnPlace(0)
            lost.update([place.dropped] if place.dropped else [])
            if drawn and not place.dropped:
                found.append((place, len(found), _Path(shown.layer, _commands(piece), _look(shown.element))))
    paths = [path for _, _, path in sorted(found, key=lambda row: row[:2])]
    return Reordered(_document(paths, (x1 - x0, y1 - y0)), notes_of(lost))


def _document(paths: Iterable[_Path], size: tuple[float, float]) -> bytes:
    """The file: paths that follow each other on one layer share its group."""
    width, height = map(_number, size)
    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
        f' width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}">'
    ]
    for layer, group in groupby(paths, key=lambda path: path.layer):
        lines.append(f'<g inkscape:groupmode="layer" inkscape:label={_quoted(layer)}>' if layer else "<g>")
        lines += [f'<path d="{path.commands}"{path.look}/>' for path in group]
        lines.append("</g>")
    return ("\n".join([*lines, "</svg>"]) + "\n").encode("utf-8")


def _look(element: Any) -> str:
    """Fill, stroke and line width, as they are seen."""
    fill, stroke = (None if colour is None or colour.value is None else colour.hex for colour in
                    (element.fill, element.stroke))  # fmt: skip
    width = element.values.get("stroke-width")
    return f' fill="{fill or "none"}" stroke="{stroke or "none"}"' + (
        f" stroke-width={_quoted(str(width))}" if width else ""
    )


def _commands(path: Any) -> str:
    """A path's commands, y turned down, to a millionth of a millimetre."""
    import svgelements

    commands = []
    for segment in path:
        end = "" if segment.end is None else _xy(segment.end)
        match segment:
            case svgelements.Move():
                commands.append(f"M{end}")
            case svgelements.Close():
                commands.append("Z")
            case svgelements.CubicBezier():
                commands.append(f"C{_xy(segment.control1)} {_xy(segment.control2)} {end}")
            case svgelements.QuadraticBezier():
                commands.append(f"Q{_xy(segment.control)} {end}")
            case svgelements.Arc():
                commands += _arc(segment)
            case _:
                commands.append(f"L{end}")
    return "".join(commands)


def _arc(arc: Any) -> Iterator[str]:
    """An arc; one of more than half a turn in two, for a whole turn ends where it began."""
    halves = (0.5, 1.0) if abs(arc.sweep) > math.pi else (1.0,)
    turn = -math.degrees(float(arc.get_rotation()))
    sweep = 0 if arc.sweep > 0 else 1  # y turns round on the page
    for at in halves:
        end = arc.end if at == 1.0 else arc.point(at)
        yield f"A{_number(arc.rx)} {_number(arc.ry)} {_number(turn)} 0 {sweep} {_xy(end)}"


def _svg_from_contours(plan: Plan, nest: Nest, shift: Point) -> Iterator[_Path]:
    for outline in (nest.sheet.outline, *nest.sheet.holes) if nest.sheet.stated else ():
        yield _Path(SVG_SHEET_LAYER, _of_curve(outline.moved(*shift)), _THIN)
    for contour, curve in contours_in_order(plan, nest):
        yield _Path(LAYERS[contour.kind], _of_curve(curve.moved(*shift)), _THIN)


def _of_curve(curve: Curve) -> str:
    commands = [f"M{_xy(curve.segments[0].start)}"]
    for segment in curve.segments:
        if not segment.is_arc:
            commands.append(f"L{_xy(segment.end)}")
            continue
        radius, sweep = _number(segment.radius_mm), 0 if segment.bulge > 0 else 1
        for at in (0.5, 1.0) if abs(segment.sweep_rad) > math.pi else (1.0,):
            commands.append(f"A{radius} {radius} 0 0 {sweep} {_xy(segment.point_at(at))}")
    return "".join(commands) + ("Z" if curve.closed else "")


def _xy(point: Any) -> str:
    x, y = point
    return f"{_number(x)},{_number(-y)}"


def _number(value: float) -> str:
    text = f"{float(value):.6f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def _quoted(text: str) -> str:
    """The text as the value of an attribute."""
    from xml.sax.saxutils import quoteattr  # brings urllib along, which most runs do without

    return quoteattr(text)
