"""Made nests for the simulation, by seed: what packs tightly, what is narrow, what lies in each other.

The families take turns; gaps run from 0 to 10 mm, slots from 0.5 to 3 mm. Some cannot be cut lawfully with a given
kerf: a planner has to say so.
"""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from kerfwise.examples.gen_sheet import make_sheet
from kerfwise.tests.metal.narrow_nests import narrow_nest

GAPS_MM = (0.0, 0.01, 0.5, 1.0, 1.39, 1.5, 1.6, 2.0, 2.3, 2.6, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0)
SLOTS_MM = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
NARROW_FROM = 10_000
HOLES_MM = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0)
Row = tuple[float, ...]
Rows = list[Row]
Part = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Made:
    """A made nest: its family, what was drawn for it, and the file (kerfwise-nest/1) as a dictionary."""

    seed: int
    family: str
    drawn: str
    file: dict[str, Any]

    @property
    def contours(self) -> int:
        """How many contours it has."""
        return sum(1 + len(p.get("holes", ())) + len(p.get("marks", ())) for p in self.file["parts"])

    @property
    def text(self) -> str:
        """The file's text."""
        return json.dumps(self.file)


def made(seed: int, gap_mm: float | None = None) -> Made:
    """The nest of a seed: the same for the same seed. From `NARROW_FROM` on they are plates with narrow slots.

    `gap_mm` is the gap between its parts, mm, in place of the one that is drawn.
    """
    rnd = random.Random(seed)
    if seed >= NARROW_FROM:
        return Made(seed, "narrow", "slots of 0.1 to 2 mm", narrow_nest(rnd))
    family = list(FAMILIES)[seed % len(FAMILIES)]
    gap, slot = rnd.choice(GAPS_MM), rnd.choice(SLOTS_MM)
    gap = gap if gap_mm is None else gap_mm
    if family == "mixed":
        web_mm = max(gap, 1.0) if gap_mm is None else gap
        file = make_sheet(seed, rnd.randint(6, 14), (rnd.choice([700.0, 1000.0]), 500.0), web_mm)
    else:
        file = _file(FAMILIES[family](rnd, gap, slot), rnd)
    return Made(seed, family, f"gap {gap:g} mm, slot {slot:g} mm", file)


def _file(parts: Sequence[Part], rnd: random.Random) -> dict[str, Any]:
    """A sheet round the parts with a margin; the parts as wide as drawn, to 0.001 mm."""
    margin = rnd.choice([5.0, 10.0, 15.0, 30.0])
    reach = [(row[0] + s, row[1] + s) for p in parts for row in p["outer"] for s in (0.0, p.pop("bulge_mm", 0.0))]
    width, height = max(x for x, _ in reach), max(y for _, y in reach)
    moved = [_moved(p, margin) for p in parts]
    sheet = {"width": round(width + 2 * margin, 3), "height": round(height + 2 * margin, 3)}
    return {"format": "kerfwise-nest/1", "units": "mm", "sheet": sheet, "parts": moved}


def _moved(part: Part, by_mm: float) -> Part:
    def rows(contour: Rows) -> list[list[float]]:
        return [[round(x + by_mm, 3), round(y + by_mm, 3), *bulge] for x, y, *bulge in contour]

    lists = {key: [rows(c) for c in part[key]] for key in ("holes", "marks") if part.get(key)}
    return {"id": part["id"], "outer": rows(part["outer"]), **lists}


def rect(x: float, y: float, w: float, h: float) -> Rows:
    """A rectangle's corners."""
    return [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]


def disc(cx: float, cy: float, r: float) -> Rows:
    """A circle as four quarter arcs, so that its corners reach as far as it does."""
    q = math.tan(math.pi / 8)
    return [(cx - r, cy, q), (cx, cy - r, q), (cx + r, cy, q), (cx, cy + r, q)]


def _grid(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Plates in rows and columns, streets that cross."""
    columns, rows = rnd.choice([(2, 2), (3, 2), (4, 2), (3, 3), (4, 3), (6, 1)])
    w, h = rnd.choice([20.0, 40.0, 60.0]), rnd.choice([20.0, 40.0, 80.0])
    return [
        {"id": f"P{i}{j}", "outer": rect(i * (w + gap), j * (h + gap), w, h)}
        for i in range(columns)
        for j in range(rows)
    ]


def _bricks(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Plates of several lengths in rows, streets that end on each other."""
    parts: list[Part] = []
    for row in range(rnd.randint(2, 3)):
        x = 0.0
        for k in range(rnd.randint(2, 4)):
            w = rnd.choice([25.0, 40.0, 70.0])
            parts.append({"id": f"R{row}{k}", "outer": rect(x, row * (30 + gap), w, 30)})
            x += w + gap
    return parts


def _discs(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Discs in rows or in a honeycomb, some with a hole."""
    r, columns, rows = rnd.choice([8.0, 15.0, 30.0]), rnd.randint(2, 4), rnd.randint(1, 3)
    pitch, comb = 2 * r + gap, rnd.random() < 0.5
    up = pitch * (math.sqrt(0.75) if comb else 1)
    return [
        {
            "id": f"D{i}{j}",
            "outer": disc(r + i * pitch + (pitch / 2 if comb and j % 2 else 0), r + j * up, r),
            "holes": [disc(r + i * pitch + (pitch / 2 if comb and j % 2 else 0), r + j * up, r * 0.4)]
            if (i + j) % 3 == 0
            else [],
        }
        for i in range(columns)
        for j in range(rows)
    ]


def _frames(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Frames in frames, each as far from the next as the gap."""
    web, size = rnd.choice([6.0, 10.0, 20.0]), rnd.choice([120.0, 200.0])
    parts: list[Part] = []
    at, side = 0.0, size
    for k in range(rnd.randint(2, 4)):
        inner = side - 2 * web
        if inner < 20:
            break
        parts.append(
            {"id": f"F{k}", "outer": rect(at, at, side, side), "holes": [rect(at + web, at + web, inner, inner)]}
        )
        at, side = at + web + gap, inner - 2 * gap
    if side > 10:
        parts.append({"id": "core", "outer": rect(at, at, side, side)})
    return parts


def _rings(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Rings in rings about one centre."""
    r, web = rnd.choice([50.0, 90.0]), rnd.choice([6.0, 12.0])
    centre, parts = r, []
    for k in range(rnd.randint(2, 4)):
        if r - web < 8:
            break
        parts.append({"id": f"K{k}", "outer": disc(centre, centre, r), "holes": [disc(centre, centre, r - web)]})
        r -= web + gap
    return parts


def _slotted(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Plates with a slot or a notch in the outer contour, and a long narrow hole."""
    parts = []
    for k in range(rnd.randint(1, 4)):
        x, depth = k * (80 + gap), rnd.choice([3.0, 20.0, 40.0])
        a, b = 20 - slot / 2, 20 + slot / 2
        outer = [(0, 0), (80, 0), (80, a), (80 - depth, a), (80 - depth, b), (80, b), (80, 60), (0, 60)]
        holes = [rect(x + 10, 40, 50, rnd.choice(SLOTS_MM))] if rnd.random() < 0.4 else []
        parts.append({"id": f"S{k}", "outer": [(x + u, v) for u, v in outer], "holes": holes})
    return parts


def _reliefs(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Sheet-metal blanks: corners cut out, with a bend relief beside each."""
    parts = []
    for k in range(rnd.randint(1, 3)):
        x, s = k * (100 + gap), slot
        outer = [
            (15, 0),
            (85, 0),
            (85, 15),
            (85 - s, 15),
            (85 - s, 18),
            (85, 18),
            (100, 18),
            (100, 60),
            (0, 60),
            (0, 18),
        ]
        outer += [(15, 18), (15 + s, 18), (15 + s, 15), (15, 15)]
        parts.append({"id": f"B{k}", "outer": [(x + u, v) for u, v in outer]})
    return parts


def _holes(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Plates with holes from 1 mm up, some of them close to each other."""
    parts = []
    for k in range(rnd.randint(1, 3)):
        x, holes, at = k * (100 + gap), [], 8.0
        for _ in range(rnd.randint(1, 4)):
            d = rnd.choice(HOLES_MM)
            if at + d > 92:
                break
            holes.append(disc(x + at + d / 2, 20 + rnd.choice([0.0, 15.0]), d / 2))
            at += d + rnd.choice([2.0, 4.0, 10.0])
        parts.append({"id": f"H{k}", "outer": rect(x, 0, 100, 60), "holes": holes})
    return parts


def _hosts(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """A host with guests in its opening, as far from it and from each other as the gap."""
    columns, rows, w = rnd.randint(1, 3), rnd.randint(1, 2), rnd.choice([20.0, 35.0])
    inner_w, inner_h = columns * (w + gap) + gap, rows * (w + gap) + gap
    host = {"id": "host", "outer": rect(0, 0, inner_w + 30, inner_h + 30), "holes": [rect(15, 15, inner_w, inner_h)]}
    guests = [
        {"id": f"G{i}{j}", "outer": rect(15 + gap + i * (w + gap), 15 + gap + j * (w + gap), w, w), "holes": []}
        for i in range(columns)
        for j in range(rows)
    ]
    if rnd.random() < 0.5:
        guests[0]["holes"] = [disc(15 + gap + w / 2, 15 + gap + w / 2, w / 4)]
    return [host, *guests]


def _marked(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Plates with marks, open and closed ones."""
    parts = []
    for k in range(rnd.randint(2, 5)):
        x = k * (40 + gap)
        marks: list[Rows] = [[(x + 5, 8), (x + 30, 8)]]
        if rnd.random() < 0.5:
            marks.append([(x + 10, 20), (x + 20, 20, 0.4), (x + 20, 30)])
        holes = [disc(x + 30, 45, 5)] if rnd.random() < 0.5 else []
        parts.append({"id": f"M{k}", "outer": rect(x, 0, 40, 60), "holes": holes, "marks": marks})
    return parts


def _hooks(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Channels and brackets with a part in the mouth: narrow streets on three sides."""
    parts: list[Part] = []
    for k in range(rnd.randint(1, 3)):
        x, w = k * (90 + gap), 10.0
        guest_w, guest_h = 80 - w - gap, 60 - 2 * w - 2 * gap
        channel = [(0, 0), (80, 0), (80, w), (w, w), (w, 60 - w), (80, 60 - w), (80, 60), (0, 60)]
        if rnd.random() < 0.4:
            channel = [(0, 0), (80, 0), (80, w), (w, w), (w, 60), (0, 60)]
        parts.append({"id": f"C{k}", "outer": [(x + u, v) for u, v in channel]})
        parts.append({"id": f"G{k}", "outer": rect(x + w + gap, w + gap, guest_w, guest_h)})
    return parts


def _wedges(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """Triangles in pairs, long side to long side, and stars: sharp corners both ways."""
    parts: list[Part] = []
    slant = gap * math.hypot(60, 40) / 40
    for k in range(rnd.randint(1, 3)):
        x = k * (60 + slant + gap)
        parts.append({"id": f"A{k}", "outer": [(x, 0), (x + 60, 0), (x, 40)]})
        parts.append({"id": f"Z{k}", "outer": [(x + 60 + slant, 0), (x + 60 + slant, 40), (x + slant, 40)]})
    if rnd.random() < 0.5:
        points, r = rnd.choice([5, 8]), rnd.choice([0.5, 0.8])
        turn = [math.tau * k / (2 * points) for k in range(2 * points)]
        star = [(25 + 25 * math.cos(a) * (r if k % 2 else 1), 25 + 25 * math.sin(a) * (r if k % 2 else 1))
                for k, a in enumerate(turn)]  # fmt: skip
        parts.append({"id": "star", "outer": [(u, v + 40 + max(gap, 1.0)) for u, v in star]})
    return parts


def _lone(rnd: random.Random, gap: float, slot: float) -> list[Part]:
    """One part in the middle of a sheet: a disc, a flange with bolt holes, a square."""
    kind, r = rnd.choice(["disc", "flange", "square"]), rnd.choice([20.0, 60.0])
    if kind == "square":
        return [{"id": "Q", "outer": rect(0, 0, 2 * r, 2 * r)}]
    holes: list[Rows] = []
    if kind == "flange":
        count, d = rnd.choice([4, 6]), rnd.choice(HOLES_MM)
        turn = [math.tau * k / count for k in range(count)]
        holes = [
            disc(r, r, r * 0.4),
            *(disc(r + 0.75 * r * math.cos(a), r + 0.75 * r * math.sin(a), d / 2) for a in turn),
        ]
    return [{"id": "Q", "outer": disc(r, r, r), "holes": holes}]


FAMILIES: dict[str, Callable[[random.Random, float, float], list[Part]]] = {
    "grid": _grid,
    "bricks": _bricks,
    "discs": _discs,
    "frames": _frames,
    "rings": _rings,
    "slotted": _slotted,
    "reliefs": _reliefs,
    "holes": _holes,
    "hosts": _hosts,
    "marked": _marked,
    "hooks": _hooks,
    "wedges": _wedges,
    "lone": _lone,
    "mixed": _lone,  # made by the example's own generator
}
"""How each family is drawn: from the random source, the gap and the slot's width, mm."""
