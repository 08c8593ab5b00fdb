"""Prices of heat as an explanation tells them: of orders, of entries, and of what goes with what."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from kerfwise.encoder.facts import Facts
from kerfwise.models.heat_prices import HEAT
from kerfwise.models.plan.explain.explain import Explanation, as_text, explain
from kerfwise.models.plan.plan import Plan
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.statements import About, AtLeast, Before, Forbid, Precede, Statement
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.models.solved import plant, proven_plan

ROW = nest(310, 100, *(part(name, rect(10 + 100 * k, 10, 80, 80)) for k, name in enumerate("ABC")))
ORDER = ("A.outer", "B.outer", "C.outer")
FIRST, MIDDLE, LAST = range(3)


@cache
def made() -> tuple[Facts, Stated, Plan]:
    """The row, cut from the left."""
    facts, stated, plan = proven_plan(ROW, plant())
    assert tuple(planned.cut.contour for planned in plan.cuts) == ORDER
    return facts, stated, plan


def about(*contours: int) -> About:
    names = tuple(ORDER[k] for k in contours)
    return About(HEAT, names, f"{', '.join(names)} as asked")


def told(contour: int, *prices: Statement) -> Explanation:
    facts, stated, plan = made()
    priced = replace(stated, statements=(*stated.statements, *prices))
    return explain(facts, plant(), priced, plan, ORDER[contour])


def kept(contour: int, *prices: Statement) -> list[tuple[tuple[str, ...], bool, float]]:
    return [(p.others, p.kept, p.price_mm) for p in told(contour, *prices).heat]


def used(contour: int) -> int:
    """The candidate that the plan cuts the contour by."""
    facts, _, plan = made()
    pierce = plan.cuts[contour].cut.pierce
    return next(c for c in facts.candidates_of(contour) if facts.candidates[c].pierce == pierce)


def unused(contour: int) -> int:
    """Another one, elsewhere."""
    facts, _, plan = made()
    pierce = plan.cuts[contour].cut.pierce
    return next(c for c in facts.candidates_of(contour) if facts.candidates[c].pierce != pierce)


def test_orders() -> None:
    asked = [Precede(MIDDLE, LAST, about(MIDDLE, LAST), 120.0), Precede(LAST, MIDDLE, about(LAST, MIDDLE), 121.0)]
    last, middle = ORDER[2], ORDER[1]
    assert kept(MIDDLE, *asked) == [((last,), False, 121.0), ((last,), True, 120.0)]
    assert f"broken, costs 121 mm: {last}, {middle} as asked" in as_text(told(MIDDLE, *asked))
    assert kept(FIRST, *asked) == []


def test_entries() -> None:
    asked = [Forbid(used(MIDDLE), about(MIDDLE), 30.0), Forbid(unused(MIDDLE), about(MIDDLE, MIDDLE), 20.0)]
    assert kept(MIDDLE, *asked) == [((), False, 30.0), ((), True, 20.0)]
    assert kept(LAST, *asked) == []


def test_entries_while_another_is_out() -> None:
    """The plan has the first out when the middle one is cut."""
    here, there = used(MIDDLE), unused(MIDDLE)

    def while_out(i: int, j: int, c: int, weight: float) -> AtLeast:
        return AtLeast((Before(i, j),), (1,), 1, about(i, j), when=c, weight=weight)

    asked = [while_out(MIDDLE, FIRST, here, 50.0), while_out(MIDDLE, LAST, here, 40.0)]
    asked += [while_out(MIDDLE, FIRST, there, 9.0)]
    first, middle, last = ORDER
    assert kept(MIDDLE, *asked) == [((first,), False, 50.0), ((last,), True, 40.0)]
    assert kept(FIRST, *asked) == [((middle,), False, 50.0)]


def test_what_goes_with_what_is_told_of_the_contour_that_it_heats() -> None:
    both = AtLeast((Before(FIRST, LAST), Before(MIDDLE, LAST)), (1, 1), 2, about(FIRST, MIDDLE, LAST), weight=7.0)
    neither = AtLeast((Before(MIDDLE, FIRST), Before(MIDDLE, LAST)), (1, 1), 2, about(MIDDLE, FIRST, LAST), weight=6.0)
    assert kept(LAST, both, neither) == [((ORDER[0], ORDER[1]), True, 7.0)]
    assert kept(MIDDLE, both, neither) == [((ORDER[0], ORDER[2]), False, 6.0)]
    assert kept(FIRST, both, neither) == []


def test_what_has_no_price_or_is_no_heat_is_not_told() -> None:
    other = About("heat-lag", ("A.outer", "B.outer"), "another rule")
    assert kept(FIRST, Precede(FIRST, LAST, other, 5.0), Precede(FIRST, LAST, about(FIRST, LAST))) == []
