"""An SVG drawing in cutting order: its own shapes, a path each, or a nest's contours."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

from kerfwise.encoder.contents import contents
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers.options import ReadOptions
from kerfwise.models.plan.plan import Plan

from .drawn_order import DrawnOrder, DrawnPlace, Reordered, contours_in_order, notes_of
from .dxf_out import LAYERS

SHEET_LAYER = "SHEET"
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
    bytes.

    Raises
    ------
    InputError
        If the file cannot be read any more.
    """
    if Path(file).suffix.lower() != ".svg":
        left, bottom, right, top = nest.sheet.bounds
        return Reordered(_document(_from_contours(plan, nest, (-left, -top)), (right - left, top - bottom)))
    return _from_drawing(plan, nest, Path(file), options)


def _from_drawing(plan: Plan, nest: Nest, file: Path, options: ReadOptions) -> Reordered:
    import svgelements

    from kerfwise.encoder.readers.svg import parsed_svg, shown_elements
    from kerfwise.encoder.readers.svg_page import page_of
    from kerfwise.encoder.readers.svg_paths import curves

    svg = parsed_svg(contents(file))
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
        lines.append(f'<g inkscape:groupmode="layer" inkscape:label={quoteattr(layer)}>' if layer else "<g>")
        lines += [f'<path d="{path.commands}"{path.look}/>' for path in group]
        lines.append("</g>")
    return ("\n".join([*lines, "</svg>"]) + "\n").encode("utf-8")


def _look(element: Any) -> str:
    """Fill, stroke and line width, as they are seen."""
    fill, stroke = (None if colour is None or colour.value is None else colour.hex for colour in
                    (element.fill, element.stroke))  # fmt: skip
    width = element.values.get("stroke-width")
    return f' fill="{fill or "none"}" stroke="{stroke or "none"}"' + (
        f" stroke-width={quoteattr(str(width))}" if width else ""
    )


def _commands(path: Any) -> str:
    """A path's commands, y turned down, to a millionth of a millimetre."""
    import svgelements

    told = []
    for segment in path:
        end = "" if segment.end is None else _xy(segment.end)
        match segment:
            case svgelements.Move():
                told.append(f"M{end}")
            case svgelements.Close():
                told.append("Z")
            case svgelements.CubicBezier():
                told.append(f"C{_xy(segment.control1)} {_xy(segment.control2)} {end}")
            case svgelements.QuadraticBezier():
                told.append(f"Q{_xy(segment.control)} {end}")
            case svgelements.Arc():
                told += _arc(segment)
            case _:
                told.append(f"L{end}")
    return "".join(told)


def _arc(arc: Any) -> Iterator[str]:
    """An arc; one of more than half a turn in two, for a whole turn ends where it began."""
    halves = (0.5, 1.0) if abs(arc.sweep) > math.pi else (1.0,)
    turn = -math.degrees(float(arc.get_rotation()))
    sweep = 0 if arc.sweep > 0 else 1  # y turns round on the page
    for at in halves:
        end = arc.end if at == 1.0 else arc.point(at)
        yield f"A{_number(arc.rx)} {_number(arc.ry)} {_number(turn)} 0 {sweep} {_xy(end)}"


def _from_contours(plan: Plan, nest: Nest, shift: Point) -> Iterator[_Path]:
    for outline in (nest.sheet.outline, *nest.sheet.holes) if nest.sheet.stated else ():
        yield _Path(SHEET_LAYER, _of_curve(outline.moved(*shift)), _THIN)
    for contour, curve in contours_in_order(plan, nest):
        yield _Path(LAYERS[contour.kind], _of_curve(curve.moved(*shift)), _THIN)


def _of_curve(curve: Curve) -> str:
    told = [f"M{_xy(curve.segments[0].start)}"]
    for segment in curve.segments:
        if not segment.is_arc:
            told.append(f"L{_xy(segment.end)}")
            continue
        radius, sweep = _number(segment.radius_mm), 0 if segment.bulge > 0 else 1
        for at in (0.5, 1.0) if abs(segment.sweep_rad) > math.pi else (1.0,):
            told.append(f"A{radius} {radius} 0 0 {sweep} {_xy(segment.point_at(at))}")
    return "".join(told) + ("Z" if curve.closed else "")


def _xy(point: Any) -> str:
    x, y = point
    return f"{_number(x)},{_number(-y)}"


def _number(value: float) -> str:
    text = f"{float(value):.6f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
