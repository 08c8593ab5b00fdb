"""Made nests with bevels: each seed a sheet of parts whose contours have bevels of all kinds, and a plant for it."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from typing import Any

from kerfwise import Nest, Profile
from kerfwise.encoder.bevels.bevel import Bevel, EdgeBevel
from kerfwise.rule_kit import Contour, Curve, Part, Sheet
from kerfwise.rules.profile.load import load_profile

Rows = list[tuple[float, ...]]


def made_for_block(seed: int) -> tuple[Nest, Profile]:
    """Polygons with one bevel, for a block of torches, with room for its loops."""
    dice = random.Random(f"block {seed}")
    nest, profile = made_nest(seed)
    thickness = profile.material.thickness_mm
    bevel = _bevel(dice, thickness)
    parts = []
    for k in range(dice.choice([1, 2])):
        count, x, y = dice.randint(3, 6), 450.0 + 700 * k, 450.0
        turn, radius = dice.uniform(0, math.tau), dice.uniform(90, 140)
        at = [turn + math.tau * (j + dice.uniform(0.0, 0.25)) / count for j in range(count)]
        rows = [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in at]
        parts.append(Part(f"P{k}", Contour(f"P{k}.outer", f"P{k}", "outer", Curve.of(rows), bevel=bevel)))
    plain = Contour("Q.outer", "Q", "outer", Curve.of([(60, 60), (160, 60), (160, 120), (60, 120)]))
    parts.append(Part("Q", plain))
    left = dice.choice(["top", "bottom"])
    section = replace(profile.cuts.bevel, head="block", left=left, apart_mm=dice.choice([30.0, 45.0]))  # type: ignore
    nest = Nest(Sheet.rectangle(1700.0, 900.0), tuple(parts), file=f"block-{seed}.json")
    return nest, replace(profile, cuts=replace(profile.cuts, bevel=section))


def made_nest(seed: int, edges: bool = False) -> tuple[Nest, Profile]:
    """The nest of a seed, and the profile that it is cut by; with `edges` single edges have bevels of their own."""
    dice = random.Random(seed)
    thickness = dice.choice([8.0, 12.0, 20.0, 30.0])
    cell = 180.0 + 6 * thickness
    columns, rows = dice.choice([(1, 1), (2, 1), (2, 2)])
    parts = []
    for k in range(columns * rows):
        x, y = cell * (k % columns + 0.5), cell * (k // columns + 0.5)
        parts.append(_part(f"P{k + 1}", (x, y), dice, thickness))
    profile = load_profile()
    holes = replace(profile.small_holes, min_hole=2.0)
    machine = replace(profile.machine, dialect="linuxcnc", cut_feed_mm_s=dice.choice([10.0, 20.0]))
    kerf = dice.choice([1.6, 2.0, 2.6])
    bevel: dict[str, Any] = {
        "head": "tilting",
        "kerfs": dice.choice([(), ((30.0, kerf + 0.2), (45.0, kerf + 0.5))]),
        "corner": dice.choice(["either", "turn"]),
        "run_mm": dice.choice([3.0, 5.0]),
        "lies_still": 0.1,
        "most_turn": 720.0,
    }
    cuts = replace(profile.cuts, bevel=replace(profile.cuts.bevel, **bevel))
    material = replace(profile.material, thickness_mm=thickness, kerf_mm=kerf)
    if edges:
        parts = [replace(p, outer=_edged(p.outer, dice), holes=tuple(_edged(h, dice) for h in p.holes)) for p in parts]
    nest = Nest(Sheet.rectangle(columns * cell, rows * cell), tuple(parts), file=f"made-{seed}.json")
    return nest, replace(profile, machine=machine, cuts=cuts, material=material, small_holes=holes)


def _part(name: str, middle: tuple[float, float], dice: random.Random, thickness_mm: float) -> Part:
    size = 110.0
    outer = Contour(f"{name}.outer", name, "outer", Curve.of(_outline(middle, size, dice)))
    holes = []
    if thickness_mm <= 20 and dice.random() < 0.4 and outer.polygon.area > 0.9 * outer.polygon.convex_hull.area:
        middle = outer.polygon.centroid.x, outer.polygon.centroid.y
        hole = Curve.of(_outline(middle, 36.0, dice, plain=True))
        holes.append(Contour(f"{name}.hole1", name, "hole", hole))
    if dice.random() < 0.85 or not holes:
        outer = replace(outer, bevel=_bevel(dice, thickness_mm))
    if holes and dice.random() < 0.5 and thickness_mm < 20:
        holes[0] = replace(holes[0], bevel=_bevel(dice, thickness_mm))
    return Part(name, outer, tuple(holes))


def _edged(contour: Contour, dice: random.Random) -> Contour:
    """The contour with its bevel on some edges, and perhaps another on some more."""
    bevel, segments = contour.bevel, contour.curve.segments
    if bevel is None or len(segments) < 3:
        return contour
    other = Bevel("V", dice.choice([20.0, 30.0]), 0.0, dice.choice(["top", "bottom"]))  # type: ignore[arg-type]
    made = []
    for segment in segments:
        if (one := dice.choice([bevel, bevel, other, None, None])) is not None:
            edge = Curve.of([(*segment.start, segment.bulge), segment.end], closed=False)
            made.append(EdgeBevel(one, edge))
    return replace(contour, bevel=None, edge_bevels=tuple(made)).with_one_bevel


def _bevel(dice: random.Random, thickness_mm: float) -> Bevel:
    kind, angle = dice.choice(["V", "V", "X", "Y", "K"]), dice.choice([15.0, 22.5, 30.0, 37.5, 45.0])
    land = round(thickness_mm * dice.choice([0.2, 0.4]), 2) if kind in ("Y", "K") else 0.0
    side = dice.choice(["top", "bottom"]) if kind in ("V", "Y") else None
    return Bevel(kind, min(angle, 30.0) if thickness_mm == 30 else angle, land, side)  # type: ignore[arg-type]


def _outline(middle: tuple[float, float], size: float, dice: random.Random, plain: bool = False) -> Rows:
    """A rectangle, a circle, a polygon, one with a round end, or an angle, turned somehow, about a middle."""
    half, shape = size / 2, dice.choice(["rectangle", "circle", "polygon", "round"] + ([] if plain else ["angle"]))
    rows: Rows
    match shape:
        case "rectangle":
            wide = half * dice.uniform(0.6, 1.0)
            rows = [(-wide, -half), (wide, -half), (wide, half), (-wide, half)]
        case "circle":
            rows = [(-half, 0.0, 1.0), (half, 0.0, 1.0)]
        case "polygon":
            count = dice.randint(3, 8)
            turns = [math.tau * k / count for k in range(count)]
            rows = [(half * math.cos(a), half * math.sin(a)) for a in turns]
        case "round":
            wide = half * 0.7
            rows = [(-wide, -half), (wide, -half), (wide, 0.2 * half, 1.0), (-wide, 0.2 * half)]
        case _:
            rows = [(-half, -half), (half, -half), (half, 0.0), (0.0, 0.0), (0.0, half), (-half, half)]
    angle = dice.choice([0.0, 0.0, dice.uniform(0.0, math.tau)])
    cos, sin = math.cos(angle), math.sin(angle)
    return [(middle[0] + x * cos - y * sin, middle[1] + x * sin + y * cos, *more) for x, y, *more in rows]
