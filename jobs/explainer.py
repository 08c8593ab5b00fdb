"""Why the contours of a plan are cut where they are, and what moving them would do."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.encoder.nearest_name import unknown
from kerfwise.models.plan.conflict import state_relaxed
from kerfwise.models.plan.explain.alternatives import PositionCosts, try_order
from kerfwise.models.plan.explain.context import PlanContext, make_context
from kerfwise.models.plan.explain.explain import Explanation, difference, expect_planned, explained
from kerfwise.models.plan.explain.reasons import Reasons
from kerfwise.models.plan.make_plan import excuses_by_rule
from kerfwise.models.plan.plan import Plan
from kerfwise.models.plan.read_plan import expect_plan_of, profile_change
from kerfwise.rules.statements import EXEMPTION_MM, About, Statement
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import state_rules

from .heat_control import with_heat_prices
from .inputs import Inputs, expect_of_first, of_first_torch
from .request import facts_of
from .resume import lock_broken_cut_first


class Explainer:
    """Explains the contours of one plan.

    Parameters
    ----------
    inputs
        The nest, and the profile that the plan is explained by.
    plan
        What was planned.
    facts
        Of what the plan cuts, where they are known.

    Raises InputError if a lock of the profile names what the nest does not have, or a contour cannot be cut; if the
    plan was made with another profile and this one's rules cannot all hold.
    """

    def __init__(self, inputs: Inputs, plan: Plan, facts: Facts | None = None) -> None:
        expect_plan_of(plan, inputs.nest)
        profile = lock_broken_cut_first(inputs.profile.at_origin(plan.origin), plan.already)
        state = state_relaxed if any(dropped.relaxed for dropped in plan.dropped) else state_rules
        with _check_against_plan_profile(plan, inputs):
            facts = facts or _facts_with_plan_zones(facts_of(inputs.nest, profile, plan.already), plan)
            stated = state(facts, profile)
        if profile.objective.heat:
            stated = with_heat_prices(facts, profile, stated)
        self.facts, self.profile, self.stated, self.plan = facts, profile, stated, of_first_torch(plan)
        self.whole_plan = plan

    @cached_property
    def setting(self) -> PlanContext:
        """The plan as the engines would see it.

        Raises InputError if the plan is not one of this nest.
        """
        return make_context(self.facts, self.profile, self.stated, self.plan)

    @cached_property
    def _along(self) -> PositionCosts:
        return PositionCosts(self.setting)

    @cached_property
    def _reasons(self) -> Reasons:
        return Reasons(self.setting, self._along)

    def explain(self, contour: str) -> Explanation:
        """What holds the contour in its place, why it is entered so, and what moving it would cost.

        Raises InputError if the plan does not cut such a contour; the nearest id is named.
        """
        expect_of_first(self.whole_plan, contour)
        expect_planned(self.facts, self.plan, contour)
        return explained(self.setting, self.plan, contour, self._along, self._reasons)


@contextmanager
def _check_against_plan_profile(plan: Plan, inputs: Inputs) -> Iterator[None]:
    """What a profile has against the nest is told with the profile of the plan, where that is another one."""
    try:
        yield
    except (InputError, RulesConflict) as error:
        if not (text := profile_change(plan, inputs.profile)):
            raise
        details = error.details if isinstance(error, InputError) else error.reasons
        raise InputError(f"{text}; by this one it cannot be explained: {error.message}", details=details) from error


def _facts_with_plan_zones(facts: Facts, plan: Plan) -> Facts:
    """The facts with the zones of the plan, which need not be those that geometry alone has made."""
    zones = {planned.cut.contour: planned.cut.zone for planned in plan.cuts if planned.cut.zone}
    found = [zones.get(contour.id, int(zone)) for contour, zone in zip(facts.nest.contours, facts.zone, strict=True)]
    return replace(facts, zone=np.array(found, dtype=np.int64))


# What moving contours of a plan to another place would do, answered at once: what it costs, or what forbids it.


@dataclass(frozen=True, slots=True)
class MovePreview:
    """A plan's contours moved to another place, the others in the order that they had.

    Attributes
    ----------
    contours
        What is moved, in the order in which it is cut.
    place
        Where the first of them is cut then, from 1.
    breaks
        What forbids it: none for a lawful move.
    more_mm
        What the plan costs more than now with the best entries along the new order; None where it is forbidden.
    looked
        Whether what only geometry finds in a whole order, such as narrow strips, is in the answer.
    excused
        The hard rules that do not hold at more places than now; they allow it, at a price that is in `more_mm`.
    """

    contours: tuple[str, ...]
    place: int
    breaks: tuple[About, ...] = ()
    more_mm: float | None = None
    looked: bool = False
    excused: tuple[str, ...] = ()

    @property
    def lawful(self) -> bool:
        """Whether nothing forbids it."""
        return not self.breaks

    @property
    def sentence(self) -> str:
        """The same in words.

        Examples
        --------
        >>> MovePreview(("P2.outer",), 1, (), 12.5).sentence
        'P2.outer can be cut as number 1: 12.5 mm more'
        """
        text = f"{self.contours[0]}{f' and {len(self.contours) - 1} more' if len(self.contours) > 1 else ''}"
        if self.more_mm is not None:
            return f"{text} can be cut as number {self.place}: {difference(round(self.more_mm * UM_PER_MM))}"
        first = self.breaks[0]
        more = f" (and {len(self.breaks) - 1} more)" if len(self.breaks) > 1 else ""
        return f"{text} cannot be cut as number {self.place}: {first.rule}: {first.sentence}{more}"


class Mover:
    """Judges moves of one plan; what the rules state is worked out once, and each move in hundredths of a second."""

    def __init__(self, explainer: Explainer) -> None:
        self._explainer = explainer
        self._without: tuple[frozenset[str], PlanContext] | None = None

    def move(
        self, contours: Collection[str], place: int, given_up: Iterable[str] = (), look: bool = False
    ) -> tuple[MovePreview, tuple[int, ...]]:
        """Contours moved together, the first of them to a place (from 1), and the route along the new order.

        `place`: that of the first; the others follow it in the order that they have. `given_up`: why locks are there
        (`Lock.because`) that do not count: the move takes their place. `look`: also look for what only geometry finds,
        which takes longer. Raises InputError if the plan does not cut a contour of that name, or has no such place.
        """
        setting = self._setting(frozenset(given_up))
        index = setting.facts.nest.index
        for name in contours:
            if name not in index:
                raise InputError(unknown("contour", name, index))
        numbers = {index[name] for name in contours}
        unit = [c for c in setting.order if c in numbers]
        rest = [c for c in setting.order if c not in numbers]
        at = place - 1 - setting.made
        if not 0 <= at <= len(rest):
            raise InputError(f"place {place}: expected one from {setting.made + 1} to {setting.made + len(rest) + 1}")
        order = [*rest[:at], *unit, *rest[at:]]
        names = tuple(setting.name(c) for c in unit)
        tried = try_order(setting, order, look=look)
        if tried.cost is None:
            return MovePreview(names, place, tried.breaks, None, look), ()
        more_mm, excused = (tried.cost - setting.cost) / UM_PER_MM, Counter[str]()
        if more_mm > EXEMPTION_MM / 2:
            excused = _excuses(setting, tried.route) - _excuses(setting, setting.route)
        if look:
            seen = self._seen(order)
            more_mm += _price_mm(seen) - _price_mm(self._seen_now)
            excused += _excuses_seen(seen) - _excuses_seen(self._seen_now)
        return MovePreview(names, place, (), more_mm, look, tuple(sorted(excused))), tried.route

    def has_room(self, contours: Collection[str], place: int, given_up: Iterable[str] = ()) -> bool:
        """Whether the hard orders leave the place open once the others may move: enough can come before, and after.

        What must come before the contours, directly or by way of others, fits before the place, and so does the rest
        behind it. Zones and lags are not looked at: a plan may still not be found.
        """
        setting = self._setting(frozenset(given_up))
        index, before = setting.facts.nest.index, setting.problem.before
        moved = [index[name] for name in contours if name in index]
        ahead = set(np.flatnonzero(before[:, moved].any(axis=1)).tolist()).difference(moved)
        behind = set(np.flatnonzero(before[moved].any(axis=0)).tolist()).difference(moved)
        at = place - 1 - setting.made
        left = len(setting.order) - len(moved) - at
        return not ahead & behind and len(ahead) <= at and len(behind) <= left

    def _setting(self, given_up: frozenset[str]) -> PlanContext:
        """The setting of the plan; without locks that do not count it is made anew, and kept for the next question."""
        if not given_up:
            return self._explainer.setting
        if self._without is None or self._without[0] != given_up:
            of = self._explainer
            left = tuple(s for s in of.stated.statements if not _says(s.about, given_up))
            self._without = given_up, make_context(of.facts, of.profile, replace(of.stated, statements=left), of.plan)
        return self._without[1]

    @cached_property
    def _seen_now(self) -> tuple[Statement, ...]:
        return self._seen(self._explainer.setting.order)

    def _seen(self, order: Sequence[int]) -> tuple[Statement, ...]:
        """What only geometry finds in an order."""
        return lazy_statements(self._explainer.facts, self._explainer.profile)(order)


def _price_mm(seen: Iterable[Statement]) -> float:
    return sum(statement.weight or 0.0 for statement in seen)


def _excuses_seen(seen: Iterable[Statement]) -> Counter[str]:
    return Counter(statement.about.rule for statement in seen if statement.weight == EXEMPTION_MM)


def _excuses(setting: PlanContext, route: Iterable[int]) -> Counter[str]:
    """By rule, the excuses of a route (sites)."""
    candidates = [int(setting.problem.site_candidate[site]) for site in route]
    return excuses_by_rule(setting.facts, setting.stated, candidates)


def _says(about: About, reasons: Iterable[str]) -> bool:
    return any(about.sentence.endswith(reason) for reason in reasons)
