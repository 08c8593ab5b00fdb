"""Random orders: parts of many shapes, sheets and remnants, distances."""

from __future__ import annotations

import math
import random

from kerfwise.apps.nesting.placement.demand import QUARTERS, Common, Demand, PartType, Spacing, Stock
from kerfwise.rule_kit import Curve, Part, Sheet, circle, part, rect

EIGHTHS = tuple(45.0 * k for k in range(8))


def random_order(seed: int) -> tuple[Demand, Spacing]:
    """An order of a few part types, and how far parts lie apart; touching ones, and common edges, sometimes."""
    chance = random.Random(seed)
    types = tuple(
        PartType(
            f"P{k}",
            _sound_part(f"P{k}", chance),
            chance.randint(1, 5),
            priority=chance.choice([1, 1, 2]),
            turns_deg=chance.choice([QUARTERS, (0.0,), (0.0, 180.0), EIGHTHS]),
            mirror=chance.random() < 0.3,
        )
        for k in range(chance.randint(2, 6))
    )
    stocks = [Stock("400x300", Sheet.rectangle(400, 300), chance.choice([1, 2, None]))]
    if chance.random() < 0.5:
        stocks.append(Stock("300x500", Sheet.rectangle(300, 500), 1, price=chance.uniform(10, 90)))
    if chance.random() < 0.5:
        stocks.append(Stock("rest", _remnant(chance), 1, remnant=True))
    gap_mm, edge_mm = chance.choice([0.0, 1.5, 6.0]), chance.choice([0.0, 5.0, 12.0])
    common = Common(0.3, 15.0) if gap_mm and chance.random() < 0.3 else None
    return Demand(types, tuple(stocks)), Spacing(gap_mm, edge_mm, common)


def _sound_part(name: str, chance: random.Random) -> Part:
    """One whose outline does not cross itself."""
    made = _part(name, chance)
    return made if made.polygon.is_valid else _sound_part(name, chance)


def _part(name: str, chance: random.Random) -> Part:
    w, h = chance.uniform(15, 130), chance.uniform(15, 130)
    match chance.randrange(6):
        case 0:
            return part(name, rect(0, 0, w, h), [circle(w / 2, h / 2, min(w, h) / 5)])
        case 1:
            return part(name, circle(0, 0, w / 2), [circle(0, 0, w / 2 - 4)], [[(-1, 0), (1, 1)]])
        case 2:
            a, b = chance.uniform(4, w - 4), chance.uniform(4, h - 4)
            return part(name, [(0, 0), (w, 0), (w, b), (a, b), (a, h), (0, h)])
        case 3:
            return part(name, [(0, 0), (w, 0), (0, h)])
        case 4:
            turns = sorted(chance.uniform(0, math.tau) for _ in range(chance.randint(5, 9)))
            return part(
                name, [(w * math.cos(t) * r, h * math.sin(t) * r) for t in turns for r in (chance.uniform(0.4, 0.6),)]
            )
        case _:
            return part(name, [(0, 0), (w, 0, 1.0), (w, h), (0, h, chance.choice([0.0, 0.4, -0.2]))])


def _remnant(chance: random.Random) -> Sheet:
    a, b = chance.uniform(80, 220), chance.uniform(60, 180)
    outline = Curve.of([(10, 20), (310, 20), (310, 20 + b), (10 + a, 20 + b), (10 + a, 270), (10, 270)])
    return Sheet(outline, (Curve.of(circle(60, 60, 15)),) if chance.random() < 0.5 else ())
