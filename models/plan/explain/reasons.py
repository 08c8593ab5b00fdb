"""Why each contour of a plan is where it is: what would have to go for the plan to cost less with it elsewhere.

A reason is true by counterfactual: without the statements that it names, the plan with that contour in the place that
it names breaks nothing that this one does not, and costs less. Where there is none, no place makes the plan cheaper.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise, takewhile
from math import inf

import numpy as np

from kerfwise.encoder.geometry.tolerances import UM_PER_MM, cost_um
from kerfwise.models.engines.tuning import REASONS_S, REASONS_SHARE
from kerfwise.models.jit import running_s
from kerfwise.models.plan.plan import LINKED, SIMULATION, Plan, Prices
from kerfwise.models.problem.crossings import FORBIDDEN
from kerfwise.models.problem.evaluate import (
    broken_conditions,
    broken_moves,
    general_holds,
    missing_ms,
    pieces,
    route_cost,
    times_ms,
)
from kerfwise.rules.statements import EXEMPTION_MM, About, Move, by_kind
from kerfwise.rules.stating.lazy_statements import lazy_statements, looks_at_orders, meeting_of

from .alternatives import Hold, PositionCosts, nearest_orders
from .context import PlanContext
from .other_places import MATTERS_UM, OtherPlace, OtherPlaces

LOOKS = 6000
"""Contours that are looked at in all, where geometry has afterthoughts on whole orders: a look at an order of n
contours counts n."""
TRIED = 3
"""Places that are looked at for one contour, at the most."""
FEW_TOLD, FEW_NAMED = 2, 3
"""Statements of several rules that are told in full, and rules that are named, where there are more."""
EXEMPTION_UM = round(EXEMPTION_MM * UM_PER_MM)
BEST_ENTRIES = 150
"""Contours up to which all places are tried with the best entries along each order."""


@dataclass(frozen=True, slots=True)
class Reason:
    """Without the statements of `abouts` the plan would cost `saved_um` less with the contour in `place` (from 1).

    Each of them alone would do where there is one; where there are several, all have to go.
    """

    abouts: tuple[About, ...]
    place: int
    saved_um: int

    def told(self) -> str:
        """What is to be kept, in a planner's words."""
        of_rule: dict[str, list[str]] = {}
        for about in self.abouts:
            of_rule.setdefault(about.rule, []).append(about.sentence)
        if len(of_rule) == 1 or len(self.abouts) <= FEW_TOLD:
            texts = [
                sentences[0] + (f", and {len(sentences) - 1} more of {rule}" if len(sentences) > 1 else "")
                for rule, sentences in of_rule.items()
            ]
            return texts[0] if len(texts) == 1 else f"together: {'; '.join(texts)}"
        most = sorted(of_rule, key=lambda rule: -len(of_rule[rule]))
        named = most[:FEW_NAMED]
        named += [f"{len(most) - FEW_NAMED} more"] if len(most) > FEW_NAMED else []
        return f"decided by {len(most)} rules together: {', '.join(named[:-1])} and {named[-1]}"

    def more(self) -> str:
        """What that would save, and where."""
        without = "without it" if len(self.abouts) == 1 else f"without these {len(self.abouts)}"
        excuses = round(self.saved_um / EXEMPTION_UM)
        mm = (self.saved_um - excuses * EXEMPTION_UM) / UM_PER_MM
        fewer = f"{excuses} fewer excuses from hard rules and " if excuses else ""
        return f"{without} as number {self.place}: {fewer}{mm:.1f} mm less"


@dataclass(frozen=True, slots=True)
class WhyHere:
    """What decides where a contour is cut.

    Attributes
    ----------
    reasons
        What would have to go for another place to cost less: what most keeps it from coming earlier, and later.
    for_travel_um
        What the plan costs more with it in the best of the other places, where nothing at all is asked of any of them;
        None where that is not so.
    better
        A place where nothing is broken and the plan would cost less: it was not found within the limit.
    known
        Whether all was judged: else nothing is said.
    only
        Whether it is the only cut.
    """

    reasons: tuple[Reason, ...] = ()
    for_travel_um: int | None = None
    better: Reason | None = None
    known: bool = True
    only: bool = False

    def lines(self, name: str) -> tuple[str, ...]:
        """The same for a page about this contour: each reason with its rule, and what it costs."""
        if not self.known or self.better is not None or not self.reasons:
            return self.sentences(name)
        named = (list(dict.fromkeys(about.rule for about in reason.abouts)) for reason in self.reasons)
        heads = (f"{', '.join(rules)}: " if len(rules) <= FEW_TOLD else "" for rules in named)
        return tuple(f"{head}{r.told()} ({r.more()})" for head, r in zip(heads, self.reasons, strict=True))

    def sentences(self, name: str) -> tuple[str, ...]:
        """The same for a plan, of the contour of that name."""
        if not self.known:
            return ()
        if self.only:
            return (f"{name} is the only cut",)
        if self.better is not None:
            mm = self.better.saved_um / UM_PER_MM
            return (
                f"no rule keeps {name} here: as number {self.better.place} the plan would cost {mm:.1f} mm less, "
                "which was not found within the limit",
            )
        if self.reasons:
            return tuple(dict.fromkeys(reason.told() for reason in self.reasons))
        if self.for_travel_um is not None:
            mm = self.for_travel_um / UM_PER_MM
            return (
                f"no rule asks anything of where {name} is cut, and every other place is longer, by {mm:.1f} mm "
                "at least: it is cut here for the shortest travel",
            )
        return (
            f"no rule decides where {name} is cut: with these entries no other place, nor a stretch turned round, "
            "makes the plan cheaper, not even against a rule",
        )


class Reasons:
    """Why the contours of one plan are where they are, as long as it is `going`; asked of one contour, or of all."""

    def __init__(
        self, setting: PlanContext, along: PositionCosts | None = None, going: Callable[[], bool] = lambda: True
    ) -> None:
        self.setting, self.places = setting, OtherPlaces(setting)
        self._along, self._going = along, going
        self._left = LOOKS
        kerfs_meet = bool(meeting_of(setting.facts.whole_nest, setting.facts.options.kerf_mm))
        self._looks = kerfs_meet or looks_at_orders(setting.facts, setting.profile)
        self._stated = {(s.about.rule, s.about.contours) for s in setting.stated.statements} if self._looks else set()

    @cached_property
    def _turned(self) -> list[tuple[frozenset[int], OtherPlace]]:
        return list(takewhile(lambda _: self._going(), self.places.turned()))

    def of(self, contour: int) -> WhyHere:
        """What decides where one contour is cut."""
        if not self.places.complete or not self._going():
            return WhyHere(known=False)
        if len(self.setting.order) == 1:
            return WhyHere(only=True)
        turned = [
            replace(way, place=way.order.index(contour) + 1 + self.setting.made)
            for among, way in self._turned
            if contour in among
        ]
        alone = list(takewhile(lambda _: self._going(), self.places.of(contour)))
        if not self._going():
            return WhyHere(known=False)
        others = [*alone, *turned]
        better = [place for place in others if not place.hard and place.more_um < -MATTERS_UM]
        found: list[Reason] = []
        if better:
            reason = self._strongest([((), -place.more_um, place) for place in better])
            if reason is None:
                return WhyHere(known=False)
            if not reason.abouts:
                return WhyHere(better=reason)
            found.append(reason)
        now = int(self.places.at[contour]) + 1 + self.setting.made
        for side in ([p for p in others if p.place < now], [p for p in others if p.place >= now]):
            if candidates := list(_candidates(side)):
                if (reason := self._strongest(candidates)) is None:
                    return WhyHere(known=False)
                found.append(reason)
        if found:
            single = [reason for reason in found if len(reason.abouts) == 1]
            return WhyHere(tuple(single or found))
        return WhyHere(for_travel_um=None if turned or alone else self._for_travel(contour))

    def _strongest(self, candidates: Sequence[tuple[tuple[About, ...], int, OtherPlace]]) -> Reason | None:
        """The reason of the fewest statements that saves most, with what geometry finds there; None if not looked."""
        ranked = sorted(candidates, key=lambda of: (_rank(of[0]), -of[1]))
        found: list[Reason] = []
        for abouts, saved_um, place in ranked[:TRIED]:
            seen = self._seen(place)
            if seen is None:
                return None
            worth = sum(um or 0 for _, um in seen)
            if all(um is not None for _, um in seen) and saved_um - worth > MATTERS_UM:
                return Reason(abouts, place.place, saved_um - worth)
            found.append(Reason((*abouts, *(about for about, _ in seen)), place.place, saved_um))
        return min(found, key=lambda reason: _rank(reason.abouts))

    def _seen(self, place: OtherPlace) -> list[tuple[About, int | None]] | None:
        """What geometry finds wrong with an order that is not stated yet, and its price, µm; None with no look left."""
        if not self._looks:
            return []
        self._left -= len(place.order)
        if self._left < 0:
            return None
        seen = lazy_statements(self.setting.facts, self.setting.profile)(place.order)
        new = (s for s in seen if (s.about.rule, s.about.contours) not in self._stated)
        return [(s.about, None if s.weight is None else cost_um(s.weight)) for s in new]

    def _for_travel(self, contour: int) -> int | None:
        """What the best of the other places costs more with the best entries, where nothing is asked of any of them."""
        n = len(self.setting.order)
        whole = n - 1 <= self.places.reach and n <= BEST_ENTRIES and not self._looks
        if not whole or any(p.hard or p.soft or p.more_um <= MATTERS_UM for p in self.places.of(contour, every=True)):
            return None
        along = self._along = self._along or PositionCosts(self.setting)
        if not along.exact:
            return None
        costs = [along.moved(place.order) for place in self.places.of(contour, every=True)]
        least = min((cost - self.setting.cost for cost in costs if cost is not None), default=None)
        return least if least is not None and least > 0 else None


def _candidates(others: Sequence[OtherPlace]) -> Iterator[tuple[tuple[About, ...], int, OtherPlace]]:
    """What would have to go for each place, and what that would save."""
    for place in others:
        worth = sum(um for _, um in place.soft)
        if place.hard and place.more_um < -MATTERS_UM:
            yield place.hard, -place.more_um, place
            continue
        alone = [(about, um) for about, um in place.soft if place.more_um - um < -MATTERS_UM]
        if not place.hard and alone:
            for about, um in alone:
                yield (about,), um - place.more_um, place
        elif place.more_um - worth < -MATTERS_UM:
            yield (*place.hard, *(about for about, _ in place.soft)), worth - place.more_um, place


def _rank(abouts: tuple[About, ...]) -> tuple[int, int]:
    """One statement before several of one rule, and these before several rules."""
    return len({about.rule for about in abouts}) if len(abouts) > 1 else 0, len(abouts)


# The same in a plan: a sentence or two for every cut.


class KeptOrders:
    """The nearest orders that contours keep, where nobody has looked what would be without them."""

    def __init__(self, setting: PlanContext) -> None:
        self._setting = setting

    @cached_property
    def _nearest(self) -> list[dict[int, Hold]]:
        return [nearest_orders(self._setting, earlier) for earlier in (True, False)]

    def sentences(self, contour: int) -> tuple[str, ...]:
        """Those of one contour; that nothing was worked out where it has none."""
        kept = tuple(f"kept: {near[contour].about.sentence}" for near in self._nearest if contour in near)
        name = self._setting.name(contour)
        return kept or (f"what decides where {name} is cut was not worked out: kerfwise explain looks at one contour",)


def with_reasons(plan: Plan, setting: PlanContext, going: Callable[[], bool] = lambda: True) -> Plan:
    """The plan with why each of its cuts comes where it does, before how that is cut, and what its cost is made of.

    Where it is not `going`, or no longer, the orders that each keeps are named, without a look at what would be without
    them.
    """
    reasons, kept = Reasons(setting, going=going) if going() else None, KeptOrders(setting)
    cuts = []
    for contour, cut in zip(setting.order, plan.items, strict=True):
        why = reasons.of(contour).sentences(setting.name(contour)) if reasons else ()
        why = why or kept.sentences(contour)
        how = next((k for k, reason in enumerate(cut.because) if reason.startswith(ENTRY)), len(cut.because))
        cuts.append(replace(cut, because=(*cut.because[:how], *why, *cut.because[how:])))
    prices = price_split(setting)
    if plan.solve.found_by == SIMULATION and plan.solve.objective is not None:
        prices = replace(prices, simulated_mm=plan.solve.objective - prices.sum_mm)
    return replace(plan.with_items(cuts), prices=prices)


def beside_limit(time_s: float | None) -> Callable[[], bool]:
    """Says whether to go on with reasons, which have a share of a limit in seconds from now on."""
    ends_s = running_s() + (inf if time_s is None else max(REASONS_S, REASONS_SHARE * time_s))
    return lambda: running_s() < ends_s


ENTRY = ("entered at ", LINKED)
"""How what a plan says of an entry begins."""


def price_split(setting: PlanContext) -> Prices:
    """The parts of a plan's objective, mm: they sum up to what the route costs; breaches of one sentence are one.

    Breaches come by rule, those of the dearest rule first, and in the order of the plan.
    """
    found: dict[About, float] = {}
    for about, um in _paid(setting):
        found[about] = found.get(about, 0.0) + um / UM_PER_MM
    of_rule: dict[str, float] = {}
    for about, mm in found.items():
        of_rule[about.rule] = of_rule.get(about.rule, 0.0) + mm
    breaches = sorted(((about, mm) for about, mm in found.items() if mm), key=lambda of: -of_rule[of[0].rule])
    whole_mm = route_cost(setting.problem, setting.route) / UM_PER_MM
    rows = tuple((about.rule, about.contours, about.sentence, mm) for about, mm in breaches)
    return Prices(whole_mm - sum(found.values()), rows)


def _paid(setting: PlanContext) -> Iterator[tuple[About, int]]:
    """What each soft statement costs on the plan's route, µm."""
    problem, route, order = setting.problem, setting.route, setting.order
    kinds = by_kind(setting.stated.statements)
    used, candidates = set(route), set(setting.candidates)
    for forbid in kinds.forbid:
        if forbid.weight is not None and forbid.candidate in candidates:
            yield forbid.about, cost_um(forbid.weight)
    for cost, about in broken_conditions(problem, route):
        if cost is not None:
            yield about, cost
    for group in problem.soft_groups:
        yield group.about, group.cost * (pieces(order, group.contours) - 1)
    number = {id(s): k for k, s in enumerate(problem.moves.statements)}  # several of one rule as it states them
    for move, k in sorted(broken_moves(problem, route), key=lambda of: number[id(of[0])]):
        if move.weight is not None:
            yield _of_move(setting, move, order[k], order[k + 1]), cost_um(move.weight)
    place = {c: k for k, c in enumerate(order)}
    times = times_ms(problem, route) if any(lag.seconds for lag in problem.lags) else {}
    for lag in problem.lags:
        if lag.weight is not None:
            missing = max(0, lag.cuts - (abs(place[lag.first] - place[lag.second]) - 1))
            yield lag.about, missing * cost_um(lag.weight) + round(lag.weight) * missing_ms(lag, times)
    for s in problem.general:
        if s.weight is not None and not general_holds(problem, s, place, used):
            yield s.about, cost_um(s.weight)
    over = {s.over: s.about for s in kinds.crossing}
    rows = problem.crossings
    if len(rows):
        stops = np.array([problem.m, *route, problem.m])
        step = {leg: k for k, leg in enumerate(pairwise(stops.tolist()))}
        on_route = np.isin(rows.leave, stops) & np.isin(rows.reach, stops)
        for k in np.flatnonzero(on_route).tolist():
            taken = step.get((int(rows.leave[k]), int(rows.reach[k])))
            contour, cost = int(rows.over[k]), int(rows.cost[k])
            if taken is not None and place[contour] < taken and cost != FORBIDDEN:
                yield over.get(contour) or over[None], cost  # what was out from the start is any contour that is cut


def _of_move(setting: PlanContext, s: Move, leave: int, reach: int) -> About:
    """What a statement about many moves says of one of them."""
    if len(s.leave) == len(s.reach) == 1:
        return s.about
    ids = setting.name(leave), setting.name(reach)
    return About(s.about.rule, ids, f"{ids[1]} directly follows {ids[0]}: {s.about.sentence}")
