"""A small sheet and programs for it written by hand, cut by cut: `from kerfwise.tests.metal.hand_made import …`.

The sheet: A (a plate with a round hole), B (a plate with a mark), 20 mm apart; the kerf is 2 mm.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from kerfwise import Nest
from kerfwise.rule_kit import circle, nest, part, rect

KERF_MM = 2.0
HALF = KERF_MM / 2
HEAD = ["(BY HAND)", "G21", "G64 P0.05", "G90 G17 G40 G49 G80 G91.1 G94", "M68 E3 Q0"]
TAIL = ["(HOME)", "G0 X0 Y0", "M68 E3 Q0", "M5 $-1", "M2", ""]
Blocks = Sequence[str]


def sheet() -> Nest:
    """A and B on a sheet of 200 × 100 mm."""
    a = part("A", rect(20, 20, 50, 50), [circle(45, 45, 8)])
    b = part("B", rect(90, 20, 50, 50), marks=[[(100, 30), (120, 30)]])
    return nest(200, 100, a, b)


def around(x: float, y: float, w: float, h: float, pierce: tuple[float, float], off: float = HALF) -> Blocks:
    """Clockwise round a rectangle, `off` mm outside it, from the middle of its left side."""
    x0, y0, x1, y1, r = x - off, y - off, x + w + off, y + h + off, off
    middle = f"X{x0} Y{y + h / 2}"
    return [
        f"G0 X{pierce[0]} Y{pierce[1]}", "M3 $0 S1", f"G1 {middle} F2500",
        f"G1 X{x0} Y{y + h}", f"G2 X{x} Y{y1} I{r} J0", f"G1 X{x + w} Y{y1}", f"G2 X{x1} Y{y + h} I0 J-{r}",
        f"G1 X{x1} Y{y}", f"G2 X{x + w} Y{y0} I-{r} J0", f"G1 X{x} Y{y0}", f"G2 X{x0} Y{y} I0 J{r}",
        f"G1 {middle}", "M5 $0",
    ]  # fmt: skip


def inside(cx: float, cy: float, radius: float, pierce: tuple[float, float]) -> Blocks:
    """Counter-clockwise round the inside of a round hole, from its right, then 1 mm again."""
    r = radius - HALF
    return [
        f"G0 X{pierce[0]} Y{pierce[1]}", "M3 $0 S1", "G4 P0.5", f"G1 X{cx + r} Y{cy} F2500",
        f"G3 X{cx + r} Y{cy} I-{r} J0", f"G3 X{cx + r * 0.98979852:.4f} Y{cy + r * 0.14247510:.4f} I-{r} J0", "M5 $0",
    ]  # fmt: skip


def straight(*points: tuple[float, float], tool: int = 0) -> Blocks:
    """The tool from point to point."""
    (x, y), *rest = points
    moves = [f"G1 X{a} Y{b} F2500" for a, b in rest]
    return [f"G0 X{x} Y{y}", f"M3 ${tool} S1", *moves, f"M5 ${tool}"]


MARK = straight((100, 30), (120, 30), tool=1)
HOLE = inside(45, 45, 8, (45, 45))
A = around(20, 20, 50, 50, (14, 45))
B = around(90, 20, 50, 50, (80, 45))
CUTS: tuple[tuple[str, Blocks], ...] = (("B.mark1", MARK), ("A.hole1", HOLE), ("A.outer", A), ("B.outer", B))
"""Nothing is wrong with these."""


def program(cuts: Iterable[tuple[str, Blocks]] = CUTS, first: int = 1, head: Iterable[str] = ()) -> str:
    """The program of named cuts, numbered from `first`."""
    body: list[str] = []
    for order, (name, blocks) in enumerate(cuts, first):
        word = "MARK" if ".mark" in name else "CUT"
        body += [f"({word} {order} {name} ZONE 1 CW)", *blocks]
    lines = [*HEAD[:1], *head, *HEAD[1:], *body, *TAIL]
    return "\n".join(lines)


def with_cut(name: str, blocks: Blocks) -> str:
    """The faultless program, but for one cut."""
    return program((n, blocks if n == name else own) for n, own in CUTS)
