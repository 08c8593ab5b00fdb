"""Small nests with stretches or bevels: every plan, dearest last, up to the first that the check passes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations, product
from typing import Any, Literal, get_args

import numpy as np

from kerfwise import Nest, Plan, Profile
from kerfwise.encoder.bevels.bevel import Bevel
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.request import Request, facts_of, make_request, options_for
from kerfwise.models.engines import Engine
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.postproc.check import check_cuts
from kerfwise.postproc.clock import with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_program
from kerfwise.rule_kit import Facts, RuleSetting, nest, part, rect
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.profile.sections import Snake, Split
from kerfwise.rules.stating.lazy_statements import lazy_statements

ROUNDED_MM = 0.01
ENGINES_OF_OURS: tuple[Engine, ...] = ("portfolio", "search", "ideals", "cp-sat-alone")
OF_ORDERS = ("level-ahead", "hull-before")
MOST = 1000
"""So many plans are shown to the check, at the most."""


Kind = Literal["row", "grid", "pair", "bevel"]
KINDS: tuple[Kind, ...] = get_args(Kind)


def drawn(kind: Kind, seed: int) -> Nest:
    """Parts in a row, a kerf or a gap apart; two rows of two; two parts a kerf apart; or parts with bevels."""
    rng = np.random.default_rng([seed, 45])
    if kind == "bevel":
        bevel = Bevel("V", float(rng.integers(15, 45)), 0.0, "top" if seed % 2 else "bottom")
        parts = [part(f"P{k}", rect(60 + 150 * k, 60 + 20 * (k % 2), *rng.integers(50, 90, 2))) for k in range(3)]
        return nest(
            560, 260, *(replace(p, outer=replace(p.outer, bevel=bevel)) if k else p for k, p in enumerate(parts))
        )
    if kind == "pair":
        wide, high, other = (float(rng.integers(40, 70)) for _ in range(3))
        pair = part("P0", rect(20, 20, wide, high)), part("P1", rect(20.2 + wide, 20, 50, other))
        return nest(240, 190, *pair, part("L", rect(20, 120, 60, 40)))
    if kind == "grid":
        wide, high, gap, street = (float(rng.integers(*span)) for span in ((40, 70), (30, 60), (4, 16), (4, 18)))
        at = [(20 + k % 2 * (wide + gap), 20 + k // 2 * (high + street)) for k in range(4)]
        aside = [float(rng.integers(0, 4)) for _ in at] if seed % 2 else [0.0] * 4
        return nest(220, 190, *(part(f"P{k}", rect(x + aside[k], y, wide, high)) for k, (x, y) in enumerate(at)))
    gap = 0.2 if seed % 3 == 0 else float(rng.integers(4, 16))
    wide, high, count = float(rng.integers(40, 70)), float(rng.integers(30, 60)), 2 + (seed % 2)
    low = [20.0 if gap < 1 else 20.0 + float(rng.integers(0, 12)) for _ in range(count)]
    parts = [part(f"P{k}", rect(20 + k * (wide + gap), low[k], wide, high)) for k in range(count)]
    parts += [part(f"L{k}", rect(20 + 90 * k, 130, 40, 30)) for k in range(4 - count)]
    return nest(340, 190, *parts)


def plant(kind: Kind, seed: int) -> Profile:
    """A profile for them; what has a price is off, so that the cost of a plan is its idle travel."""
    profile = load_profile("plasma-carbon-steel" if kind == "bevel" else "laser-st10kp-2mm")
    rules = {k: RuleSetting("off", None, s.options) if s.strength == "soft" else s for k, s in profile.rules.items()}
    options: Any = profile.rules["part-rigidity"].options
    if kind == "row" and seed % 2:  # elsewhere a plan may need excuses, which cost more than its travel
        rules["part-rigidity"] = RuleSetting("hard", None, replace(options, head_weight_mm=0.0))
    elif kind == "bevel":
        rules["part-rigidity"] = RuleSetting("off", None, options)
    leads = replace(profile.leads, entries=6 if kind == "pair" else 2)
    cuts, machine, material = profile.cuts, profile.machine, profile.material
    match kind:
        case "bevel":
            cuts = replace(cuts, bevel=replace(cuts.bevel, head="tilting"))
            machine, material = replace(machine, dialect="linuxcnc"), replace(material, thickness_mm=12.0)
        case "pair":
            cuts = replace(cuts, split=Split(last_mm=12.0, shared_last=True))
        case _:
            cuts = replace(cuts, snake=Snake(gap_mm=20.0, rows=2))
    return replace(profile, rules=rules, leads=leads, cuts=cuts, machine=machine, material=material)


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


def stretch_agreement(seed: int, kind: Kind | None = None) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """The kind of a seed's nest, the engines that prove their plan, and a line for each that differs from all plans."""
    kind = kind or KINDS[seed // 8 % len(KINDS)]
    plate, profile = drawn(kind, seed), plant(kind, seed)
    facts = facts_of(Inputs(plate, profile).nest, profile)
    assert facts.nest.stretches or kind == "bevel", "there is no way"
    if kind == "grid":
        assert [len(way.along) for way in facts.nest.stretches] == [4], "one way through all"
    request = make_request(facts, profile)
    least = least_by_check(request, profile)
    refine = lazy_statements(facts, profile)

    def options(engine: Engine) -> SolveOptions:
        return options_for(plate, profile, work=4, engine=engine)

    found = {
        engine: solve(facts, request.stated.statements, options(engine), None, refine) for engine in ENGINES_OF_OURS
    }
    found["minizinc"] = solve_minizinc(facts, profile, request.stated, options("minizinc"), refine=refine)
    differ = [
        f"{name}: {one.objective} mm, of all tried {least} mm"
        for name, one in found.items()
        if least is None or abs(one.objective - least) > ROUNDED_MM
    ]
    return kind, tuple(name for name, one in found.items() if one.status == "optimal"), tuple(differ)
