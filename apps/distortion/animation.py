"""How the sheet moves while it is cut, many times as far as it does: a page that plays by itself, no network needed."""

from __future__ import annotations

import html
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any

import numpy as np
import shapely

from kerfwise.arrays import Floats, Ints
from kerfwise.encoder.nest import Nest
from kerfwise.models.physics.heat import TimedPath
from kerfwise.rules.profile.plant_sections import Heat

from .cutting import Cutting, Followed, cut_sheet
from .part_errors import PartError, errors_of
from .picture import exaggeration, off_along

FRAMES = 150
POINTS = 64
"""Points along each contour and along the sheet's edge, at the most."""
LEAST_STEP_MM = 4.0


@dataclass(frozen=True, eq=False, slots=True)
class _Line:
    """A closed or open line: its points (k, 2), mm, and the number of the part that it bounds, -1 for the sheet."""

    name: str
    kind: str
    xy: Floats
    part: int


def animate(nest: Nest, path: TimedPath, heat: Heat, how: Cutting, title: str) -> bytes:
    """An HTML page: the sheet, its parts and the torch along the program's time, then the parts as they will be.

    Where metal is that has moved is drawn `exaggeration` times as far off. What is cut free stays where it was.

    Raises
    ------
    InputError
        If nothing is known of the metal's strength.
    """
    page = (resources.files(__package__) / "animation.html").read_text(encoding="utf-8")
    text = json.dumps(movement(nest, path, heat, how), separators=(",", ":")).replace("<", "\\u003c")
    return page.replace("{{title}}", html.escape(title)).replace("{{data}}", text).encode("utf-8")


def movement(
    nest: Nest, path: TimedPath, heat: Heat, how: Cutting, frames: int = FRAMES, points: int = POINTS
) -> dict[str, Any]:
    """Where metal is at each of some `frames`, as JSON can hold it; each line has so many `points` at the most.

    `lines` are the sheet's edge and the contours of parts: `xy` as drawn, mm, `moved` in each frame and how far `cold`
    ones are off, both in µm, `off` what the part is off at its worst place, mm.

    Raises
    ------
    InputError
        If nothing is known of the metal's strength.
    """
    lines = list(_lines(nest, points))
    xy = np.concatenate([line.xy for line in lines])
    part = np.concatenate([np.full(len(line.xy), line.part) for line in lines])
    at_s = _frames(path, frames)
    follow = Followed(xy, part, at_s, np.zeros((len(at_s), len(xy), 2)))
    errors = errors_of(nest, cut_sheet(nest, path, heat, how, follow))
    moved = _without_drift(follow)
    x0, y0, x1, y1 = nest.sheet.bounds
    long_mm = max(x1 - x0, y1 - y0)
    most_mm = float(np.hypot(moved[..., 0], moved[..., 1]).max(initial=0.0))
    worst_mm = max((e.max_mm or 0.0 for e in errors), default=0.0)
    ends = np.cumsum([0, *(len(line.xy) for line in lines)])
    cut_s = {burn.contour: float(burn.at_s[-1]) for burn in path.burns}
    by_part = {error.part: error for error in errors}
    return {
        "sheet": [x0, y0, x1, y1],
        "at_s": np.round(at_s, 1).tolist(),
        "times": exaggeration(0.4 * most_mm, long_mm),
        "times_cold": exaggeration(worst_mm, long_mm),
        "torch": np.round(_torch(path, at_s), 1).tolist(),
        "lines": [
            {
                "name": line.name,
                "kind": line.kind,
                "xy": np.round(line.xy, 1).ravel().tolist(),
                "moved": _um(moved[:, a:b].reshape(len(at_s), -1)),
                "cut_s": cut_s.get(line.name),
                "cold": _cold(nest, line, by_part),
                "off": by_part[nest.contour(line.name).part].max_mm if line.kind == "outer" else None,
            }
            for line, a, b in zip(lines, ends[:-1].tolist(), ends[1:].tolist(), strict=True)
        ],
    }


def _lines(nest: Nest, points: int) -> list[_Line]:
    number = {part.id: k for k, part in enumerate(nest.parts)}
    rings = [nest.sheet.polygon.exterior, *nest.sheet.polygon.interiors]
    found = [_Line("", "sheet", _points(ring, points), -1) for ring in rings]
    for contour in nest.contours:
        if contour.shapes_part:
            found.append(_Line(contour.id, contour.kind, _points(contour.line, points), number[contour.part]))
    return found


def _points(line: shapely.LineString, count: int) -> Floats:
    """The corners of a line, and points between them."""
    points: Floats = shapely.get_coordinates(shapely.segmentize(line, max(line.length / count, LEAST_STEP_MM)))
    return points


def _frames(path: TimedPath, count: int) -> Floats:
    """Times of frames: the torch goes on evenly from one to the next, and travels in no time."""
    starts = np.array([burn.at_s[0] for burn in path.burns])
    on_s = np.array([burn.seconds for burn in path.burns])
    total = np.concatenate([[0.0], np.cumsum(on_s)])
    at = np.linspace(0.0, total[-1], count) if len(on_s) else np.zeros(1)
    k = np.clip(np.searchsorted(total, at, side="right") - 1, 0, max(len(on_s) - 1, 0))
    found: Floats = starts[k] + at - total[k] if len(on_s) else at
    return found


def _torch(path: TimedPath, at_s: Floats) -> Floats:
    """Where the torch is at each of these times (f, 2)."""
    if not path.burns:
        return np.zeros((len(at_s), 2))
    when = np.concatenate([burn.at_s for burn in path.burns])
    xy = np.concatenate([burn.xy for burn in path.burns])
    return np.column_stack([np.interp(at_s, when, xy[:, c]) for c in (0, 1)])


def _without_drift(follow: Followed) -> Floats:
    """The movements (f, k, 2) without what the sheet's edge has moved on average: where it lies is nobody's concern."""
    edge: Ints = np.flatnonzero(follow.part < 0)
    found: Floats = follow.moved - follow.moved[:, edge].mean(axis=1, keepdims=True)
    return found


def _cold(nest: Nest, line: _Line, by_part: Mapping[str, PartError]) -> list[int] | None:
    """How far the points of a contour are off when all is cold, µm; None for the sheet and for what was not cut."""
    if line.kind == "sheet":
        return None
    contour = nest.contour(line.name)
    off = off_along(contour, nest.index[line.name], line.xy, by_part[contour.part])
    return None if off is None else _um(off.ravel())


def _um(mm: Floats) -> Any:
    return np.round(mm * 1000).astype(np.int64).tolist()
