"""A small nest made at random on which one rule is on, and every plan of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations, product
from math import factorial, prod
from typing import Any

import numpy as np
import shapely

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.encoder.cut import Cut, CutSequence
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest, Part
from kerfwise.models.physics.motion import Leg, schedule
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.evaluate import broken
from kerfwise.models.problem.problem import Problem
from kerfwise.postproc.check.plan_runs import runs_from_cuts
from kerfwise.postproc.clock import contour_heat_kj
from kerfwise.rules.case import circle, nest, part, rect
from kerfwise.rules.flat.model_rule import ModelRule
from kerfwise.rules.judging.violation import Violation
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import Rule, RuleSetting, Strength
from kerfwise.rules.statements import Statement

MOST_PLANS = 800
"""Plans of one nest that are tried; nests with more are left out."""
PlanOf = tuple[int, ...]
"""One plan: candidate numbers in order."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A nest under a profile in which the rule on trial is hard and all that can be off is off."""

    name: str
    facts: Facts
    profile: Profile
    rule: Rule[Any]

    @property
    def nest(self) -> Nest:
        """The nest, as the profile has it cut."""
        return self.facts.nest

    @cached_property
    def options(self) -> Any:
        """The rule's options, filled in from the profile."""
        return self.profile.settings()[self.rule.id].options

    @cached_property
    def plans(self) -> tuple[PlanOf, ...]:
        """Every plan, in a fixed order."""
        ways = [self.facts.candidates_of(i) for i in range(self.facts.n)]
        return tuple(
            picked for order in permutations(range(self.facts.n)) for picked in product(*(ways[i] for i in order))
        )

    def said(self, plan: PlanOf) -> str:
        """A plan in words: the contours in order, with the way round where a contour has several ways."""
        candidates = [self.facts.candidates[c] for c in plan]
        several = len(self.facts.candidates) > self.facts.n
        names = (self.nest.contours[c.contour].id + f" {c.direction}" * several for c in candidates)
        return f"{self.name}: {', '.join(names)}"

    def sequence(self, plan: PlanOf) -> CutSequence:
        """The cuts of a plan, with their times, as the check sees them."""
        cuts = [self._cuts[c] for c in plan]
        home = self.profile.home_on(self.nest)
        times = schedule([self._legs[c] for c in plan], feeds_of(self.profile), home)
        timed = (replace(cut, start_s=begin, end_s=end) for cut, (begin, end) in zip(cuts, times, strict=True))
        return CutSequence(tuple(timed), self.facts.start_side, home)

    @cached_property
    def _cuts(self) -> list[Cut]:
        names = [contour.id for contour in self.nest.contours]
        return [c.as_cut(names[c.contour], int(self.facts.zone[c.contour])) for c in self.facts.candidates]

    @cached_property
    def _legs(self) -> list[Leg]:
        sheet, found = self.nest.sheet.polygon, []
        for cut in self._cuts:
            (run,), _ = runs_from_cuts(self.nest, CutSequence((cut,)), self.profile.material.kerf_mm)
            pierced = bool(shapely.intersects(sheet, shapely.Point(cut.pierce)))
            marks = self.nest.contour(cut.contour).kind == "mark"
            found.append(Leg(cut.pierce, cut.end, float(run.length_mm), marks, pierced))
        return found

    def unjudged(self) -> str | None:
        """Why the rule cannot be judged on this nest, whatever the order; None where it can."""
        return self.rule.unjudged(self.nest, self.sequence(self.plans[0]), self.options)

    def admitted_by_violations(self, options: Any) -> frozenset[PlanOf]:
        """The plans in which the rule blames nothing, but what no order can avoid."""
        exempt = {frozenset(about.contours) for about in self.rule.exempt(self.facts, self.options)}
        found = zip(self.plans, self.violations(self.plans, options), strict=True)
        return frozenset(plan for plan, broken in found if not self._blamed(plan, broken, options, exempt))

    def violations(self, plans: Sequence[PlanOf], options: Any) -> list[tuple[Violation, ...]]:
        """What the rule blames in each of these plans; a model file is evaluated on all of them at once."""
        orders = [self.sequence(plan) for plan in plans]
        if isinstance(self.rule, ModelRule):
            return self.rule.violations_of_each(self.nest, orders, options)
        return [tuple(self.rule.violations(self.nest, cuts, options)) for cuts in orders]

    def _blamed(self, plan: PlanOf, broken: Sequence[Violation], options: Any, exempt: set[frozenset[str]]) -> bool:
        found = [v for v in broken if frozenset(v.contours) not in exempt]
        cuts = self.sequence(plan) if found else CutSequence(())
        return any(self.rule.excuse(self.nest, cuts, options, v, lambda name: frozenset()) is None for v in found)

    def admitted_by_statements(self) -> frozenset[PlanOf]:
        """The plans that keep every statement of the rule, and what it says of complete orders."""
        statements = tuple(self.rule.statements(self.facts, self.options))
        try:
            problem = self.problem(statements)
        except RulesConflict:
            return frozenset()
        names = [contour.id for contour in self.nest.contours]
        known: dict[tuple[int, ...], bool] = {}

        def kept(plan: PlanOf) -> bool:
            order = tuple(self.facts.candidates[c].contour for c in plan)
            if order not in known:
                known[order] = not self.rule.no_goods(self.nest, [names[k] for k in order], self.options)
            return known[order]

        return frozenset(plan for plan in self.plans if lawful(problem, plan) and kept(plan))

    def problem(self, statements: tuple[Statement, ...]) -> Problem:
        """What engines are given; RulesConflict where nothing can keep the statements."""
        return make_problem(self.facts, statements, self.profile.home_on(self.nest), feeds_of(self.profile))


def route(problem: Problem, plan: PlanOf) -> tuple[int, ...]:
    """A plan in the numbers of a problem; -1 for a candidate that is forbidden."""
    return tuple(int(problem.candidate_site[c]) for c in plan)


def lawful(problem: Problem, plan: PlanOf) -> bool:
    """Whether a plan breaks nothing hard."""
    sites = route(problem, plan)
    return -1 not in sites and not broken(problem, sites)


def profile_with_rule_alone(profile: Profile, rule: str, strength: Strength | None = None, **changed: Any) -> Profile:
    """The profile with this rule as hard as may be, or as said, and all that can be off switched off; without locks."""
    known, settings = profile.known_rules(), {}
    for name, setting in profile.rules.items():
        strengths = known[name].strengths
        firm = strengths[0] if name == rule or "off" not in strengths else "off"
        said: Strength = strength or firm if name == rule else firm
        weight = known[name].default_weight if said == "soft" else None
        options = replace(setting.options, **changed) if name == rule else setting.options
        settings[name] = RuleSetting(said, weight, options)
    own = tuple(one for one in profile.own_rules if one.id == rule)
    return replace(profile, rules=settings, own_rules=own, locks=())


def trial_of(name: str, nest: Nest, profile: Profile, rule: str, ways: int = 1) -> Trial | None:
    """The trial of a rule on a nest with so many ways to cut each contour.

    None where its contours cannot be cut, or there are too many plans to try all.
    """
    cut = profile.as_cut(nest)
    try:
        options = replace(profile.lead_options(cut), entries=min(ways, 2))
        candidates = _thinned(build_candidates(cut, options), ways)
        heat_kj = contour_heat_kj(cut, candidates, profile)
        facts = compute_facts(cut, profile.fact_options(cut), candidates, heat_kj)
    except InputError as error:
        if error.file is not None:  # the rule's own file is wrong, not the nest
            raise
        return None
    except RulesConflict:
        return None
    counts = [len(facts.candidates_of(i)) for i in range(facts.n)]
    if not 0 < factorial(facts.n) * prod(counts) <= MOST_PLANS:
        return None
    return Trial(name, facts, profile, profile.rulebook()[rule])


def _thinned(candidates: Sequence[Candidate], ways: int) -> tuple[Candidate, ...]:
    """So many of each contour's candidates, the first and the last among them."""

    def kept(own: list[Candidate]) -> Iterator[Candidate]:
        last = len(own) - 1
        for k in sorted({round(k * last / max(ways - 1, 1)) for k in range(min(ways, len(own)))}):
            yield own[k]

    of_contour: dict[int, list[Candidate]] = {}
    for candidate in candidates:
        of_contour.setdefault(candidate.contour, []).append(candidate)
    return tuple(candidate for contour in sorted(of_contour) for candidate in kept(of_contour[contour]))


# Small nests made at random, the same for the same seed, with every shape that order rules are about.

PITCH = 110
SHAPES = ("plate", "marked", "ring", "disc", "host", "right", "up", "small")


def random_nest(rng: np.random.Generator, contours: int, least: int = 5) -> Nest:
    """Plates, rings, hosts with a guest, channels with a guest and marked plates, row after row of three."""
    parts: list[Part] = []
    while sum(len(list(p)) for p in parts) < min(least, contours):
        x, y = PITCH * (len(parts) % 3), PITCH * (len(parts) // 3)
        part = _shape(str(rng.choice(SHAPES)), f"P{len(parts)}", x + int(rng.integers(3, 12)), y + 5, rng)
        if sum(len(list(p)) for p in [*parts, *part]) <= contours:
            parts += part
    width, height = 3 * PITCH + int(rng.choice([0, 60, 300])), PITCH * (2 + (len(parts) > 6)) + int(rng.choice([0, 80]))
    return nest(width, height, *parts)


def _shape(shape: str, name: str, x: int, y: int, rng: np.random.Generator) -> list[Part]:
    w, h = int(rng.integers(70, 99)), int(rng.integers(70, 99))
    guest = part(f"{name}g", rect(x + 24, y + 24, 22, 22))
    u = [(0, 0), (w, 0), (w, 10), (10, 10), (10, h - 10), (w, h - 10), (w, h), (0, h)]
    match shape:
        case "plate":
            return [part(name, rect(x, y, w, h))]
        case "marked":
            return [part(name, rect(x, y, w, h), marks=[[(x + 9, y + 9), (x + 30, y + 9)]])]
        case "ring":
            return [part(name, rect(x, y, w, h), [rect(x + 12, y + 12, 20, 20), circle(x + 55, y + 50, 9)])]
        case "disc":
            return [part(name, circle(x + 40, y + 40, 38), [circle(x + 40, y + 40, 12)])]
        case "host":
            return [part(name, rect(x, y, w, h), [rect(x + 10, y + 10, 50, 50)]), guest]
        case "right":
            return [part(name, [(x + a, y + b) for a, b in u]), guest]
        case "up":
            return [part(name, [(x + b, y + a) for a, b in u][::-1]), guest]
        case _:
            return [part(name, rect(x, y, 30, 30)), part(f"{name}b", rect(x, y + 40, 30, 30))]


def trial_nest(seed: int, contours: int) -> Nest:
    """A nest of about so many contours; its parts have a priority, an order and a customer, and one may be a bar."""
    rng = np.random.default_rng([seed, 23])
    base = random_nest(rng, contours - 1)
    room = 2 * PITCH + 6
    parts = [*base.parts, *([part("Bar", rect(8, room, 100, 20))] if rng.random() < 0.7 else [])]
    known = [replace(p, attributes=_attributes(rng)) for p in parts]
    return nest(3 * PITCH + 60, room + 40, *known)


def _attributes(rng: np.random.Generator) -> dict[str, object]:
    priority, order = (int(rng.integers(1, most + 1)) for most in (3, 2))
    return {"priority": priority, "order": order, "customer": str(rng.choice(["A", "B"]))}
