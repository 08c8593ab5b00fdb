"""Small drawings made on the spot, and nests read from them."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
import pytest
import shapely

import kerfwise
from kerfwise import Nest, Profile

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
    return read_drawing(save_dxf(folder, draw, units), **options)


def read_drawing(path: Path, *, kerf_mm: float = 0.01, spot_mm: float = 2.0, **said: Any) -> Nest:
    """A file as `kerfwise.read_nest` reads it: what that takes, and keys of a profile's section `drawing`.

    With the thinnest kerf that a profile may have, lines that lie apart are never one line drawn twice.
    """
    own = {key: said.pop(key) for key in ("units", "sheet_mm", "frame", "repair", "refit_arcs_mm") if key in said}
    answers: Iterable[tuple[str, str]] = said.pop("answers", ())
    plant = {"material": {"kerf": f"{kerf_mm} mm"}, "small_holes": {"spot_size": f"{spot_mm} mm"}, "drawing": said}
    text = "".join(f"{section}: {json.dumps(values, ensure_ascii=False)}\n" for section, values in plant.items())
    return kerfwise.read_nest(path, _plant(text), answers=dict(answers), **own)


@cache
def _plant(text: str) -> Profile:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "plant.yaml")
        path.write_text(text, encoding="utf-8")
        return kerfwise.load_profile(path)


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


def texts(notes: Sequence[Any], severity: str | None = None) -> list[str]:
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


def reading(nest: Nest) -> Any:
    """What the readers told of a drawing."""
    assert nest.reading is not None
    return nest.reading
