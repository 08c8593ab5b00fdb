"""Programs written by hand from straight lines, one burn each: `from kerfwise.tests.postproc.by_lines import …`."""

from __future__ import annotations

from collections.abc import Sequence

from kerfwise import Nest, Profile
from kerfwise.rule_kit import nest, part, rect
from kerfwise.tests.postproc.plans import KERF_MM

Line = Sequence[tuple[float, float]]
HEAD = ("G21", "G64 P0.05", "G90 G17 G40 G49 G80 G91.1 G94")
W, H, AT = 60.0, 40.0, 30.0
"""Width and height of the rectangles of a grid, and where the lower left one has its corner."""


def program_of(burns: Sequence[Line], profile: Profile) -> str:
    """A program that burns lines one after the other."""
    feed = profile.machine.cut_feed_mm_s * 60
    blocks = list(HEAD)
    for (x, y), *rest in burns:
        blocks += [f"G0 X{x:.4f} Y{y:.4f}", "M3 $0 S1", f"G4 P{profile.machine.pierce_time_s:g}"]
        blocks += [f"G1 X{u:.4f} Y{v:.4f} F{feed:g}" for u, v in rest]
        blocks.append("M5 $0")
    return "\n".join([*blocks, "G0 X0 Y0", "M5 $-1", "M2", ""])


def grid(columns: int, rows: int) -> Nest:
    """Rectangles one kerf apart, column by column from the lower left one on: P1 to P(columns · rows)."""
    places = [(i, j) for i in range(columns) for j in range(rows)]
    parts = [
        part(f"P{k}", rect(AT + i * (W + KERF_MM), AT + j * (H + KERF_MM), W, H)) for k, (i, j) in enumerate(places, 1)
    ]
    return nest(2 * AT + columns * (W + KERF_MM), 2 * AT + rows * (H + KERF_MM), *parts)


def across(columns: int, row: int) -> Line:
    """The line below a row of a grid, from left to right."""
    y = AT - KERF_MM / 2 + row * (H + KERF_MM)
    return [(AT - KERF_MM / 2, y), (AT - KERF_MM / 2 + columns * (W + KERF_MM), y)]


def upright(rows: int, column: int) -> Line:
    """The line left of a column of a grid, from its lower end up."""
    x = AT - KERF_MM / 2 + column * (W + KERF_MM)
    return [(x, AT - KERF_MM / 2), (x, AT - KERF_MM / 2 + rows * (H + KERF_MM))]
