"""What a contour's place and entry have to do with metal that overheats: the prices, and which the plan keeps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import assert_never

from kerfwise.models.heat_prices.priced_statements import HEAT
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Before,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    NoGood,
    Precede,
    Statement,
)

from .setting import Setting


@dataclass(frozen=True, slots=True)
class HeatPrice:
    """An order or an entry that overheats less metal: whether the plan keeps it, and what breaking it costs, mm.

    `others` are the further contours that it is about: none where it matters in any order how this one is entered.
    """

    others: tuple[str, ...]
    kept: bool
    price_mm: float
    about: About


def heat_prices(setting: Setting, contour: int) -> tuple[HeatPrice, ...]:
    """The prices of heat that are about a contour, the highest first.

    What is asked of one contour's cut while two others are out, or are not, is told of that one and not of the two.
    What is asked of an entry while another contour is out is told where the plan uses that entry.
    """
    found: dict[About, HeatPrice] = {}  # candidates that are no different share theirs
    for s in setting.stated.statements:
        if s.weight is None or s.about.rule != HEAT or setting.name(contour) not in s.about.contours:
            continue
        kept = _kept(setting, s, contour)
        if kept is not None:
            others = tuple(name for name in s.about.contours if name != setting.name(contour))
            found[s.about] = HeatPrice(others, kept, s.weight, s.about)
    return tuple(sorted(found.values(), key=lambda price: -price.price_mm))


def _kept(setting: Setting, statement: Statement, contour: int) -> bool | None:
    """Whether the plan keeps it; None where it asks nothing of how this contour is cut."""
    place = {contour: k for k, contour in enumerate(setting.order)}
    site_of = setting.problem.candidate_site
    match statement:
        case Precede(before, after):
            return place[before] < place[after]
        case Forbid(candidate):
            return int(site_of[candidate]) not in setting.route if site_of[candidate] >= 0 else None
        case AtLeast():
            orders = [x for x in statement.literals if isinstance(x, Before) and contour in (x.i, x.j)]
            unused = statement.when is not None and int(site_of[statement.when]) not in setting.route
            if unused or len(orders) < len(statement.literals):
                return None
            true = (w for x, w in zip(orders, statement.weights, strict=True) if place[x.i] < place[x.j])
            return sum(true) >= statement.bound
        case Contiguous() | Lag() | NoGood() | Crossing() | IdleTravel() | Link():
            return None  # no price of heat is one of them
        case _:
            assert_never(statement)
