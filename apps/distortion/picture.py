"""The sheet with the shapes that its parts will have, drawn many times as far off as they are; SVG."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence

import numpy as np
import shapely

from kerfwise.arrays import Floats
from kerfwise.encoder.nest import Contour, Nest

from .part_errors import PartError

_WIDTH = 1200.0
_DRAWN = 0.025
"""The worst place is drawn about so far off, as a share of the sheet's longer side."""
_COLOURS = ("#1b7837", "#7fbf7b", "#e0a100", "#d95f0e", "#b10026")


def exaggeration(worst_mm: float, long_side_mm: float) -> float:
    """How many times as large errors are drawn: 1, 2 or 5 times a power of ten.

    Examples
    --------
    >>> exaggeration(1.3, 3000.0), exaggeration(0.0, 3000.0)
    (50.0, 1.0)
    """
    if worst_mm <= 0:
        return 1.0
    wanted = max(1.0, _DRAWN * long_side_mm / worst_mm)
    power: float = 10.0 ** math.floor(math.log10(wanted))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= wanted)


def draw_parts(nest: Nest, parts: Sequence[PartError], title: str) -> bytes:
    """Every part as it is drawn (grey) and as it will be, coloured by its worst error, which stands beside it."""
    x0, y0, x1, y1 = nest.sheet.bounds
    scale = _WIDTH / max(x1 - x0, 1e-9)
    height = (y1 - y0) * scale
    worst = max((p.max_mm or 0.0 for p in parts), default=0.0)
    times = exaggeration(worst, max(x1 - x0, y1 - y0))

    def path(points: Floats) -> str:
        at = np.column_stack([(points[:, 0] - x0) * scale, (y1 - points[:, 1]) * scale])
        return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in at)

    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="-20 -64 {_WIDTH + 40:.0f} {height + 110:.0f}" '
        'font-family="sans-serif" font-size="14">',
        f'<rect x="-20" y="-64" width="{_WIDTH + 40:.0f}" height="{height + 110:.0f}" fill="#ffffff"/>',
        f'<text x="0" y="-40" font-size="16">{html.escape(title)}</text>',
        f'<text x="0" y="-18" fill="#555555">shapes are drawn {times:g} times as far off as they are; '
        "grey: as drawn in the nest</text>",
    ]
    rings = [nest.sheet.polygon.exterior, *nest.sheet.polygon.interiors]
    for ring in rings:
        lines.append(f'<path d="{path(shapely.get_coordinates(ring))}Z" fill="none" stroke="#222222"/>')
    labels = []
    for error in parts:
        part = nest.part_of[error.part]
        contours = [contour for contour in part if contour.shapes_part]
        for contour in contours:
            lines.append(f'<path d="{path(shapely.get_coordinates(contour.line))}" fill="none" stroke="#b0b0b0"/>')
        if error.max_mm is None or error.at is None:
            continue
        colour = _COLOURS[min(int(error.max_mm / max(worst, 1e-12) * len(_COLOURS)), len(_COLOURS) - 1)]
        for contour in contours:
            points = shapely.get_coordinates(shapely.segmentize(contour.line, max(contour.line.length / 120, 1e-6)))
            off = off_along(contour, nest.index[contour.id], points, error)
            if off is not None:
                bent = path(points + times * off)
                lines.append(f'<path d="{bent}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        x, y = part.polygon.representative_point().coords[0]
        label = html.escape(f"{error.part} {error.max_mm:.2f}")
        labels.append(
            f'<text x="{(x - x0) * scale:.1f}" y="{(y1 - y) * scale:.1f}" text-anchor="middle" font-size="11" '
            f'fill="#111111">{label}</text>'
        )
        ax, ay = error.at
        labels.append(f'<circle cx="{(ax - x0) * scale:.1f}" cy="{(y1 - ay) * scale:.1f}" r="3" fill="{colour}"/>')
    lines += labels
    for k, colour in enumerate(_COLOURS):
        at = k * 150
        label = f"{worst * k / len(_COLOURS):.2f} to {worst * (k + 1) / len(_COLOURS):.2f} mm"
        lines.append(f'<rect x="{at}" y="{height + 16:.1f}" width="14" height="14" fill="{colour}"/>')
        lines.append(f'<text x="{at + 20}" y="{height + 28:.1f}">{label}</text>')
    lines.append("</svg>\n")
    return "\n".join(lines).encode("utf-8")


def off_along(contour: Contour, number: int, points: Floats, error: PartError) -> Floats | None:
    """How far off points (k, 2) along a contour are, mm (k, 2): straight between those followed; None without any."""
    mine = error.contour == number
    if not mine.any():
        return None
    line = contour.line
    along = shapely.line_locate_point(line, shapely.points(error.xy[mine]))
    order = np.argsort(along)
    along, off = along[order], error.off[mine][order]
    at = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    period = line.length if contour.curve.closed else None
    return np.column_stack([np.interp(at, along, off[:, c], period=period) for c in (0, 1)])
