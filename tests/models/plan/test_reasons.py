"""The short reasons in a plan: what holds a cut, and its entry where it is the shortest way on."""

from __future__ import annotations

import math

from kerfwise.rules.case import nest, part, rect
from kerfwise.tests.models.solved import plant, proven_plan

PLATE = nest(400, 100, *(part(f"P{k}", rect(100 * k - 90, 10, 80, 80)) for k in (1, 2, 3)))


def test_the_nearest_order_each_way_and_the_entry() -> None:
    _, _, plan = proven_plan(PLATE, plant())
    assert [p.cut.contour for p in plan.cuts] == ["P1.outer", "P2.outer", "P3.outer"]
    tail = "and would be left on an island behind the torch"
    x, y = plan.cuts[1].cut.entry
    assert plan.cuts[1].because == (
        f"P1.outer is cut before P2.outer: it lies between P2.outer and the left side, where cutting starts, {tail}",
        f"P2.outer is cut before P3.outer: it lies between P3.outer and the left side, where cutting starts, {tail}",
        f"entered at ({x:.1f}, {y:.1f}): the shortest lawful way from P1.outer to P3.outer",
    )


def test_the_entry_is_the_shortest_where_it_is_said() -> None:
    facts, _, plan = proven_plan(PLATE, plant())
    cuts = [p.cut for p in plan.cuts]
    said = 0
    for k, planned in enumerate(plan.cuts):
        leave = cuts[k - 1].end if k else (0.0, 0.0)
        reach = cuts[k + 1].pierce if k + 1 < len(cuts) else (0.0, 0.0)
        span = facts.candidates_of(facts.nest.index[planned.cut.contour])
        ways = [
            math.dist(leave, c.pierce) + math.dist(c.end, reach) for c in (facts.candidates[number] for number in span)
        ]
        here = math.dist(leave, planned.cut.pierce) + math.dist(planned.cut.end, reach)
        told = planned.because[-1].startswith("entered at")
        said += told
        assert told == (here <= min(ways) + 1e-6)
    assert said
