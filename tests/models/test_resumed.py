"""What is left after a stop: every engine finds its optimum; what is out is crossed at its price, from home too."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations, product
from math import dist

import pytest
import shapely

from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.facts.facts import Facts
from kerfwise.jobs.by_engine import Method
from kerfwise.jobs.request import facts_of, make_request
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.pipeline import solve_and_verify
from kerfwise.postproc.check import check_cuts
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.lock import Lock
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile

PLATE = nest(
    400,
    200,
    part("A", rect(10, 10, 80, 80), [rect(40, 40, 20, 20)]),
    part("B", rect(110, 10, 80, 80)),
    part("C", rect(210, 10, 80, 80)),
    part("D", rect(10, 110, 80, 80)),
    part("E", rect(110, 110, 80, 80)),
)
TIPS = """
name: tips
based_on: plasma-carbon-steel
leads: {entries: 2}
rules:
  level-ahead: off
  zone-order: off
  part-rigidity: off
  heat-lag: off
  no-tip-travel: {strength: soft, weight: 300}
"""


@pytest.fixture(scope="module")
def profile(tmp_path_factory: pytest.TempPathFactory) -> Profile:
    path = tmp_path_factory.mktemp("tips") / "tips.yaml"
    path.write_text(TIPS)
    return load_profile(str(path))


@pytest.fixture(scope="module")
def left(profile: Profile) -> Facts:
    first = (Lock(contour=name, position=k) for k, name in enumerate(("A.hole1", "A.outer", "B.outer"), 1))
    locked = replace(profile, locks=tuple(first))
    whole = solve_and_verify(make_request(facts_of(PLATE, locked), locked), locked, SolveOptions(work=2.0)).plan
    return facts_of(PLATE, profile, AlreadyCut(tuple(p.cut for p in whole.cuts[:3])))


def price_mm(facts: Facts, route: tuple[int, ...], home: tuple[float, float]) -> float:
    """Idle travel, and 300 mm for each part that it leads over when that is out."""
    used = [facts.candidates[c] for c in route]
    stops = [home, *(p for c in used for p in (c.pierce, c.end)), home]
    out = {cut.contour for cut in facts.already_cut}
    total = 0.0
    for k, (a, b) in enumerate(zip(stops[::2], stops[1::2], strict=True)):
        out |= {facts.nest.contours[c.contour].id for c in used[:k]}
        over = [p for p in PLATE.parts if p.outer.id in out]
        crossed = sum(shapely.LineString([a, b]).intersects(p.outer.polygon.buffer(-0.1)) for p in over)
        total += dist(a, b) + 300 * crossed
    return total


@pytest.mark.scrap("looks at travel alone")
@pytest.mark.parametrize("engine", ["portfolio", "search", "ideals", "cp-sat-alone"])
def test_every_engine_finds_the_best_of_all_ways_to_go_on(left: Facts, profile: Profile, engine: str) -> None:
    from kerfwise.models.engines import member_of

    assert [c.id for c in left.nest.contours] == ["C.outer", "D.outer", "E.outer"]
    ways = [[c for c in left.candidates_of(k) if left.candidates[c].direction == "cw"] for k in range(left.n)]
    orders = list(permutations(range(left.n)))
    best = min(price_mm(left, picked, (0.0, 0.0)) for order in orders for picked in product(*(ways[k] for k in order)))
    made = solve_and_verify(
        make_request(left, profile), profile, SolveOptions(work=0.5, member=member_of(engine)), Method(engine)
    )
    assert made.plan.solve.objective == pytest.approx(best, abs=0.01)
    assert made.verdict.ok


@pytest.mark.minizinc
@pytest.mark.scrap("looks at travel alone")
def test_minizinc_finds_it_too(left: Facts, profile: Profile) -> None:
    ours = solve_and_verify(make_request(left, profile), profile, SolveOptions(work=5.0))
    twin = solve_and_verify(make_request(left, profile), profile, SolveOptions(work=60.0), Method("minizinc"))
    assert twin.plan.solve.objective == pytest.approx(ours.plan.solve.objective, abs=0.001)


def test_travel_from_home_over_what_is_out_is_judged(left: Facts, profile: Profile) -> None:
    """From the right of A to the left of D the torch comes over A, which is out; B is not on the way."""
    plan = solve_and_verify(make_request(left, profile), profile, SolveOptions(work=2.0)).plan
    sequence = plan.sequence((95.0, 50.0))
    verdict = check_cuts(PLATE, replace(sequence, cuts=(*sequence.cuts[:3], *sequence.new[::-1])), profile)
    judged = next(j for j in verdict.rules if j.id == "no-tip-travel")
    told = {v.text for v in judged.violations if v.text.startswith("travel from home")}
    first = sequence.new[-1]
    over = shapely.LineString([(95.0, 50.0), first.pierce])
    assert {p.id for p in PLATE.parts[:2] if over.intersects(p.outer.polygon.buffer(-0.1))} == {
        text.split("leads over ")[1].split(",")[0] for text in told
    }
    assert len(told) == 1


def test_a_position_counts_what_is_cut(left: Facts, profile: Profile) -> None:
    last = left.nest.contours[0].id
    locked = replace(profile, locks=(Lock(contour=last, position=5),))
    made = solve_and_verify(make_request(left, locked), locked, SolveOptions(work=2.0))
    assert [p.cut.contour for p in made.plan.cuts].index(last) == 1
    assert made.verdict.ok
