"""The way of one nest, step by step: measure, state, solve, plan, write, check.

`plan_nest` calls these steps in this order:

| step | function | gives |
|---|---|---|
| measure | `jobs/request.py: facts_of` | candidates and facts of the nest, or of what the first torch cuts |
| state | `jobs/request.py: make_request` | the statements of the profile's rules |
| solve | `plan_request` | a route: by the engine, by a simulation, within a temperature, with zones that move |
| plan | `plan_of` | cuts with reasons and times; further torches and a pierce pass where the profile has them |
| write, check | `verified` | the program, and the verdict on plan and program |
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.jobs.adaptive_zones import ZonedPlan, better_zones, plan_by_rungs, zones_follow
from kerfwise.jobs.by_engine import PORTFOLIO, Method, solve_by, with_less_work
from kerfwise.jobs.gantry import completed
from kerfwise.jobs.inputs import Inputs, Tell, silent
from kerfwise.jobs.plan_without_zones import is_look_worthwhile, paying_for_crossings, zoned_by
from kerfwise.jobs.progress import Listener
from kerfwise.jobs.request import Found, NoPlan, Request, expect_no_shared_edges, facts_of, make_request, ways_on
from kerfwise.jobs.resume import lock_broken_cut_first
from kerfwise.jobs.time_limits import CommandLimit, JobLimit
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import Solution, SolveOptions
from kerfwise.models.engines.tuning import LARGE_NEST as FEW
from kerfwise.models.engines.tuning import UNZONED_SHARE as SHARE
from kerfwise.models.jit import running_s
from kerfwise.models.plan.explain.context import solved_context
from kerfwise.models.plan.explain.reasons import beside_limit, with_reasons
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.read_program import Trusted
from kerfwise.postproc.check.stated import with_state
from kerfwise.postproc.clock import cost_of_plan
from kerfwise.postproc.dialects import dialect_misfits, expect_words
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, check_written, judge, judged_by_both, report_of
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.options.yaml_positions import raise_together
from kerfwise.rules.plan_state import PlanState
from kerfwise.rules.profile.contradictions import misfits
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.rule import TemperatureLimit
from kerfwise.rules.statements import Statement
from kerfwise.rules.stating.lazy_statements import lazy_statements
from kerfwise.rules.stating.state_rules import Stated

if TYPE_CHECKING:
    from kerfwise.jobs.cooler_orders import SimulatedOrders


Promise = Callable[[], CheckResult | None]
"""The verdict on a plan, by whoever judges it meanwhile; None where that has failed."""


@dataclass(frozen=True, eq=False, slots=True)
class FinishedPlan:
    """What the main job has made: of which nest and profile, of which facts, and what came of them.

    The profile has a lock on a cut that broke off, where the program goes on after a stop.
    """

    given: Inputs
    facts: Facts
    made: VerifiedPlan


class Watchers(NamedTuple):
    """Who hears of a plan while it is made.

    Attributes
    ----------
    listener
        Hears how far the engines are, and may say stop.
    tell
        Told what took long beside a limit in seconds.
    found
        Told each better plan of the portfolio meanwhile, which changes nothing; no plan by other zones, and none that a
        simulation has asked for.
    planned
        Told the plan before it is judged: nothing but its rules and its cost will change. It may promise the verdict.
    """

    listener: Listener | None = None
    tell: Tell = silent
    found: Found | None = None
    planned: Callable[[Plan], Promise | None] | None = None


NOBODY = Watchers()


def plan_nest(
    inputs: Inputs,
    limits: SolveOptions,
    method: Method = PORTFOLIO,
    watchers: Watchers = NOBODY,
    *,
    already: AlreadyCut = NOTHING_CUT,
    relax: bool = False,
    whole: CommandLimit | None = None,
    facts: Facts | None = None,
) -> FinishedPlan:
    """Plan a nest, or what is left of it, write the program, and judge both.

    Parameters
    ----------
    inputs
        Nest and profile.
    limits
        Of the plan, as `options_for` makes them.
    already
        What a stopped program has cut.
    relax
        Where hard rules clash, the cheapest statements give way, marked in the plan.
    whole
        A limit of the command that this is part of, in place of one in seconds for the planning alone.
    facts
        What `facts_of` finds of the same nest, profile and cuts, where it was asked before.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, the dialect does not fit, a contour cannot be cut, or the method
        does not go with its engine.
    RulesConflict
        If contours cannot be cut and hard rules cannot hold in any order.
    NoPlan
        If the hard rules cannot all hold, or no plan was found. What contradicts what is looked for within `limits`
        once more, or in what is left of `whole`, unless the user has interrupted.
    """
    nest, profile = inputs.nest, lock_broken_cut_first(inputs.profile, already)
    if wrong := [*dialect_misfits(profile)]:
        raise_together((*wrong, *misfits(profile, nest, bool(already))))
    dialect = trusted_dialect(profile)  # a file of the plant's own may be wrong: better said now than at the end
    expect_words(nest, profile, dialect, resumes=bool(already))
    method.expect_fits(profile)
    limit, listener = whole or JobLimit(), watchers.listener or Listener()
    limit.begin(limits, watchers.tell)
    if facts is None:
        zoned = relax or method.looks_at_zones(len(nest.contours), profile)
        facts = facts_of(nest, profile, already, limit, zoned=zoned)
    try:
        request = make_request(facts, profile, relax, limit.facts_made())
        left = limit.stated()
        orders = method.orders
        if profile.objective.distortion and orders is None:
            watchers.tell("objective.distortion is not looked at here: only `solve` chooses plans by it")
        with listener:
            progress = limit.watched(listener)
            simulated = None if orders is None else orders(facts, profile, request.stated)
            planned = plan_request(
                request, profile, left, method, progress, watchers.found, simulated=simulated, move_zones=True
            )
            finished = verified(planned, profile, promise=_promised(watchers, planned, inputs, profile))
    except RulesConflict as error:
        raise _no_plan(
            error, facts, profile, limit, listener, ways_on(limits, method.engine, relax, error.proven)
        ) from error
    limit.ended(finished.judging_s)
    return FinishedPlan(Inputs(nest, profile), finished.facts, finished)


def _promised(watchers: Watchers, planned: Planned, inputs: Inputs, profile: Profile) -> Promise | None:
    """What is promised of a plan that is told; nothing of another nest, or by another profile, than `inputs` have."""
    promise = None if watchers.planned is None else watchers.planned(planned.plan)
    as_cut, nest = planned.facts.whole_nest, inputs.nest
    same = (as_cut.drawn or as_cut) is (nest.drawn or nest) and profile is inputs.profile
    return promise if same else None


def _no_plan(
    error: RulesConflict, facts: Facts, profile: Profile, limit: JobLimit, listener: Listener, ways: tuple[str, ...]
) -> NoPlan:
    """What contradicts what, looked for unless the user has interrupted.

    Raises Questions if one about shared edges would settle it.
    """
    from kerfwise.models.engines.deadline import Deadline
    from kerfwise.models.plan.conflict import NotAnswered, find_conflict

    try:
        until = Deadline.of(limit.without_plan())
        conflict = None if listener.interrupted else find_conflict(facts, profile, until)
    except NotAnswered:
        return NoPlan(error, facts, profile, within_limit=False, ways=ways)
    if conflict is not None and conflict.alone:
        expect_no_shared_edges(facts.nest, profile)
    return NoPlan(error, facts, profile, conflict, ways=() if listener.interrupted else ways)


# From what is asked to a route, and on to a plan.


@dataclass(frozen=True, eq=False, slots=True)
class Planned:
    """A plan, the solution that it is of, and the facts of both: zones may have moved along a plan without them."""

    facts: Facts
    plan: Plan
    solution: Solution


@dataclass(frozen=True, eq=False, slots=True)
class _Solving:
    """What the steps of solving share."""

    request: Request
    profile: Profile
    limits: SolveOptions
    method: Method
    progress: Progress | None
    found: Found | None
    start: tuple[int, ...] = ()
    looked: dict[tuple[int, ...], tuple[Statement, ...]] = field(default_factory=dict)

    def solved(self, share: float = 1.0, stated: Stated | None = None, further: tuple[Statement, ...] = ()) -> Solution:
        """What the engine finds with a share of the limits."""
        time_s = self.limits.time_s
        part = replace(self.limits, work=self.limits.work * share, time_s=time_s and time_s * share)
        request = self.request if stated is None else Request(self.request.facts, stated)
        hear = None if self.found is None else partial(self.found, request)
        return solve_by(self.method, request, self.profile, part, further, self.progress, hear, self.start)

    def seen(self, route: tuple[int, ...]) -> tuple[Statement, ...]:
        """What geometry finds in the whole order of a route; to look takes long, and is done once."""
        if route not in self.looked:
            self.looked[route] = seen_after(self.request.facts, self.profile, route)
        return self.looked[route]

    def plan(self, solution: Solution, *, reasons: bool = True) -> Plan:
        """The plan of a solution; a first one names the orders that its cuts keep."""
        seen, first = self.seen(solution.route), self.method.first
        return plan_of(
            self.request, self.profile, solution, self.limits, seen, self.method.named, reasons=reasons, at_once=first
        )


def plan_request(
    request: Request,
    profile: Profile,
    limits: SolveOptions,
    method: Method = PORTFOLIO,
    progress: Progress | None = None,
    found: Found | None = None,
    *,
    simulated: SimulatedOrders | None = None,
    move_zones: bool = False,
) -> Planned:
    """The best plan that is found of what is asked.

    Where the profile puts a price on overheats, the nest is simulated many times over. With a limit of temperature
    orders are simulated, and get waits. Else the engine plans, or, where geometry alone makes the zones, zones follow
    the best plan known without them.

    Parameters
    ----------
    progress, found
        As `Watchers` has them.
    simulated
        What was simulated before of the same nest by the same rules.
    move_zones
        Have zones move where that pays, and the plan say what they cost, which takes a share of a limit in seconds, or
        work beside that of the plan.

    Raises RulesConflict if no lawful plan exists, or none was found.
    """
    began_s, contours = running_s(), request.facts.n
    ends_s = None if limits.time_s is None else began_s + limits.time_s
    move_zones = move_zones and _may_zones_move(request, profile, limits, method)
    whole = limits
    if move_zones and limits.time_s is not None and contours <= FEW:  # larger nests have what the first plan leaves
        limits = replace(limits, time_s=limits.time_s * (1 - 2 * SHARE))
    solving = _Solving(request, profile, limits, method, progress, found)

    priced, plan = None, None
    price_mm = profile.objective.heat if simulated is None else simulated.price_mm(profile)
    if method.strategy == "ours" and price_mm and profile.heat.absorbed_power_w:
        from kerfwise.jobs.heat_control import solve_priced

        priced, stated = solve_priced(request, profile, limits, solving.solved, progress, simulated)
        solving = replace(solving, request=Request(request.facts, stated))
    known: ZonedPlan | None = None
    zoned: ZonedPlan | None = None
    if (temperature := profile.temperature_limit()) is not None:
        solution, plan = _within(temperature, solving, began_s)
    elif priced is not None:
        solution = priced
    else:
        if (known := _known_plan(solving)) is not None:
            zoned = known if method.first else None
            solving = replace(solving, start=known.solution.route)
        if zoned is None and move_zones and zones_follow(request):
            zoned = plan_by_rungs(request, profile, whole, ends_s, progress, found=found, start=solving.start)
        if zoned is not None:
            solution = zoned.solution
        elif method.is_portfolio:
            solution = with_less_work(solving.solved, contours, limits, progress)
        else:
            solution = solving.solved()

    request = solving.request
    best = zoned or ZonedPlan(request, solution, None)
    if move_zones and zoned is None:
        further, stays = solving.seen(solution.route), plan is not None or priced is not None
        best = better_zones(request, further, profile, solution, whole, ends_s, progress, may_move=not stays)
    if known is not None and known.solution.objective < paying_for_crossings(best.asked, best.solution).objective:
        best = replace(known, free=best.free)
    if best.asked is not request:
        solving, plan = replace(solving, request=best.asked, looked={}), None
    plan = replace(plan or solving.plan(best.solution), zones_cost=best.cost(limits))
    return Planned(best.asked.facts, plan, best.solution)


def _may_zones_move(request: Request, profile: Profile, limits: SolveOptions, method: Method) -> bool:
    """Whether a plan without zones is looked for."""
    facts = request.facts
    looks = facts.copies is None and method.is_portfolio and is_look_worthwhile(facts.n, limits)
    return looks and bool(zoned_by(facts, profile))


def _known_plan(solving: _Solving) -> ZonedPlan | None:
    """The plan at hand under what is asked now, to go on from; or a first plan, along that or from nothing."""
    start, first, request = solving.method.start, solving.method.first, solving.request
    if start is None and not first:
        return None
    from kerfwise.jobs.first_plan import first_plan, plan_at_hand

    at_hand = None
    if start is not None:
        at_hand = plan_at_hand(request.facts, solving.profile, solving.limits, start, request, keep=first)
    if first:
        return first_plan(request, solving.profile, solving.limits, at_hand, solving.progress)
    return None if at_hand is None else ZonedPlan(at_hand.asked, at_hand.solution, None)


def _within(limit: TemperatureLimit, solving: _Solving, began_s: float) -> tuple[Solution, Plan]:
    """A plan that keeps to a limit of temperature."""
    from kerfwise.jobs.heat_control import Cooler

    request, method = solving.request, solving.method
    time_s, progress = solving.limits.time_s, solving.progress

    def going() -> bool:
        in_time = time_s is None or running_s() - began_s < time_s
        return in_time and (progress is None or progress(limit.rule, None, None))

    cooler = Cooler(
        request.facts,
        solving.profile,
        limit,
        request.stated.statements,
        lambda share, further: solving.solved(share, further=further),
        partial(solving.plan, reasons=False),
        solving.plan,
        going,
    )
    again = (
        method.strategy == "ours" and method.engine != "minizinc"
    )  # others cannot be asked for more than rules state
    return cooler.find(again)


def seen_after(facts: Facts, profile: Profile, route: tuple[int, ...]) -> tuple[Statement, ...]:
    """What geometry finds in the whole order of a route."""
    return lazy_statements(facts, profile)([facts.candidates[c].contour for c in route])


def plan_of(
    request: Request,
    profile: Profile,
    solution: Solution,
    limits: SolveOptions,
    seen: tuple[Statement, ...],
    engine: str = "portfolio",
    *,
    reasons: bool = True,
    at_once: bool = False,
) -> Plan:
    """The plan of a solution, timed, with what was `seen` in its order; without `reasons` in a tenth of the time.

    Reasons take no more than a small part of a limit in seconds.
    """
    facts = request.facts
    stated = replace(request.stated, statements=(*request.stated.statements, *seen))
    plan = make_plan(facts, profile, stated, solution, engine, limits.seed)
    if reasons:
        going = (lambda: False) if at_once else beside_limit(limits.time_s)
        plan = with_reasons(plan, solved_context(facts, profile, stated, solution), going)
    return completed(plan, facts, profile, stated, solution, limits)


# From a plan to its program, and the verdict on both.

Write = Callable[[Plan, Nest, Profile], str]
"""Makes the program of a plan."""


@dataclass(frozen=True, eq=False, slots=True)
class VerifiedPlan:
    """A plan with the rules' verdicts in it, its NC program, the whole verdict, and what the engines had to say.

    `facts` are those it was made of: zones may have moved along a plan that was found without them.
    `judging_s` is how long the program and the judging of it took by the clock, which no limit counts.
    """

    plan: Plan
    program: str
    verdict: CheckResult
    notes: tuple[str, ...]
    facts: Facts
    judging_s: float = 0.0


def verified(
    planned: Planned,
    profile: Profile,
    write: Write | None = None,
    trusted: Trusted | None = None,
    lawful: CheckResult | None = None,
    promise: Promise | None = None,
) -> VerifiedPlan:
    """A plan with its program, and the verdict on both in it.

    Parameters
    ----------
    write
        Makes the program in another way.
    trusted
        Words of the program that are not judged.
    lawful
        The verdict on the plan alone, where it is known.
    promise
        Gives that while the program is read back.
    """
    began_s, facts, plan = running_s(), planned.facts, planned.plan
    nest, write, written = facts.whole_nest, write or write_program, None
    if promise is None:
        lawful = check_plan(nest, plan, profile) if lawful is None else lawful
        program = write(replace(plan, state=lawful.state), nest, profile)  # the program says it, too
    else:
        found = cache(lambda: promise() or check_plan(nest, plan, profile))
        draft = replace(plan, state=PlanState("broken"))  # who says that is never told to say less
        program = write(draft, nest, profile)
        written, lawful = check_written(nest, draft, program, profile, lambda: found().by_rules, trusted), found()
        program = with_state(program, lawful.state)  # what was read back, but for that comment
    plan = replace(plan, state=lawful.state)
    if written is not None and written.state.short() == lawful.state.short():
        verdict = judged_by_both(lawful, written, program)
    else:
        verdict = judge(nest, plan, program, profile, trusted, lawful)
    if verdict.state.short() != lawful.state.short():
        program = with_state(program, verdict.state)
        verdict = judge(nest, plan, program, profile, trusted, lawful)
    judging_s, notes = running_s() - began_s, planned.solution.notes
    return VerifiedPlan(judged(plan, verdict, facts, profile), program, verdict, notes, facts, judging_s)


def solve_and_verify(
    request: Request,
    profile: Profile,
    limits: SolveOptions,
    method: Method = PORTFOLIO,
    *,
    simulated: SimulatedOrders | None = None,
    move_zones: bool = False,
) -> VerifiedPlan:
    """Plan what is asked, write the program, and judge both; see `plan_request`.

    Raises RulesConflict if no lawful plan exists, or none was found.
    """
    planned = plan_request(request, profile, limits, method, simulated=simulated, move_zones=move_zones)
    return verified(planned, profile)


def judged(plan: Plan, verdict: CheckResult, facts: Facts, profile: Profile) -> Plan:
    """The plan with a verdict in it, and what it costs."""
    cost = cost_of_plan(plan, facts.whole_nest, profile)
    return replace(plan, rules=report_of(verdict, profile), state=verdict.state, cost=cost)
