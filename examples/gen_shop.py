"""Draw the twelve parts of a shop's list as DXF, one of them broken: the same bytes each time.

docs/tutorial-shop.md leads through them.

Usage: python examples/gen_shop.py FOLDER
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from ezdxf.addons import r12writer

Point = tuple[float, float]

BROKEN = "lid"
"""Its outline is open by 20 mm."""


def rectangle(width: float, height: float) -> list[Point]:
    """A rectangle from the origin."""
    return [(0, 0), (width, 0), (width, height), (0, height)]


def ell(size: float, arm: float) -> list[Point]:
    """An L of two arms."""
    return [(0, 0), (size, 0), (size, arm), (arm, arm), (arm, size), (0, size)]


def polygon(sides: int, radius: float) -> list[Point]:
    """A regular polygon around (radius, radius)."""
    turns = [2 * math.pi * k / sides for k in range(sides)]
    return [(round(radius + radius * math.cos(t), 3), round(radius + radius * math.sin(t), 3)) for t in turns]


PARTS: dict[str, tuple[list[Point], list[tuple[Point, float]]]] = {
    "base": (rectangle(180, 120), [((30, 30), 12), ((150, 30), 12), ((150, 90), 12), ((30, 90), 12)]),
    "bracket": (ell(100, 40), [((20, 80), 10), ((80, 20), 10)]),
    "cheek": ([(0, 0), (120, 0), (90, 90), (30, 90)], [((60, 40), 20)]),
    "cover": (rectangle(140, 90), [((70, 45), 15)]),
    "foot": (rectangle(90, 60), [((45, 30), 13)]),
    "gusset": ([(0, 0), (80, 0), (0, 80)], []),
    "hub": (polygon(24, 50), [((50, 50), 22)]),
    "lid": (rectangle(130, 100), []),
    "lug": ([(0, 0), (60, 0), (60, 40), (40, 70), (20, 70), (0, 40)], [((30, 45), 12)]),
    "rail": (rectangle(220, 40), [((25, 20), 11), ((195, 20), 11)]),
    "rib": ([(0, 0), (150, 0), (150, 30), (0, 70)], []),
    "washer": (polygon(18, 35), [((35, 35), 14)]),
}
"""Name → outline, and holes as centre and radius."""


def draw(folder: Path) -> int:
    """Write the drawings; how many they are."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, (outline, holes) in PARTS.items():
        with r12writer(str(folder / f"{name}.dxf")) as dxf:
            gap = name == BROKEN
            (x, y), (to_x, to_y) = outline[-1], outline[0]
            short = [(x + (to_x - x) * 0.8, y + (to_y - y) * 0.8)] if gap else []
            dxf.add_polyline_2d([*outline, *short], layer="CUT", closed=not gap)
            for centre, radius in holes:
                dxf.add_circle(centre, radius, layer="CUT")
    return len(PARTS)


def main() -> None:
    """Draw into the folder that is named."""
    parser = argparse.ArgumentParser(description="Draw the twelve parts of a shop's list as DXF.")
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    print(f"{draw(folder)} drawings in {folder}")


if __name__ == "__main__":
    main()
