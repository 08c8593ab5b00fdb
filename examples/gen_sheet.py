"""Make a nest (kerfwise-nest/1) of about as many contours as asked: the same for the same seed and size.

Columns of shelves from the left hold strips, plates with holes, frames that host parts in their opening, channels
with a part in their mouth, discs, brackets and slotted plates; at the right an offcut stays. With a web, parts of a
column that look at each other with straight edges are moved together: as far apart as that, a kerf for common cuts.

Usage: python examples/gen_sheet.py SEED CONTOURS OUT.json [--width W] [--height H] [--gap G] [--web W]
"""

from __future__ import annotations

import argparse
import json
import math
import random
from pathlib import Path
from typing import Any

Rows = list[list[float]]
Shape = tuple[Rows, list[Rows]]
"""An outer contour and its holes."""
Cell = tuple[float, float, float, float]
"""x, y, width, height, mm."""

WIDTH_MM, HEIGHT_MM, GAP_MM = 6000.0, 1500.0, 12.0
CONTOURS_AT_THAT_SIZE = 250
QUARTER_TURN = math.tan(math.pi / 8)


def sheet_size_mm(contours: int) -> tuple[float, float]:
    """Width and height of a 4 : 1 sheet with room for that many contours, 6000 × 1500 at least.

    Examples
    --------
    >>> sheet_size_mm(115), sheet_size_mm(1000)
    ((6000.0, 1500.0), (12000.0, 3000.0))
    """
    scale = math.sqrt(max(1.0, contours / CONTOURS_AT_THAT_SIZE))
    return round(WIDTH_MM * scale, 1), round(HEIGHT_MM * scale, 1)


def make_sheet(
    seed: int,
    contours: int,
    size_mm: tuple[float, float] | None = None,
    gap_mm: float = GAP_MM,
    web_mm: float | None = None,
) -> dict[str, Any]:
    """The nest file as a dictionary; it has fewer contours than asked when the sheet is full before.

    `web_mm` is what lies between parts of a column that look at each other with straight edges, `gap_mm` between all
    others; the parts are the same with and without it.

    Examples
    --------
    >>> small = make_sheet(1, 5)
    >>> small["sheet"], [len(p["holes"]) for p in small["parts"]]
    ({'width': 6000.0, 'height': 1500.0}, [0, 0, 2])
    """
    width, height = size_mm or sheet_size_mm(contours)
    shapes = _columns(random.Random(seed), contours, width, height, gap_mm, gap_mm if web_mm is None else web_mm)
    return {
        "format": "kerfwise-nest/1",
        "units": "mm",
        "sheet": {"width": width, "height": height},
        "parts": [
            {"id": f"P{k}", "outer": _rounded(outer), "holes": [_rounded(h) for h in holes]}
            for k, (outer, holes) in enumerate(shapes, 1)
        ],
    }


def contour_count(sheet: dict[str, Any]) -> int:
    """How many contours a nest file has."""
    return sum(1 + len(p["holes"]) for p in sheet["parts"])


def _columns(rnd: random.Random, contours: int, width: float, height: float, gap: float, web: float) -> list[Shape]:
    """Fill the sheet from the left: full-height strips, and columns of cells from the bottom up."""
    shapes: list[Shape] = []
    count, x = 0, gap
    while count < contours and x < width - 80:
        strip = rnd.random() < 0.14
        column = rnd.choice([50, 60, 80] if strip else [120, 160, 200, 260, 320])
        if x + column > width - gap:
            break
        if strip:
            shapes.append((_rect(x, gap, column, height - 2 * gap), []))
            count += 1
        y, down, under_straight = gap, 0.0, False
        while not strip and count < contours:
            h = rnd.choice([90, 110, 150, 200, 260, 300])
            if y + h > height - gap:
                break
            w = column - rnd.choice([0, 0, 8, 20])
            filled = _fill(rnd, (x, y, w, h), gap)
            straight = not _is_round(filled[0])
            down += gap - web if straight and under_straight else 0.0
            under_straight = straight
            shapes += [_moved_down(shape, down) for shape in filled]
            count += sum(1 + len(holes) for _, holes in filled)
            y += h + gap
        x += column + gap
    return shapes


def _fill(rnd: random.Random, cell: Cell, gap: float, nested: bool = False) -> list[Shape]:
    """The parts in one cell: a small cell is a plain plate; only an outermost cell hosts others."""
    kind, small = rnd.random(), min(cell[2:])
    if small < 70 or kind < 0.28:
        return [_plate(cell, with_holes=small > 90 and rnd.random() < 0.5)]
    if kind < 0.42:
        return [_disc(cell, with_hole=rnd.random() < 0.6)]
    if kind < 0.56 and small > 160 and not nested:
        frame, opening = _frame(cell, gap)
        return [frame, *_fill(rnd, opening, gap, nested=True)]
    if kind < 0.72 and small > 140 and not nested:
        channel, mouth = _channel(cell, gap, rnd.choice("RLUD"))
        return [channel, *_fill(rnd, mouth, gap, nested=True)]
    if kind < 0.86:
        return [_bracket(cell, rnd.uniform(0.3, 0.6))]
    return [_slotted(cell)]


def _is_round(shape: Shape) -> bool:
    return all(len(row) > 2 for row in shape[0])


def _moved_down(shape: Shape, by: float) -> Shape:
    outer, *holes = ([[x, y - by, *bulge] for x, y, *bulge in rows] for rows in (shape[0], *shape[1]))
    return outer, holes


def _rect(x: float, y: float, w: float, h: float) -> Rows:
    return [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]


def _circle(cx: float, cy: float, r: float) -> Rows:
    return [[cx - r, cy, 1.0], [cx + r, cy, 1.0]]


def _plate(cell: Cell, with_holes: bool) -> Shape:
    x, y, w, h = cell
    holes = [_circle(x + w * share, y + h / 2, min(w, h) * 0.12) for share in (0.3, 0.7)]
    return _rect(*cell), holes if with_holes else []


def _disc(cell: Cell, with_hole: bool) -> Shape:
    x, y, w, h = cell
    r = min(w, h) / 2
    return _circle(x + r, y + r, r), [_circle(x + r, y + r, r * 0.35)] if with_hole else []


def _frame(cell: Cell, gap: float) -> tuple[Shape, Cell]:
    """A frame, and the cell in its opening."""
    x, y, w, h = cell
    m = min(w, h) * 0.16
    opening = (x + m, y + m, w - 2 * m, h - 2 * m)
    return (_rect(*cell), [_rect(*opening)]), (x + m + gap, y + m + gap, w - 2 * m - 2 * gap, h - 2 * m - 2 * gap)


def _channel(cell: Cell, gap: float, open_to: str) -> tuple[Shape, Cell]:
    """A channel open to the right, left, top or bottom (R, L, U, D), and the cell in its mouth."""
    x, y, w, h = cell
    m = min(w, h) * 0.2
    if open_to in "RL":
        outer = [[x, y], [x + w, y], [x + w, y + m], [x + m, y + m]]
        outer += [[x + m, y + h - m], [x + w, y + h - m], [x + w, y + h], [x, y + h]]
        mouth = (x + m + gap, y + m + gap, w - m - gap, h - 2 * m - 2 * gap)
        if open_to == "L":
            outer = [[2 * x + w - a, b] for a, b in outer][::-1]
            mouth = (x, *mouth[1:])
    else:
        outer = [[x, y], [x + w, y], [x + w, y + h], [x + w - m, y + h]]
        outer += [[x + w - m, y + m], [x + m, y + m], [x + m, y + h], [x, y + h]]
        mouth = (x + m + gap, y + m + gap, w - 2 * m - 2 * gap, h - m - gap)
        if open_to == "D":
            outer = [[a, 2 * y + h - b] for a, b in outer][::-1]
            mouth = (mouth[0], y, *mouth[2:])
    return (outer, []), mouth


def _bracket(cell: Cell, thickness: float) -> Shape:
    x, y, w, h = cell
    inner_x, inner_y = x + w * thickness, y + h * thickness
    return [[x, y], [x + w, y], [x + w, inner_y], [inner_x, inner_y], [inner_x, y + h], [x, y + h]], []


def _slotted(cell: Cell) -> Shape:
    """A plate with rounded corners and a slot."""
    x, y, w, h = cell
    r, q = min(min(w, h) * 0.3, 40), QUARTER_TURN
    outer = [[x + r, y], [x + w - r, y, q], [x + w, y + r], [x + w, y + h - r, q]]
    outer += [[x + w - r, y + h], [x + r, y + h, q], [x, y + h - r], [x, y + r, q]]
    return outer, [_rect(x + w * 0.25, y + h * 0.45, w * 0.5, max(8, h * 0.1))]


def _rounded(rows: Rows) -> Rows:
    """To 0.001 mm, as drawings are."""
    return [[round(v, 3) for v in row] for row in rows]


def main() -> None:
    """Read the command line, write the file, say what is in it."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("seed", type=int)
    arguments.add_argument("contours", type=int)
    arguments.add_argument("out", type=Path)
    arguments.add_argument("--width", type=float, help="mm; grows with the number of contours if left out")
    arguments.add_argument("--height", type=float, help="mm; grows with the number of contours if left out")
    arguments.add_argument("--gap", type=float, default=GAP_MM, help="mm between parts")
    arguments.add_argument("--web", type=float, help="mm between straight edges in a column; as the gap if left out")
    options = arguments.parse_args()
    width, height = sheet_size_mm(options.contours)
    size_mm = options.width or width, options.height or height
    sheet = make_sheet(options.seed, options.contours, size_mm, options.gap, options.web)
    options.out.write_text(json.dumps(sheet), encoding="utf-8", newline="\n")
    print(f"{contour_count(sheet)} contours, {len(sheet['parts'])} parts")


if __name__ == "__main__":
    main()
