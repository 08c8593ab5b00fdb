"""What is shown while a plan is made: plans that are better and better, and the phase in a planner's words."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from kerfwise.encoder.already_cut import AlreadyCut
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.first_plan import AtHand, first_plan, paid_for, plan_at_hand
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.plan_without_zones import paying_for_crossings
from kerfwise.jobs.request import Request, facts_of, make_request
from kerfwise.jobs.resume import lock_broken_cut_first
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.jit import made_s, running_s
from kerfwise.models.plan.plan import Plan
from kerfwise.pipeline import Planned, VerifiedPlan, judged, plan_of, seen_after, verified
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.verdict.check_plan import check_plan
from kerfwise.rules.lock import check_locks
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import EXEMPTION_MM

from .plan_request import Questions

SHOWN_EACH_S, SHOWN_SHARE = 1.0, 4.0
"""A better plan is shown no sooner after the one before, and after so many times as long as that took to be judged."""
SHOWN_GAIN = 1e-3
"""Share of its cost by which a plan is better at the least where it is shown before the end."""
FEW, BARE_FROM = 8, 100
"""Contours up to which no first plan is looked for, the best one is found as soon; and from which on a first plan is
shown before its program is written."""
BETTER_WORK, BETTER_SHARE = 0.3, 0.1
"""Work of a short search from the first plan on, and the most of it as a share of the work of the whole."""
MOST_PLANS = 4
"""Plans that are known by their texts."""
COMPILES_S, LOOKED_S = 1.0, 0.25
"""Compiling that takes so long is told; how often that is looked at."""


def phase_of(engine: str) -> str:
    """What an engine does, as a planner would say it."""
    return "improving" if engine in ("search", "zones", "") else "proving"


class ShownGap:
    """The share by which the plan that is shown may be too dear: it only falls, and is of no other plan.

    Each set of zones that is tried has a bound of its own, so what the engines tell goes up and down.
    """

    def __init__(self) -> None:
        self._shown_mm = self._least = math.inf
        self.now: float | None = None

    def show(self, objective_mm: float) -> None:
        """Another plan is shown: nothing is known of it until the engines tell something about it."""
        self._shown_mm, self.now = objective_mm, None

    def hear(self, objective_mm: float | None, bound_mm: float | None) -> float | None:
        """What the engines have reached; the gap, None where nothing is known, or excuses hide the travel.

        Examples
        --------
        >>> gap = ShownGap()
        >>> gap.show(100.0)
        >>> gap.hear(100.0, 90.0), gap.hear(120.0, 119.0), gap.hear(100.0, 80.0), gap.hear(100.0, 95.0)
        (0.1, 0.1, 0.1, 0.05)
        """
        if objective_mm is None or bound_mm is None or not 0 < objective_mm < EXEMPTION_MM:
            return self.now
        told = round(max(0.0, 1 - bound_mm / objective_mm), 6)
        if abs(objective_mm - self._shown_mm) <= SHOWN_GAIN * self._shown_mm and told <= self._least:
            self.now = self._least = told
        return self.now


@contextmanager
def told_while_compiling(asking: Questions) -> Iterator[None]:
    """Tell that code is compiled, which is done once for each machine, while it is."""
    ended = threading.Event()

    def watch() -> None:
        made, since_s = made_s(), time.monotonic()
        while not ended.wait(LOOKED_S):
            if made_s() == made:  # nothing is being compiled
                since_s = time.monotonic()
            elif time.monotonic() - since_s > COMPILES_S:
                asking.tell(phase="getting ready")
            made = made_s()

    watching = threading.Thread(target=watch, daemon=True)
    watching.start()
    try:
        yield
    finally:
        ended.set()
        watching.join()


class PlansShown:
    """Shows the first lawful plan, and then those that are better, each with its program and the verdict on both.

    The first plan of many contours is shown once it is lawful by itself; its program is written and checked then.
    `facts` are those of the nest, where they were asked for a first plan, and no place is locked. `best` is the last
    plan that was shown.

    Parameters
    ----------
    asking
        Who is told.
    inputs, already, limits
        Nest and profile, what of it is cut already, and the limits of the whole planning.
    kept
        Makes of a plan what is told of it.
    """

    def __init__(
        self,
        asking: Questions,
        inputs: Inputs,
        already: AlreadyCut,
        limits: SolveOptions,
        kept: Callable[[VerifiedPlan], dict[str, Any]],
    ) -> None:
        self._asking, self._given, self._already, self._limits, self._kept = asking, inputs, already, limits, kept
        self._profile = lock_broken_cut_first(inputs.profile, already)
        self._best_mm, self._next_s = math.inf, 0.0
        self.gap = ShownGap()
        self.facts: Facts | None = None
        self.best: Plan | None = None

    @property
    def judged_slowly(self) -> bool:
        """Whether a plan is lawful only by a simulation that takes as long as planning: none is shown meanwhile."""
        return self._given.profile.temperature_limit() is not None

    @property
    def unpriced(self) -> bool:
        """Whether plans on the way do not pay for overheats, which the profile prices: a simulation tells them last."""
        return self._given.profile.prices_overheats

    def first(self, start: Plan | None, recent: RecentFacts) -> None:
        """A lawful plan at once, and what a short search makes of it; none where the best is found as soon."""
        self._next_s = time.monotonic() + SHOWN_EACH_S  # it may be proven by then
        if self.judged_slowly or len(self._given.nest.contours) <= FEW:
            return
        self._asking.tell(phase="first plan")
        try:
            facts = recent.of(self._given.nest, self._profile, self._already)
            self.facts = None if any(lock.position for lock in self._profile.locks) else facts
            first = self._at_once(facts, start)
        except (InputError, RulesConflict):  # the planning itself says what is wrong
            return
        if first is None or not self._shows(first, "first") or not self._asking.go_on():
            return
        work = min(BETTER_WORK, BETTER_SHARE * self._limits.work)
        better = first_plan(first.asked, self._profile, self._limits, first, self._progress, moves=None, work=work)
        if better is not None:
            self._shows(AtHand(better.asked, better.solution), "better")

    def _at_once(self, facts: Facts, start: Plan | None) -> AtHand | None:
        """The plan at hand as far as what is wanted lets it; else what a short search finds."""
        known = None if start is None else plan_at_hand(facts, self._profile, self._limits, start)
        if known is not None:
            return known
        request = make_request(facts, self._profile)
        found = first_plan(request, self._profile, self._limits, None, self._progress, moves=None)
        return None if found is None else AtHand(found.asked, found.solution)

    def _progress(self, engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        return self._asking.go_on()

    def found(self, request: Request, solution: Solution) -> None:
        """Show a plan that the engines have found, where it is much better than the last, and that was not just now."""
        if time.monotonic() >= self._next_s and self._asking.go_on():
            stage = "better" if self._best_mm < math.inf else "first"
            self._shows(AtHand(request, solution), stage, looked=False)

    def _shows(self, plan: AtHand, stage: str, looked: bool = True) -> bool:
        if plan.solution.objective >= self._best_mm * (1 - SHOWN_GAIN):
            return False
        began_s = time.monotonic()
        on_the_way = PlanOnTheWay(plan.asked, self._profile, plan.solution, self._limits, looked)
        if on_the_way.objective >= self._best_mm * (1 - SHOWN_GAIN):
            return False
        bare = stage == "first" and plan.asked.facts.n >= BARE_FROM
        verified = on_the_way.lawful() if bare else on_the_way.verified()
        if not verified.verdict.ok:
            return False
        self._best_mm = float(verified.plan.solve.objective)
        self.gap.show(self._best_mm)
        more = {"stage": stage, "unpriced": self.unpriced}
        self._asking.tell(plan=self._kept(verified) | more, phase="checking" if bare else "improving")
        if bare and self._asking.go_on():
            verified = on_the_way.verified()
            self._asking.tell(checked=self._kept(verified) | more, phase="improving")
        self.best, now_s = verified.plan, time.monotonic()
        self._next_s = now_s + max(SHOWN_EACH_S, SHOWN_SHARE * (now_s - began_s))
        return verified.verdict.ok


class PlanOnTheWay:
    """The plan of a route that was found meanwhile, at the price of all that is asked, without reasons for its order.

    It is judged bit by bit: `lawful` by itself, without a program, and `verified` with its program.

    Parameters
    ----------
    request
        What was asked of the route.
    looked
        Whether the route pays already for what geometry finds in the whole order.
    """

    def __init__(
        self, request: Request, profile: Profile, solution: Solution, limits: SolveOptions, looked: bool = True
    ) -> None:
        seen = seen_after(request.facts, profile, solution.route)
        if not looked:  # what a hard rule forbids the check tells
            solution = replace(solution, objective=solution.objective + (paid_for(seen) or 0.0))
        solution = paying_for_crossings(request, solution)
        plan = plan_of(request, profile, solution, limits, seen, reasons=False)
        self._planned, self._profile = Planned(request.facts, plan, solution), profile
        self._verdict: CheckResult | None = None

    @property
    def objective(self) -> float:
        """What it costs, mm."""
        return self._planned.solution.objective

    def lawful(self) -> VerifiedPlan:
        """The plan with the verdict on itself; there is no program yet, and nothing is known of one."""
        facts, began_s = self._planned.facts, running_s()
        verdict = self._verdict = check_plan(facts.whole_nest, self._planned.plan, self._profile)
        plan = judged(self._planned.plan, verdict, facts, self._profile)
        return VerifiedPlan(plan, "", verdict, self._planned.solution.notes, facts, running_s() - began_s)

    def verified(self) -> VerifiedPlan:
        """The plan with its program, and the verdict on both."""
        return verified(self._planned, self._profile, lawful=self._verdict)


class RecentFacts:
    """The facts of the nest that was planned last, as if no place was locked: so one more such lock changes none.

    Zones that geometry makes go with locked places. A first plan has the zones of the plan at hand, or is one without.
    """

    def __init__(self) -> None:
        self._known: tuple[Nest, Profile, str, Facts] | None = None

    def of(self, nest: Nest, profile: Profile, already: AlreadyCut) -> Facts:
        """As `facts_of` finds them without locked places. Raises InputError, RulesConflict as `facts_of` does."""
        if profile.machine.torches.several:  # contours with a locked place are cut one by one
            return facts_of(nest, profile, already)
        check_locks(profile.locks, nest)
        bare = (replace(lock, position=None) for lock in profile.locks)
        by = replace(profile, locks=tuple(lock for lock in bare if lock.wrong() is None))
        known = self._known
        if already:
            return facts_of(nest, by, already)
        if known is None or known[0] is not nest or known[1:3] != (by, profile.sha256):
            self._known = known = (nest, by, profile.sha256, facts_of(nest, by))
        return known[3]
