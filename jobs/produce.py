"""The main job in one call: what is asked of a plan becomes a plan, its program, and the verdict on both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.models.engines.baselines import Strategy
from kerfwise.models.engines.names import Engine
from kerfwise.models.engines.solution import Progress, Solution, SolveOptions
from kerfwise.models.kernels import running_s
from kerfwise.models.plan.make import make_plan
from kerfwise.models.plan.plan import Plan
from kerfwise.postproc.check import CheckResult
from kerfwise.postproc.check.reader.old import Trusted
from kerfwise.postproc.clock.timed import with_times
from kerfwise.postproc.nc.program import write_program
from kerfwise.postproc.verdict.checking import judge, report_of
from kerfwise.rules.profile.profile import Profile
from kerfwise.rules.statements import Statement
from kerfwise.rules.stating.lazy import afterthoughts, look_takes_s
from kerfwise.rules.stating.state_rules import Stated

from .ask import Asked
from .costs import cost_of_plan
from .pierce_pass import with_pierces
from .torches import with_further_torches
from .zones_cost import zoned_by
from .zones_limits import FEW, SHARE, begun
from .zones_moved import better_zones

if TYPE_CHECKING:
    from kerfwise.models.heat_prices.cooler_orders import CoolerOrders


Write = Callable[[Plan, Nest, Profile], str]
"""Makes the program of a plan."""


@dataclass(frozen=True, eq=False, slots=True)
class Produced:
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


def produce(
    asked: Asked,
    profile: Profile,
    limits: SolveOptions,
    progress: Progress | None = None,
    engine: Engine = "portfolio",
    solver: str = "gecode",
    strategy: Strategy = "ours",
    cooler: CoolerOrders | None = None,
    *,
    and_zones: bool = False,
    write: Write | None = None,
    trusted: Trusted | None = None,
    planned_as: Callable[[Plan], None] | None = None,
) -> Produced:
    """Solve, write the program, and judge both; a plain strategy may take the place of the engine, to compare with.

    Where the profile puts a price on overheats, the nest is simulated many times over; `cooler` knows what was
    simulated before of the same nest by the same rules. `and_zones` has zones move where that pays, and the
    plan say what they cost, which takes a share of a limit in seconds, or work beside that of the plan. `write` makes
    the program of the plan in another way; what of its words is `trusted` is not judged. `planned_as` is told the
    plan before it is judged: nothing but its rules and its cost will change.

    Raises
    ------
    RulesConflict
        If no lawful plan exists, or none was found.
    """
    facts, started_s = asked.facts, running_s()
    engine_named = engine if strategy == "ours" else "portfolio"
    whole = limits
    and_zones = (
        and_zones
        and facts.copies is None
        and engine == "portfolio"
        and strategy == "ours"
        and begun(facts.n, limits)
        and bool(zoned_by(asked, profile))
    )
    if and_zones and limits.time_s is not None and facts.n <= FEW:  # of larger nests it has what the first plan leaves
        limits = replace(limits, time_s=limits.time_s * (1 - 2 * SHARE))

    def solved(share: float, stated: Stated, further: tuple[Statement, ...] = ()) -> Solution:
        part = replace(limits, work=limits.work * share, time_s=limits.time_s and limits.time_s * share)
        return _solved(Asked(facts, stated), further, profile, part, progress, engine, solver, strategy)

    cool: Solution | None = None
    if strategy == "ours" and profile.objective.heat and profile.heat.absorbed_power_w:
        from .priced_heat import solve_priced

        cool, stated = solve_priced(asked, profile, limits, solved, progress, cooler)
        asked = Asked(facts, stated)

    @cache  # looking for what an order leaves takes long
    def seen_in(route: tuple[int, ...]) -> tuple[Statement, ...]:
        return afterthoughts(facts, profile)([facts.candidates[c].contour for c in route])

    def planned(solution: Solution) -> Plan:
        stated = replace(asked.stated, statements=(*asked.stated.statements, *seen_in(solution.route)))
        plan = make_plan(facts, profile, stated, solution, engine_named, limits.seed)
        plan = with_further_torches(plan, facts, stated, solution)
        plan = with_pierces(plan, facts.whole_nest, profile, limits)
        return with_times(plan, facts.whole_nest, profile)

    if (limit := profile.temperature_limit()) is not None:
        from .cooling import Cooler

        again = strategy == "ours" and engine != "minizinc"  # the others cannot be asked for more than the rules state

        def attempt(share: float, further: tuple[Statement, ...]) -> Solution:
            return solved(share, asked.stated, further)

        def going() -> bool:
            in_time = limits.time_s is None or running_s() - started_s < limits.time_s
            return in_time and (progress is None or progress(limit.rule, None, None))

        solution, plan = Cooler(facts, profile, limit, asked.stated.statements, attempt, planned, going).find(again)
    else:
        solution = solved(1.0, asked.stated) if cool is None else cool
        plan = planned(solution)
    if and_zones:
        ends_s = None if whole.time_s is None else started_s + whole.time_s
        stays, first = limit is not None or cool is not None, solution
        best = better_zones(
            asked, seen_in(solution.route), profile, solution, whole, ends_s, progress, may_move=not stays
        )
        asked, solution = best.asked, best.solution
        if solution is not first:
            facts = asked.facts
            plan = planned(solution)
        plan = replace(plan, zones_cost=best.cost(limits))
    if planned_as is not None:
        planned_as(plan)
    began_s = running_s()
    program = (write or write_program)(plan, facts.whole_nest, profile)
    verdict = judge(facts.whole_nest, plan, program, profile, trusted)
    judging_s = running_s() - began_s
    plan = replace(plan, rules=report_of(verdict, profile), cost=cost_of_plan(plan, facts.whole_nest, profile))
    return Produced(plan, program, verdict, solution.notes, facts, judging_s)


def _solved(
    asked: Asked,
    further: tuple[Statement, ...],
    profile: Profile,
    limits: SolveOptions,
    progress: Progress | None,
    engine: Engine,
    solver: str,
    strategy: Strategy,
) -> Solution:
    """What the engine makes of the statements and further ones; MiniZinc and plain strategies know no further ones."""
    facts, stated = asked.facts, asked.stated
    refine = afterthoughts(facts, profile)
    if strategy != "ours":
        from .strategies import solve_by

        return solve_by(strategy, facts, profile, stated.statements, limits, progress)
    if engine == "minizinc":
        from kerfwise.models.engines.minizinc import solve_minizinc

        return solve_minizinc(facts, profile, stated, limits, solver, refine, progress)
    from kerfwise.models.engines.rounds import solve

    look_s = 0.0
    if limits.time_s is not None:
        began_s = running_s()
        look_s = look_takes_s(facts, profile)
        limits = replace(limits, time_s=max(limits.time_s - (running_s() - began_s), limits.time_s / 2))
    return solve(facts, (*stated.statements, *further), limits, progress, refine, look_s)
