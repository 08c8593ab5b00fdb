"""Small nests with snakes: every plan of ways and stretches, dearest last, up to the first that the check passes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations, product
from typing import Any

import numpy as np
import pytest

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines import Engine
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import check_cuts
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rules.case import nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.profile.sections import RuleSetting, Snake, Split
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.tests.tools.amount import few

ENGINES_OF_OURS: tuple[Engine, ...] = ("portfolio", "search", "ideals", "cp-sat-alone")
OF_ORDERS = ("level-ahead", "hull-before")
MOST = 1000
"""So many plans are shown to the check, at the most."""


GRIDS = 20
"""From this seed on nests have two rows of two, which one way goes through."""
PAIRS = 40
"""From this seed on they have two parts a kerf apart, whose common edge is cut last, and one that stands alone."""


def drawn(seed: int) -> Nest:
    """Two or three rectangles in a row, a kerf or a gap apart, and one or two parts that stand alone; or a grid."""
    rng = np.random.default_rng([seed, 45])
    if seed >= PAIRS:
        wide, high, other = (float(rng.integers(40, 70)) for _ in range(3))
        pair = part("P0", rect(20, 20, wide, high)), part("P1", rect(20.2 + wide, 20, 50, other))
        return nest(240, 190, *pair, part("L", rect(20, 120, 60, 40)))
    if seed >= GRIDS:
        wide, high, gap, street = (float(rng.integers(*span)) for span in ((40, 70), (30, 60), (4, 16), (4, 18)))
        at = [(20 + k % 2 * (wide + gap), 20 + k // 2 * (high + street)) for k in range(4)]
        aside = [float(rng.integers(0, 4)) for _ in at] if seed % 4 else [0.0] * 4
        return nest(220, 190, *(part(f"P{k}", rect(x + aside[k], y, wide, high)) for k, (x, y) in enumerate(at)))
    gap = 0.2 if seed % 3 == 0 else float(rng.integers(4, 16))
    wide, high, count = float(rng.integers(40, 70)), float(rng.integers(30, 60)), 2 + (seed % 2)
    low = [20.0 if gap < 1 else 20.0 + float(rng.integers(0, 12)) for _ in range(count)]
    parts = [part(f"P{k}", rect(20 + k * (wide + gap), low[k], wide, high)) for k in range(count)]
    parts += [part(f"L{k}", rect(20 + 90 * k, 130, 40, 30)) for k in range(4 - count)]
    return nest(340, 190, *parts)


def plant(seed: int) -> Profile:
    """The laser's profile with snakes; what has a price is off, so that the cost of a plan is its idle travel."""
    profile = load_profile("laser-st10kp-2mm")
    rules = {k: RuleSetting("off", None, s.options) if s.strength == "soft" else s for k, s in profile.rules.items()}
    if seed % 2:
        options: Any = profile.rules["part-rigidity"].options
        rules["part-rigidity"] = RuleSetting("hard", None, replace(options, head_weight_mm=0.0))
    leads = replace(profile.leads, entries=2 if seed < PAIRS else 6)
    snake, pairs = Snake(gap_mm=20.0, rows=2), Split(last_mm=12.0, shared_last=True)
    cuts = replace(profile.cuts, split=pairs) if seed >= PAIRS else replace(profile.cuts, snake=snake)
    return replace(profile, rules=rules, leads=leads, cuts=cuts)


def routes(facts: Facts, profile: Profile) -> Iterator[tuple[float, tuple[int, ...]]]:
    """Every order of the items that cuts ways before what they leave, every choice of candidates, and its travel."""
    ways = [facts.nest.index[way.id] for way in facts.nest.stretches]
    begins = {facts.nest.index[s.contour]: w for w in ways for s in facts.nest.contours[w].along}
    held = [way for way in ways if facts.nest.contours[way].holds]
    last = {k for k, way in begins.items() if way in held}
    home = profile.home_on(facts.nest)
    for order in permutations(range(facts.n)):
        at = {k: p for p, k in enumerate(order)}
        if all(at[way] < at[k] for k, way in begins.items()) and all(at[w] < at[k] for w in held for k in last):
            for picked in product(*(facts.candidates_of(k) for k in order)):
                cuts = [facts.candidates[c] for c in picked]
                stops = [home, *(c.end for c in cuts)], [*(c.pierce for c in cuts), home]
                yield sum(math.dist(a, b) for a, b in zip(*stops, strict=True)), picked


def ways_only(route: tuple[int, ...]) -> Solution:
    return Solution(route, 0.0, None, "feasible", "", "", 0.0)


def plan_of(request: Request, profile: Profile, route: tuple[int, ...]) -> Plan:
    return make_plan(request.facts, profile, request.stated, ways_only(route), "portfolio", 1)


def least_by_check(request: Request, profile: Profile) -> float | None:
    """The travel of the shortest plan that the check has nothing against; None where it passes none that is shown.

    Orders that a rule of orders is against, as it judges plans, are left out first: that takes less long.
    """
    facts, whole, settings = request.facts, request.facts.whole_nest, profile.settings()
    lawful: dict[tuple[int, ...], bool] = {}
    shown = 0
    for mm, route in sorted(routes(facts, profile)):
        order = tuple(facts.candidates[c].contour for c in route)
        if not lawful.get(order, True):
            continue
        plan = plan_of(request, profile, route)
        cuts = plan.sequence(profile.home_on(whole))
        if order not in lawful:
            of = {rule: profile.rulebook()[rule].violations(whole, cuts, settings[rule].options) for rule in OF_ORDERS}
            lawful[order] = not any(of.values())
        if lawful[order] and (shown := shown + 1) <= MOST and check_cuts(whole, cuts, profile).ok:
            program = write_program(with_times(plan, whole, profile), whole, profile)
            if check_program(whole, program, profile, plan=plan).ok:  # each contour is out when the plan says so
                return mm
    return None


@pytest.mark.minizinc
@pytest.mark.parametrize("seed", few([2, 11, 3, 0, 1, 4, 5, 6, 7, 8, 9, 10, 20, 22, 24, 26, 28, 40, 42, 44, 46]))
def test_every_engine_finds_what_the_check_passes_of_all_plans(seed: int) -> None:
    plate, profile = drawn(seed), plant(seed)
    given = Inputs(plate, profile)
    facts = facts_of(given.nest, profile)
    assert facts.nest.stretches, "there is no row"
    assert not GRIDS <= seed < PAIRS or len(facts.nest.stretches[0].along) == len(facts.nest.stretches) * 4, (
        "one way through all"
    )
    request = make_request(facts, profile)
    least = least_by_check(request, profile)
    assert least is not None
    refine = lazy_statements(facts, profile)

    def options(engine: Engine) -> SolveOptions:
        return options_for(plate, profile, work=4, engine=engine)

    found = {
        engine: solve(facts, request.stated.statements, options(engine), None, refine) for engine in ENGINES_OF_OURS
    }
    found["minizinc"] = solve_minizinc(facts, profile, request.stated, options("minizinc"), refine=refine)
    assert {name: solution.objective for name, solution in found.items()} == pytest.approx(
        dict.fromkeys(found, least), abs=0.01
    )
    proved = [name for name, solution in found.items() if solution.status == "optimal"]
    assert {"portfolio", "ideals", "cp-sat-alone", "minizinc"} <= {*proved}
