"""Draw the ten small nests of a planner's morning as DXF, two of them broken: the same bytes each time.

docs/tutorial-planner.md leads through them. `--mended` draws the two as they should be, as the planner would in CAD.

Usage: python examples/gen_morning.py FOLDER [--mended]
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from ezdxf.addons import r12writer

Point = tuple[float, float]
Outline = list[Point]

BROKEN = ("cover", "gusset")
"""One has an outline that is open, the other a part that lies over the edge of the sheet."""
OPENING_MM = 8.0


def rectangle(x: float, y: float, width: float, height: float) -> Outline:
    """A rectangle from its corner at the bottom left."""
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def bracket(x: float, y: float, size: float) -> Outline:
    """An L whose arms are 0.4 of its size."""
    arm = 0.4 * size
    return [(x, y), (x + size, y), (x + size, y + arm), (x + arm, y + arm), (x + arm, y + size), (x, y + size)]


def triangle(x: float, y: float, size: float) -> Outline:
    """A right-angled triangle."""
    return [(x, y), (x + size, y), (x, y + size)]


class Drawing:
    """What is drawn of a nest: the size of its sheet, outlines, and holes as centre and radius."""

    def __init__(self, width: float, height: float) -> None:
        self.size = (width, height)
        self.outlines: list[Outline] = []
        self.holes: list[tuple[Point, float]] = []
        self.open = False

    def row(self, outline: Outline, count: int, step: float, *holes: tuple[Point, float]) -> Drawing:
        """The same part so many times to the right, each with its holes."""
        for k in range(count):
            self.outlines.append([(x + k * step, y) for x, y in outline])
            self.holes += [((x + k * step, y), radius) for (x, y), radius in holes]
        return self

    def write(self, path: Path) -> None:
        """As DXF of R12, which has no date in it."""
        with r12writer(str(path)) as dxf:
            dxf.add_polyline_2d(rectangle(0, 0, *self.size), layer="SHEET", closed=True)
            for k, outline in enumerate(self.outlines):
                gap = self.open and k == 0
                dxf.add_polyline_2d(_opened(outline) if gap else outline, layer="CUT", closed=not gap)
            for centre, radius in self.holes:
                dxf.add_circle(centre, radius, layer="CUT")


def _opened(outline: Outline) -> Sequence[Point]:
    """The outline without its last few millimetres."""
    (x, y), (to_x, to_y) = outline[-1], outline[0]
    length = abs(to_x - x) + abs(to_y - y)
    left = 1 - OPENING_MM / length
    return [*outline, (x + left * (to_x - x), y + left * (to_y - y))]


def drawings(mended: bool = False) -> dict[str, Drawing]:
    """The ten nests by their names."""
    cover = Drawing(400, 200).row(rectangle(20, 30, 160, 140), 2, 190, ((60, 100), 15), ((140, 100), 15))
    cover.open = not mended
    gusset = Drawing(360, 160).row(triangle(10 if mended else 40, 20, 110), 3, 115)
    return {
        "angle": Drawing(420, 180).row(bracket(20, 25, 120), 3, 135),
        "base": Drawing(300, 300).row(rectangle(30, 30, 240, 240), 1, 0, *_corners(60, 60, 180, 12), ((150, 150), 40)),
        "cover": cover,
        "flange": Drawing(460, 200).row(rectangle(25, 30, 130, 130), 3, 145, ((90, 95), 30)),
        "gusset": gusset,
        "hinge": Drawing(380, 220).row(rectangle(20, 25, 70, 170), 4, 88, ((55, 60), 10), ((55, 160), 10)),
        "plate": Drawing(500, 240).row(rectangle(25, 30, 210, 180), 2, 240, *_corners(55, 60, 140, 11)),
        "rib": Drawing(520, 160).row(rectangle(20, 25, 60, 110), 6, 80),
        "shim": Drawing(320, 220).row(rectangle(20, 20, 80, 80), 3, 98).row(rectangle(20, 118, 80, 80), 3, 98),
        "washer": Drawing(400, 140).row(rectangle(20, 25, 85, 85), 4, 92, ((62.5, 67.5), 20)),
    }


def _corners(x: float, y: float, apart: float, radius: float) -> list[tuple[Point, float]]:
    """Four holes in a square."""
    return [((x + dx, y + dy), radius) for dx in (0.0, apart) for dy in (0.0, min(apart, 120.0))]


def draw(folder: Path, *, mended: bool = False) -> int:
    """Write the drawings to a folder, which is made; how many there are. `mended`: only the two."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [(name, drawing) for name, drawing in drawings(mended).items() if name in BROKEN or not mended]
    for name, drawing in files:
        drawing.write(folder / f"{name}.dxf")
    return len(files)


def main() -> None:
    """Read the command line, draw the nests, say what was drawn."""
    arguments = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    arguments.add_argument("folder", type=Path)
    arguments.add_argument("--mended", action="store_true", help="only the two that are broken, as they should be")
    options = arguments.parse_args()
    print(f"{draw(options.folder, mended=options.mended)} drawings in {options.folder}")


if __name__ == "__main__":
    main()
