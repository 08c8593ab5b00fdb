"""The main job: a nest and a profile become a plan, its program and the verdict on both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING

from kerfwise.encoder.already_cut import NOTHING_CUT, AlreadyCut
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines import Engine, Strategy
from kerfwise.models.engines.deadline import Progress
from kerfwise.models.engines.solution import Solution, SolveOptions, Status
from kerfwise.models.engines.tuning import UNZONED_FEW as FEW
from kerfwise.models.engines.tuning import UNZONED_SHARE as SHARE
from kerfwise.models.jit import running_s
from kerfwise.models.plan.explain.context import solved_context
from kerfwise.models.plan.explain.reasons import with_reasons
from kerfwise.models.plan.make_plan import make_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.read_program import Trusted
from kerfwise.postproc.check.stated import with_state
from kerfwise.postproc.clock import cost_of_plan, with_times
from kerfwise.postproc.dialects import expect_words
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.check_plan import check_plan, judge, report_of
from kerfwise.postproc.verdict.dialect_read_back import trusted_dialect
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Statement
from kerfwise.rules.stating.lazy_statements import lazy_statements, look_takes_s
from kerfwise.rules.stating.state_rules import Stated

from .adaptive_zones import ZonedPlan, better_zones, plan_by_rungs, rungs, zones_follow
from .first_plan import first_plan, paid_for, plan_at_hand
from .gantry import with_further_torches
from .inputs import Inputs, Tell, expect_one_torch, silent
from .pierce_pass import with_pierces
from .plan_without_zones import is_look_worthwhile, zoned_by
from .progress import Listener
from .request import Found, NoPlan, Request, expect_no_shared_edges, facts_of, make_request, ways_on
from .resume import lock_broken_cut_first
from .time_limits import CommandLimit, JobLimit

if TYPE_CHECKING:
    from .cooler_orders import SimulatedOrders


@dataclass(frozen=True, eq=False, slots=True)
class FinishedPlan:
    """What the main job has made: of which nest and profile, of which facts, and what came of them.

    The profile has a lock on a cut that broke off, where the program goes on after a stop.
    """

    given: Inputs
    facts: Facts
    made: VerifiedPlan


OrdersOf = Callable[[Facts, Profile, Stated], "SimulatedOrders"]
"""Makes what finds orders by simulation."""


def plan_nest(
    inputs: Inputs,
    limits: SolveOptions,
    *,
    already: AlreadyCut = NOTHING_CUT,
    relax: bool = False,
    engine: Engine = "portfolio",
    solver: str = "gecode",
    strategy: Strategy = "ours",
    listener: Listener | None = None,
    tell: Tell = silent,
    whole: CommandLimit | None = None,
    planned_as: Callable[[Plan], None] | None = None,
    orders: OrdersOf | None = None,
    found: Found | None = None,
    start: Plan | None = None,
    first: bool = False,
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
    engine, solver, strategy
        Who plans; `solver` is that of the engine minizinc.
    listener
        Listens while the plan is made.
    tell
        Told what took long beside a limit in seconds.
    whole
        A limit of the command that this is part of, in place of one in seconds for the planning alone.
    planned_as
        Told the plan before it is judged.
    orders
        What finds orders by another simulation than that of heat, where the profile has a price on what that shows.
    found
        Told each better plan as it is found, as `solve_and_verify` does.
    start
        A plan at hand, as of the nest before an edit: the new one costs no more than this does under what is asked now.
    first
        Give the first lawful plan and stop, but where temperature, or a price on what a simulation shows, decides.
    facts
        What `facts_of` finds of the same nest, profile and cuts, where it was asked before.

    Raises
    ------
    InputError
        If a lock names what the nest does not have, the dialect does not fit, a contour cannot be cut, or an engine
        other than the portfolio is to give its first plan or to go on from one.
    RulesConflict
        If contours cannot be cut and hard rules cannot hold in any order.
    NoPlan
        If the hard rules cannot all hold, or no plan was found. What contradicts what is looked for within `limits`
        once more, or in what is left of `whole`, unless the user has interrupted.
    """
    nest, profile = inputs.nest, lock_broken_cut_first(inputs.profile, already)
    dialect = trusted_dialect(profile)  # a file of the plant's own may be wrong: better said now than at the end
    expect_words(nest, profile, dialect, resumes=bool(already))
    if (start is not None or first) and (engine != "portfolio" or strategy != "ours"):
        raise InputError("a first plan, or one that goes on from another, is made by the engine portfolio alone")
    if engine == "minizinc":
        expect_one_torch(profile, "the engine minizinc")
        from kerfwise.rules.minizinc.installation import solver_named

        solver_named(solver)  # the same goes for a MiniZinc that is missing or broken
    limit, listener = whole or JobLimit(), listener or Listener()
    limit.begin(limits, tell)
    if facts is None:
        facts = facts_of(nest, profile, already, limit)
    try:
        request = make_request(facts, profile, relax, limit.facts_made())
        left = limit.stated()
        if profile.objective.distortion and orders is None:
            tell("objective.distortion is not looked at here: only `solve` chooses plans by it")
        with listener:
            verified = solve_and_verify(
                request,
                profile,
                left,
                limit.watched(listener),
                engine,
                solver,
                strategy,
                None if orders is None else orders(facts, profile, request.stated),
                and_zones=True,
                planned_as=planned_as,
                found=found,
                start=start,
                first=first,
            )
    except RulesConflict as error:
        from kerfwise.models.engines.deadline import Deadline
        from kerfwise.models.plan.conflict import NotAnswered, find_conflict

        try:
            until = Deadline.of(limit.without_plan())
            conflict = None if listener.interrupted else find_conflict(facts, profile, until)
        except NotAnswered:
            raise NoPlan(
                error, facts, profile, within_limit=False, ways=ways_on(limits, engine, relax, error.proven)
            ) from error
        if conflict is not None and conflict.alone:
            expect_no_shared_edges(facts.nest, profile)
        ways = () if listener.interrupted else ways_on(limits, engine, relax, error.proven)
        raise NoPlan(error, facts, profile, conflict, ways=ways) from error
    limit.ended(verified.judging_s)
    return FinishedPlan(Inputs(nest, profile), verified.facts, verified)


# The main job in one call: what is asked of a plan becomes a plan, its program, and the verdict on both.

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


def solve_and_verify(
    request: Request,
    profile: Profile,
    limits: SolveOptions,
    progress: Progress | None = None,
    engine: Engine = "portfolio",
    solver: str = "gecode",
    strategy: Strategy = "ours",
    cooler: SimulatedOrders | None = None,
    *,
    and_zones: bool = False,
    write: Write | None = None,
    trusted: Trusted | None = None,
    planned_as: Callable[[Plan], None] | None = None,
    found: Found | None = None,
    start: Plan | None = None,
    first: bool = False,
) -> VerifiedPlan:
    """Solve, write the program, and judge both; a plain strategy may take the place of the engine, to compare with.

    Where the profile puts a price on overheats, the nest is simulated many times over; `cooler` knows what was
    simulated before of the same nest by the same rules. `and_zones` has zones move where that pays, and the
    plan say what they cost, which takes a share of a limit in seconds, or work beside that of the plan. `write` makes
    the program of the plan in another way; what of its words is `trusted` is not judged. `planned_as` is told the
    plan before it is judged: nothing but its rules and its cost will change. `found` is told each better plan of the
    portfolio meanwhile, which changes nothing; no plan by other zones, and none that a simulation has asked for.
    `start` and `first` are as `plan_nest` has them.

    Raises
    ------
    RulesConflict
        If no lawful plan exists, or none was found.
    """
    facts, started_s = request.facts, running_s()
    engine_named = engine if strategy == "ours" else "portfolio"
    whole = limits
    and_zones = (
        and_zones
        and facts.copies is None
        and engine == "portfolio"
        and strategy == "ours"
        and is_look_worthwhile(facts.n, limits)
        and bool(zoned_by(request.facts, profile))
    )
    if and_zones and limits.time_s is not None and facts.n <= FEW:  # of larger nests it has what the first plan leaves
        limits = replace(limits, time_s=limits.time_s * (1 - 2 * SHARE))

    def solved(share: float, stated: Stated, further: tuple[Statement, ...] = ()) -> Solution:
        part = replace(limits, work=limits.work * share, time_s=limits.time_s and limits.time_s * share)
        request_now = Request(facts, stated)
        hear = None if found is None else partial(found, request_now)
        return _solved(request_now, further, profile, part, progress, engine, solver, strategy, hear)

    cool: Solution | None = None
    price_mm = profile.objective.heat if cooler is None else cooler.price_mm(profile)
    if strategy == "ours" and price_mm and profile.heat.absorbed_power_w:
        from .heat_control import solve_priced

        cool, stated = solve_priced(request, profile, limits, solved, progress, cooler)
        request = Request(facts, stated)

    @cache  # looking for what an order leaves takes long
    def seen_in(route: tuple[int, ...]) -> tuple[Statement, ...]:
        return seen_after(facts, profile, route)

    def planned(solution: Solution, *, reasons: bool = True) -> Plan:
        seen = seen_in(solution.route)
        return plan_of(Request(facts, request.stated), profile, solution, limits, seen, engine_named, reasons=reasons)

    plan: Plan | None = None
    zoned: ZonedPlan | None = None
    known: ZonedPlan | None = None
    ends_s = None if whole.time_s is None else started_s + whole.time_s
    if (limit := profile.temperature_limit()) is not None:
        from .heat_control import Cooler

        again = strategy == "ours" and engine != "minizinc"  # the others cannot be asked for more than the rules state

        def attempt(share: float, further: tuple[Statement, ...]) -> Solution:
            return solved(share, request.stated, further)

        def going() -> bool:
            in_time = limits.time_s is None or running_s() - started_s < limits.time_s
            return in_time and (progress is None or progress(limit.rule, None, None))

        timed = partial(planned, reasons=False)
        cooler_orders = Cooler(facts, profile, limit, request.stated.statements, attempt, timed, planned, going)
        solution, plan = cooler_orders.find(again)
    else:
        if cool is None and (first or start is not None):
            at_hand = None if start is None else plan_at_hand(facts, profile, limits, start, request)
            if first or at_hand is not None:
                known = first_plan(request, profile, limits, at_hand, progress, moves=not first)
        if first and known is not None:
            zoned = known
        elif and_zones and cool is None and zones_follow(request):
            zoned = plan_by_rungs(request, profile, whole, ends_s, progress, found=found)
        if zoned is None and cool is None and engine == "portfolio" and strategy == "ours":
            solution = with_less_work(partial(solved, stated=request.stated), facts.n, limits, progress)
        else:
            solution = zoned.solution if zoned else cool or solved(1.0, request.stated)
    best = zoned or ZonedPlan(request, solution, None)
    if and_zones and zoned is None:
        stays = limit is not None or cool is not None
        further = seen_in(solution.route)
        best = better_zones(request, further, profile, solution, whole, ends_s, progress, may_move=not stays)
    if known is not None and known.solution.objective < best.solution.objective:
        best = replace(known, free=best.free)
    if best.asked is not request:
        facts, plan = best.asked.facts, None
    request, solution = best.asked, best.solution
    plan = replace(plan or planned(solution), zones_cost=best.cost(limits))
    if planned_as is not None:
        planned_as(plan)
    return verified(facts, profile, plan, solution, write or write_program, trusted)


def with_less_work(
    solved: Callable[[float], Solution], contours: int, limits: SolveOptions, progress: Progress | None = None
) -> Solution:
    """What a share of the work, 1 at first, brings, or, where that is not proven, what less of it would have brought.

    More work takes other ways, and may end in a dearer plan: so it is done with each of the lower rungs, too, which
    comes to half as much again. What is proven at one of them is proven.
    """
    best = solved(1.0)
    if limits.time_s is not None or limits.gap is not None or limits.no_improvement_s is not None or contours > FEW:
        return best
    for rung in list(rungs(contours, limits.work))[:-1]:
        if best.status == "optimal" or (progress is not None and not progress("portfolio", None, None)):
            break
        try:
            other = solved(rung / limits.work)
        except RulesConflict:  # so little work may find none
            continue
        if other.left_out != best.left_out:
            continue
        cheaper = other if other.objective < best.objective else best
        known = max(best, other, key=lambda one: one.bound or 0.0)
        proven = known.bound is not None and known.bound >= cheaper.objective
        status: Status = "optimal" if proven else "feasible"
        best = replace(cheaper, bound=known.bound, proved_by=known.proved_by, status=status, notes=best.notes)
    return best


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
) -> Plan:
    """The plan of a solution, timed, with what was `seen` in its order; without `reasons` in a tenth of the time."""
    facts = request.facts
    stated = replace(request.stated, statements=(*request.stated.statements, *seen))
    plan = make_plan(facts, profile, stated, solution, engine, limits.seed)
    if reasons:
        plan = with_reasons(plan, solved_context(facts, profile, stated, solution))
    plan = with_further_torches(plan, facts, stated, solution)
    plan = with_pierces(plan, facts.whole_nest, profile, limits)
    return with_times(plan, facts.whole_nest, profile)


def verified(
    facts: Facts,
    profile: Profile,
    plan: Plan,
    solution: Solution,
    write: Write = write_program,
    trusted: Trusted | None = None,
    planned: CheckResult | None = None,
) -> VerifiedPlan:
    """A plan with its program, and the verdict on both in it; `planned` is that on the plan, where it is known."""
    began_s = running_s()
    planned_verdict = check_plan(facts.whole_nest, plan, profile) if planned is None else planned
    plan = replace(plan, state=planned_verdict.state)  # the program says it, too
    program = write(plan, facts.whole_nest, profile)
    verdict = judge(facts.whole_nest, plan, program, profile, trusted, planned_verdict)
    if verdict.state.short() != planned_verdict.state.short():
        program = with_state(program, verdict.state)
        verdict = judge(facts.whole_nest, plan, program, profile, trusted, planned_verdict)
    judging_s = running_s() - began_s
    return VerifiedPlan(_judged(plan, verdict, facts, profile), program, verdict, solution.notes, facts, judging_s)


def _judged(plan: Plan, verdict: CheckResult, facts: Facts, profile: Profile) -> Plan:
    """The plan with a verdict in it."""
    cost = cost_of_plan(plan, facts.whole_nest, profile)
    return replace(plan, rules=report_of(verdict, profile), state=verdict.state, cost=cost)


class PlanOnTheWay:
    """The plan of a route that was found meanwhile, without the reasons for its order.

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
        self._facts, self._profile, self._solution = request.facts, profile, solution
        self._plan = plan_of(request, profile, solution, limits, seen, reasons=False)
        self._verdict: CheckResult | None = None

    @property
    def objective(self) -> float:
        """What it costs, mm."""
        return self._solution.objective

    def lawful(self) -> VerifiedPlan:
        """The plan with the verdict on itself; there is no program yet, and nothing is known of one."""
        facts, began_s = self._facts, running_s()
        verdict = self._verdict = check_plan(facts.whole_nest, self._plan, self._profile)
        plan = _judged(self._plan, verdict, facts, self._profile)
        return VerifiedPlan(plan, "", verdict, self._solution.notes, facts, running_s() - began_s)

    def verified(self) -> VerifiedPlan:
        """The plan with its program, and the verdict on both."""
        return verified(self._facts, self._profile, self._plan, self._solution, planned=self._verdict)


def _solved(
    request: Request,
    further: tuple[Statement, ...],
    profile: Profile,
    limits: SolveOptions,
    progress: Progress | None,
    engine: Engine,
    solver: str,
    strategy: Strategy,
    found: Callable[[Solution], None] | None = None,
) -> Solution:
    """What the engine makes of the statements and further ones; MiniZinc and plain strategies know no further ones."""
    facts, stated = request.facts, request.stated
    refine = lazy_statements(facts, profile)
    if strategy != "ours":
        from kerfwise.models.engines.baselines import solve_by

        return solve_by(strategy, facts, profile, stated.statements, limits, progress)
    if engine == "minizinc":
        from kerfwise.models.engines.minizinc_engine import solve_minizinc

        return solve_minizinc(facts, profile, stated, limits, solver, refine, progress)
    from kerfwise.models.engines.solve import solve

    look_s = 0.0
    if limits.time_s is not None:
        began_s = running_s()
        look_s = look_takes_s(facts, profile)
        limits = replace(limits, time_s=max(limits.time_s - (running_s() - began_s), limits.time_s / 2))
    return solve(facts, (*stated.statements, *further), limits, progress, refine, look_s, found=found)
