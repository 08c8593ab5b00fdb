"""Lists of parts for the benchmark of nesting, the same for the same seed, and what a layout costs at least."""

from __future__ import annotations

import math
import random

import numpy as np
import shapely
from scipy.optimize import Bounds, LinearConstraint, milp

from kerfwise.apps.nesting.placement.demand import Demand, PartType, Spacing, Stock
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.nest import Part, Sheet
from kerfwise.rules.case import Rows, circle, part, rect


def shape(name: str, chance: random.Random, size_mm: float) -> Part:
    """A part as shops have them: plates, brackets, gussets, flanges, frames, channels, arms with round ends."""
    w, h = size_mm * chance.uniform(0.5, 1.2), size_mm * chance.uniform(0.3, 1.0)
    r = min(w, h)
    match chance.randrange(7):
        case 0:
            bore = max(r / 12, 4)
            return part(name, rect(0, 0, w, h), [circle(r / 4, r / 4, bore), circle(w - r / 4, h - r / 4, bore)])
        case 1:
            a, b = w * chance.uniform(0.25, 0.5), h * chance.uniform(0.25, 0.5)
            return part(
                name, [(0, 0), (w, 0), (w, b), (a, b), (a, h), (0, h)], [circle(a / 2, b / 2, max(min(a, b) / 5, 4))]
            )
        case 2:
            return part(name, [(0, 0), (w, 0), (w, h / 4), (w / 4, h), (0, h)])
        case 3:
            return part(name, circle(0, 0, r / 2), [circle(0, 0, r / 2 * chance.uniform(0.3, 0.7))])
        case 4:
            t = max(r * 0.12, 8)
            return part(name, rect(0, 0, w, h), [rect(t, t, w - 2 * t, h - 2 * t)])
        case 5:
            t = max(r * 0.25, 8)
            return part(name, [(0, 0), (w, 0), (w, h), (w - t, h), (w - t, t), (t, t), (t, h), (0, h)])
        case _:
            return part(name, [(0, 0), (w, 0, 1.0), (w, h / 2), (0, h / 2, 1.0)], [circle(0, h / 4, max(h / 12, 4))])


def day_list(seed: int = 1, types: int = 60, parts: int = 600) -> Demand:
    """A day of a shop: so many part types and parts, three sizes of sheets, two remnants."""
    chance = random.Random(seed)
    sizes = [math.exp(chance.uniform(math.log(60), math.log(500))) for _ in range(types)]
    counts = [1] * types
    for _ in range(parts - types):
        counts[min(range(types), key=lambda k: (chance.random() * sizes[k], k))] += 1
    kinds = tuple(PartType(f"P{k + 1}", shape(f"P{k + 1}", chance, sizes[k]), counts[k]) for k in range(types))
    return Demand(kinds, (*sheets(), *remnants()))


def sheets() -> tuple[Stock, ...]:
    """Three sizes, as many as it takes."""
    return tuple(
        Stock(f"{w}x{h}", Sheet.rectangle(w, h), price=round(w * h / 1e6 * per_m2, 2))
        for w, h, per_m2 in ((3000, 1500, 60.0), (2500, 1250, 62.0), (2000, 1000, 65.0))
    )


def remnants() -> tuple[Stock, ...]:
    """An L and a plate with a window."""
    ell = [(0, 0), (1800, 0), (1800, 500), (700, 500), (700, 1200), (0, 1200)]
    window: Rows = rect(300, 300, 250, 250)
    return (
        Stock("rest-l", Sheet(Curve.of(ell)), 1, remnant=True),
        Stock("rest-window", Sheet(Curve.of(rect(0, 0, 900, 800)), (Curve.of(window),)), 1, remnant=True),
    )


def furniture() -> tuple[PartType, ...]:
    """Parts as of a piece of furniture: rails, sides, shelves, tapered legs, brackets, slats with round ends, feet."""
    made = (
        (part("side", [(0, 0), (420, 0), (420, 780), (60, 780), (0, 720)]), 8),
        (part("shelf", rect(0, 0, 560, 300)), 14),
        (part("rail", rect(0, 0, 560, 70)), 36),
        (part("leg", [(0, 0), (30, 0), (70, 420), (0, 420)]), 48),
        (part("bracket", [(0, 0), (140, 0), (0, 110)]), 60),
        (part("arm", [(0, 0), (260, 0), (260, 60), (60, 60), (60, 200), (0, 200)]), 24),
        (part("slat", [(30, 0), (370, 0, 1.0), (370, 60), (30, 60, 1.0)]), 40),
        (part("foot", [(0, 0), (120, 0), (95, 70), (25, 70)]), 48),
        (part("brace", [(0, 0), (50, 0), (290, 240), (240, 240)]), 30),
        (part("knob", circle(0, 0, 22)), 40),
        (part("block", rect(0, 0, 60, 45)), 80),
        (part("wedge", [(0, 0), (80, 0), (80, 12), (0, 30)]), 60),
    )
    return tuple(PartType(shape.id, shape, count) for shape, count in made)


def cutting_list(seed: int) -> Demand:
    """A small list, for layouts that are planned as they are weighed."""
    chance = random.Random(seed)
    kinds = tuple(
        PartType(f"P{k + 1}", shape(f"P{k + 1}", chance, chance.uniform(90, 260)), chance.randint(2, 5))
        for k in range(5)
    )
    return Demand(kinds, (Stock("1500x1000", Sheet.rectangle(1500, 1000)),))


def least_worth(wanted: Demand, spacing: Spacing) -> float:
    """The least that whole sheets are worth, remnants for nothing, on which all parts would fit if they were liquid.

    Half the gap lies around each part, in its holes too, and no two parts share any of it. A knapsack, solved by HiGHS.
    Infinite where all that there is would be too little.

    Examples
    --------
    Four squares of 46 mm, 4 mm apart, need all of a sheet of 100 mm, and a fifth needs another one:

    >>> from kerfwise.rules.case import part, rect
    >>> from kerfwise.apps.nesting.placement.demand import PartType, Stock
    >>> square, sheets = part("A", rect(0, 0, 46, 46)), (Stock("100x100", Sheet.rectangle(100, 100), price=7.0),)
    >>> [least_worth(Demand((PartType("A", square, n),), sheets), Spacing(4.0, 2.0)) for n in (4, 5)]
    [7.0, 14.0]
    """
    needed_mm2 = sum(kind.quantity * _taken_mm2(kind.part, spacing) for kind in wanted.types)
    ground_mm2 = np.array([_ground_mm2(stock.sheet, spacing) for stock in wanted.stocks])
    worth = np.array([0.0 if stock.remnant else stock.worth for stock in wanted.stocks])
    most = [math.inf if stock.count is None else stock.count for stock in wanted.stocks]
    enough = LinearConstraint(ground_mm2[None, :] / needed_mm2, lb=1.0 - 1e-9)
    whole, exact = np.ones(len(worth)), {"mip_rel_gap": 0.0}
    found = milp(worth, integrality=whole, bounds=Bounds(0, most), constraints=enough, options=exact)
    return round(float(found.fun), 3) if found.success else math.inf


def _taken_mm2(part: Part, spacing: Spacing) -> float:
    """Within half a gap of the part's metal."""
    return float(part.polygon.buffer(spacing.gap_mm / 2).area)


def _ground_mm2(sheet: Sheet, spacing: Spacing) -> float:
    """Within half a gap of where metal of parts may be."""
    metal: shapely.Geometry = sheet.polygon.buffer(-spacing.edge_mm)
    return float(metal.buffer(spacing.gap_mm / 2, join_style="mitre").area)


def usable_area_mm2(width_mm: float, height_mm: float, margins_mm: tuple[float, float], half_kerf_mm: float) -> float:
    """Pavlov's (D - 2 l_D + δ)(E - 2 l_E + δ): what a sheet D × E gives, with margins l and a kerf of 2 δ.

    Examples
    --------
    >>> usable_area_mm2(1500.0, 1000.0, (10.0, 5.0), 0.35)
    1466064.6225
    """
    across, up = margins_mm
    return (width_mm - 2 * across + half_kerf_mm) * (height_mm - 2 * up + half_kerf_mm)
