"""One random nest that was stopped: every engine goes on with it, and every way to go on is tried by the check.

All rules are hard or off, so that a plan's price is its travel and its excuses: nothing else is to be known of a rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations, product
from math import inf

import numpy as np

from kerfwise import InputError, Profile, RulesConflict
from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.candidates import CandidateBuilder
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.compute import loose_in, remaining_facts
from kerfwise.jobs.request import options_for
from kerfwise.models.engines import Engine, member_of
from kerfwise.models.engines.solve import solve
from kerfwise.rule_kit import Cut, CutSequence, Facts, RuleSetting, Violation
from kerfwise.rules.catalogue.part_rigidity import ALLOWANCE
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import EXEMPTION_MM
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import Stated, loose_orders, state_rules
from kerfwise.tests.agreement.by_check import shifted
from kerfwise.tests.agreement.cases import judged_case, thinned
from kerfwise.tests.agreement.engines import ENGINES, IMPOSSIBLE, UNPROVEN, Answer
from kerfwise.tests.models.engines.cases import Case, lead_options

LEFT = 4
"""Contours that are left at the most: 24 orders."""
WAYS = {1: 64, 2: 64, 3: 32, 4: 16}
"""Contours left → the most ways to pick entries and directions that are tried along each order."""
OLD_RULES = ("inner-before-outer", "nested-before-host-holes", "pierce", "shared-metal")
"""What every second old program was planned by, and no more: what is left may then be too late for other rules."""
OF_WAYS = ("cut-direction", "pierce", "locks", "part-rigidity", "no-tip-travel", "heat-lag")
"""Rules that look at more than the order of cuts."""
ALONE: tuple[Engine, ...] = ("search", "ideals", "cp-sat-alone")
ROUNDED_MM = 0.01


@dataclass(frozen=True)
class Resumed:
    """`outcome` is solved, infeasible, or why nothing could be gone on with; `engines` those compared."""

    outcome: str
    engines: tuple[str, ...] = ()
    differ: tuple[str, ...] = ()


def resumed_agreement(seed: int) -> Resumed:
    """The engines, and every plan of the rest tried by the check, on the nest of a seed after a stop."""
    case = stopped_case(seed)
    if case is None:
        return Resumed("not to be gone on with")
    judges = [Going(case, profile) for profile in _shifted(case.profile)]
    try:
        stated = state_rules(case.facts, case.profile)
    except RulesConflict:
        tried = [judge.cheapest_mm() for judge in judges]
        lines = [f"the rules contradict each other, the check lets {mm:.3f} mm pass" for mm in tried if mm < inf]
        return Resumed("infeasible", ("rules",), tuple(lines))
    dropped = frozenset((d.rule, d.contours) for d in stated.dropped)
    judges = [replace(judge, dropped=dropped) for judge in judges]
    tried = sorted(judge.cheapest_mm() for judge in judges)
    differ, compared, outcome = [], [], "unproven"
    for name, answer in _answers(case, stated):
        if answer.says == UNPROVEN and answer.mm is None:
            if name != "search" or tried[1] < inf:  # the search cannot tell that there is none
                differ.append(f"{name} finds nothing")
            continue
        compared.append(name)
        outcome = "infeasible" if answer.says == IMPOSSIBLE else "solved"
        told = sorted(judge.price_mm(answer.route) if answer.route else inf for judge in judges)
        if not (told[0] <= tried[1] + ROUNDED_MM and tried[0] <= told[1] + ROUNDED_MM):
            differ.append(
                f"{name}: {told[0]:.3f} to {told[1]:.3f} mm, of all tried {tried[0]:.3f} to {tried[1]:.3f} mm"
            )
    return Resumed(outcome, tuple(compared), tuple(differ))


def stopped_case(seed: int) -> Case | None:
    """What is left of a nest of 5 to 7 contours after a stop; None where no plan, or no room for a pierce, is left."""
    rng = np.random.default_rng([seed, 8])
    whole = judged_case(seed % 3 + 5 * seed)  # of 5 to 7 contours
    profile, nest = hard_or_off(rng, whole.profile), whole.facts.nest
    made = _planned(whole, profile) if seed % 2 else None
    made = made or _planned(whole, only_these(profile, OLD_RULES))
    if made is None:
        return None
    upto = int(rng.integers(max(1, whole.facts.n - LEFT), whole.facts.n))
    cuts = tuple(_cut(whole.facts, c) for c in made[:upto])
    already = AlreadyCut(cuts)
    loose = loose_in(nest, already.contours)
    try:
        candidates, _ = CandidateBuilder(nest, lead_options(profile, seed), already, loose).build()
    except InputError:
        return None
    left = WAYS[whole.facts.n - upto]
    facts = remaining_facts(
        compute_facts(nest, profile.fact_options(nest), thinned(rng, nest, candidates, left)), already
    )
    return None if loose_orders(facts) else Case(facts, profile, options_for(nest, profile, work=20))


def _planned(whole: Case, old: Profile) -> tuple[int, ...] | None:
    """The old program's candidates in cutting order; None where there is no plan."""
    try:
        stated = state_rules(whole.facts, old)
        refine = lazy_statements(whole.facts, old)
        return solve(whole.facts, stated.statements, replace(whole.options, work=2.0), refine=refine).route
    except RulesConflict:
        return None


def hard_or_off(rng: np.random.Generator, profile: Profile) -> Profile:
    """Soft rules become hard, or off; lags count cuts, and seconds cost nothing."""
    rules = dict(profile.rules)
    for name, setting in rules.items():
        if setting.strength == "soft":
            hard = "hard" in RULES[name].strengths and bool(rng.integers(2))
            rules[name] = RuleSetting("hard" if hard else "off", None, setting.options)
    heat = rules["heat-lag"]
    rules["heat-lag"] = replace(heat, options=replace(heat.options, lag_s=0.0))
    return replace(profile, rules=rules, objective=replace(profile.objective, time=0.0))


def only_these(profile: Profile, names: Sequence[str]) -> Profile:
    """The profile with all other rules off, and no locks."""
    rules = {n: s if n in names else RuleSetting("off", None, s.options) for n, s in profile.rules.items()}
    return replace(profile, rules=rules, locks=())


def _cut(facts: Facts, number: int) -> Cut:
    c = facts.candidates[number]
    name, zone = facts.nest.contours[c.contour].id, int(facts.zone[c.contour])
    return c.as_cut(name, zone)


def _shifted(profile: Profile) -> list[Profile]:
    return [shifted(profile, share) for share in (-ALLOWANCE, ALLOWANCE)]


def _answers(case: Case, stated: Stated) -> Iterator[tuple[str, Answer]]:
    for name, engine in ENGINES.items():
        yield name, engine(case, stated)
    for name in ALONE:
        options = replace(case.options, member=member_of(name), work=1.0)
        try:
            found = solve(case.facts, stated.statements, options, refine=lazy_statements(case.facts, case.profile))
        except InputError:  # it says that it cannot
            continue
        except RulesConflict as conflict:
            yield name, Answer(UNPROVEN if "within the limit" in conflict.message else IMPOSSIBLE)
        else:
            yield name, Answer("found", found.objective, found.route)


@dataclass(frozen=True)
class Going:
    """Prices ways to go on: travel, and EXEMPTION_MM for each breach of a rule that may be excused."""

    case: Case
    profile: Profile
    dropped: frozenset[tuple[str, tuple[str, ...]]] = frozenset()

    def price_mm(self, route: Sequence[int]) -> float:
        """What candidates in cutting order cost, as the check sees them; inf where a hard rule is broken."""
        order = [self.case.facts.candidates[c].contour for c in route]
        if sorted(order) != list(range(self.case.facts.n)):
            return inf
        return self._travel_mm(route) + self._breaches_mm(route, tuple(self.rules))

    def cheapest_mm(self) -> float:
        """The least price of all ways to go on; inf where there is none."""
        best = inf
        of_order = tuple(name for name in self.rules if name not in OF_WAYS)
        of_ways = tuple(name for name in self.rules if name in OF_WAYS)
        known: dict[tuple[int, ...], float] = {}
        ways = []
        for route in self.ways():
            order = tuple(self.case.facts.candidates[c].contour for c in route)
            if order not in known:
                known[order] = self._breaches_mm(route, of_order)
            if known[order] < inf:
                ways.append((known[order] + self._travel_mm(route), route))
        for mm, route in sorted(ways):
            if mm >= best:
                break
            best = min(best, mm + self._breaches_mm(route, of_ways))
        return best

    def ways(self) -> Iterator[tuple[int, ...]]:
        """All ways to go on: candidates in cutting order."""
        for order in permutations(range(self.case.facts.n)):
            yield from product(*(self.case.facts.candidates_of(k) for k in order))

    @property
    def rules(self) -> Mapping[str, RuleSetting]:
        """The rules that are on, all of them hard."""
        return self.profile.settings()

    def _travel_mm(self, route: Sequence[int]) -> float:
        cuts, home = [self.case.facts.candidates[c] for c in route], self.case.options.home_mm
        leave, reach = [home, *(c.end for c in cuts)], [*(c.pierce for c in cuts), home]
        return self.profile.objective.idle * float(np.hypot(*(np.array(leave) - np.array(reach)).T).sum())

    def _breaches_mm(self, route: Sequence[int], names: Sequence[str]) -> float:
        total = 0.0
        for name in names:
            found = self._violations(name, route)
            if name == "part-rigidity":
                found = [v for v in found if not self._exempt(v.contours[0])]
            if found and not RULES[name].excusable:
                return inf
            total += EXEMPTION_MM * len(found)
        return total

    def _violations(self, name: str, route: Sequence[int]) -> list[Violation]:
        facts, rule = self.case.facts, self.profile.rulebook()[name]
        cuts = (*facts.already_cut, *(_cut(facts, c) for c in route))
        made = len(facts.already_cut)
        sequence = CutSequence(cuts, facts.start_side, self.case.options.home_mm, made=made)
        found = rule.violations(facts.whole_nest, sequence, self.rules[name].options)
        return [v for v in found if rule.still_counts(v, made) and (name, v.contours) not in self.dropped]

    def _exempt(self, contour: str) -> bool:
        """Whether no way to cut the contour next keeps metal that is rigid enough: nothing can be asked then."""
        facts = self.case.facts
        k = facts.nest.index[contour]
        others = [facts.candidates_of(i)[0] for i in range(facts.n) if i != k]
        return all(
            any(v.contours[0] == contour for v in self._violations("part-rigidity", [way, *others]))
            for way in facts.candidates_of(k)
        )
