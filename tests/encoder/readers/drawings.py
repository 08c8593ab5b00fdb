"""Small drawings made on the spot, and nests read from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import ezdxf
import pytest
import shapely

from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Nest, Note
from kerfwise.encoder.readers import ReadOptions, read_nest
from kerfwise.encoder.readers.drawing import DrawnCurve
from kerfwise.encoder.readers.reading import Reading

Draw = Callable[[Any], object]


def save_dxf(folder: Path, draw: Draw, units: int = 4, version: str = "R2000") -> Path:
    """A DXF file with what `draw` does to the model space; $INSUNITS 4 is mm."""
    document = ezdxf.new(version)
    document.units = units
    draw(document.modelspace())
    path = folder / "drawing.dxf"
    document.saveas(path)
    return path


def read_dxf(folder: Path, draw: Draw, units: int = 4, **options: Any) -> Nest:
    return read_nest(save_dxf(folder, draw, units), ReadOptions(**options))


def sheet(space: Any, width: float = 400, height: float = 300) -> None:
    """A sheet at the origin on its own layer."""
    corners = [(0, 0), (width, 0), (width, height), (0, height)]
    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "Plate H300 W400"})


def lines(space: Any, points: Sequence[tuple[float, float]], layer: str = "0", closed: bool = True) -> None:
    """Single LINEs from point to point."""
    ends = [*points[1:], points[0]] if closed else points[1:]
    for a, b in zip(points, ends, strict=False):
        space.add_line(a, b, dxfattribs={"layer": layer})


def square(x: float, y: float, side: float) -> list[tuple[float, float]]:
    return [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]


def pieces(*rows: Sequence[Sequence[float]], closed: bool = False) -> list[DrawnCurve]:
    """Open pieces (closed on demand) in the order given."""
    return [DrawnCurve(Curve.of(r, closed=closed), "0", k) for k, r in enumerate(rows)]


def segments(points: Sequence[tuple[float, float]]) -> list[list[tuple[float, float]]]:
    """The sides of a polygon, one by one."""
    return [[a, b] for a, b in zip(points, [*points[1:], points[0]], strict=True)]


def texts(notes: Sequence[Note], severity: str | None = None) -> list[str]:
    return [n.text for n in notes if severity in (None, n.severity)]


def areas(nest: Nest) -> dict[str, float]:
    """Contour id → area, mm² to a thousandth."""
    return {c.id: round(abs(c.curve.signed_area_mm2), 3) for c in nest.contours if c.kind != "mark"}


def box(nest: Nest) -> tuple[float, ...]:
    """What all marks of a nest reach: xmin, ymin, xmax, ymax."""
    bounds = shapely.total_bounds([mark.line for part in nest.parts for mark in part.marks])
    return tuple(round(float(side), 3) for side in bounds)


def near(*sides: float) -> Any:
    """What equals a box of these sides but for letters' rounding."""
    return pytest.approx(sides, abs=2e-3)


def reading(nest: Nest) -> Reading:
    """What the readers told of a drawing."""
    assert nest.reading is not None
    return nest.reading
