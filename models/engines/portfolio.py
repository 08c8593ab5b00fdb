"""The portfolio: search finds plans, the ideals prove where sets are few, flows bound, CP-SAT carries the rest.

Its members share incumbents and bounds and run one after the other, in the order of `STEPS`, until the best plan is
proven or the limit is reached; each may use every core. Shares are of what is then left (`shared_state.py`):

| step | when it suits | what it gets |
|---|---|---|
| ideals: sweep at once | all sets are counted, fit into memory and are swept soon | all |
| without wishes | soft rules tie the whole order together | 10 %, in all steps of the smaller problem |
| search: first look | nothing is proven yet | 3 %, at least 0.9 s; all where it runs alone |
| ideals: proof | a bound may make the sets few, or the sweep surely ends | 45 to 90 %; most take next to nothing |
| ideals: multipliers | a small nest whose conditions and lags linear programs hold | 60 % |
| ideals: widening | hard orders are dense, and neither conditions nor lags bind | 50 % |
| excuses | the best plan has some that are not shown to be needed | 20 % |
| search, flows | nothing is proven yet; by kind of problem, see `improve_and_bound` | nearly all |
| CP-SAT | nothing is proven yet, and its model is made in time | the rest |
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace
from threading import Event
from typing import TYPE_CHECKING, NamedTuple

from kerfwise.models.engines.ideals.stretch import series
from kerfwise.models.engines.solution import Incumbent, SolveOptions
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem
from kerfwise.models.problem.simplify import without_wishes

from . import bounds, cpsat, first_plan, ideals, solution, tuning
from .deadline import Deadline, Progress
from .shared_state import Found, Run, SharedState

if TYPE_CHECKING:
    from kerfwise.models.engines.search import Searcher

NOT_BEGUN = "{}: not begun, its tables alone take longer than what is left for it"


def run_portfolio(
    problem: Problem,
    options: SolveOptions,
    listener: Progress | None = None,
    start: tuple[int, ...] | None = None,
    earlier: SharedState | None = None,
    found: Found | None = None,
) -> SharedState:
    """Everything that can be found out about a problem within the limits, by all members or by the one asked for.

    Parameters
    ----------
    listener
        Told what is reached; it may end it before the limits do. The deadline of a whole that this is a part of.
    start
        A route to go on from, where one is known; where it breaks something, the search alone does.
    earlier
        What is known of the problem with fewer statements: its bound holds here, too.
    found
        Told each plan that is better than those before, as it is found; it changes nothing.
    """
    run = Run(problem, options, listener, found)
    lawful = start is not None and not broken(problem, start)
    if not lawful and first_plan.wants_early(problem):
        early = first_plan.route_from_its_end(problem)
        if early is None and show_impossible(run):
            return run.known
        start = early or start
        lawful = start is not None and not broken(problem, start)
    if start is not None and lawful:
        run.offer(Incumbent(start, route_cost(problem, start)), "search")
    run.near = None if lawful else start
    if earlier is not None:
        run.known.priced, run.known.tables = earlier.priced, earlier.tables
        run.known.take_bound(earlier)
    count_sets(run)
    for step in STEPS:
        if step.suits(run):
            step.work(run, step.share(run))
    run.offer(run.preview, "search")  # what was shown is not lost, where the work was ended early
    if run.known.incumbent is None and not run.known.infeasible:
        show_impossible(run)
    run.known.work = run.deadline.spent
    return run.known


def show_impossible(run: Run) -> bool:
    """Whether sums alone show that no order holds."""
    run.known.against = tuple(dict.fromkeys(c.about for c in first_plan.impossible(run.problem)))
    run.known.infeasible = bool(run.known.against)
    return run.known.infeasible


def dense(problem: Problem) -> bool:
    """Whether orders leave so few sets that the most promising lead to good plans, and no better bound comes soon."""
    return problem.order_density >= tuning.DENSE and not bounded_well(problem)


def bounded_well(problem: Problem) -> bool:
    """Whether the bound by flows is worth its time: a nest, with all its sites in it."""
    return problem.m <= tuning.FLOWS_MOST_SITES and bool(problem.conditions or problem.lags or problem.moves)


def bounded_beside(run: Run) -> bool:
    """Whether the bound by flows is looked for at the same time as a better plan."""
    problem, options = run.problem, run.options
    many, held = problem.n > tuning.FLOW_FEW, problem.further_back is None
    return many and bounded_well(problem) and held and options.gap is None


def stretches_short(run: Run, count: ideals.Count) -> bool:
    """Whether stretches are so short that a bound may make the sets few."""
    longest = count.longest
    return longest <= tuning.PORTFOLIO_LONGEST or (longest <= tuning.LONGEST_ZONE and longest <= run.problem.n / 2)


def sweep_ends(run: Run) -> bool:
    """Whether a sweep over all sets fits well into what is left."""
    count = run.count
    return count is not None and count.fits(run.deadline.most_bytes) and count.seconds <= tuning.SURE * run.left()


def count_sets(run: Run) -> None:
    """Count the sets that can occur, as far as there is a use for it."""
    if run.options.member not in (None, "ideals") or not run.can("ideals", ideals.unfit(run.of_sets)):
        return

    def going(entries: int) -> bool:
        few = entries < tuning.PREVIEW_AFTER_ENTRIES or run.problem.n > tuning.PREVIEW_MOST_CONTOURS
        if not (few or run.shown or run.options.member):
            show_preview(run)
        return run.deadline("ideals", None, None)

    most = tuning.COUNTED_FEW if run.problem.n <= tuning.PORTFOLIO_LONGEST else tuning.COUNTED
    alone = run.options.member is not None and run.problem.n > tuning.LARGE_NEST
    many_s = tuning.COUNTED_DENSE_S if dense(run.problem) else tuning.COUNTED_S
    most *= min(1.0, run.left() / (tuning.COUNTED_ALONE_S if alone else many_s))
    run.count = ideals.count_sets(run.of_sets, most, going)
    run.deadline.spend(run.count.work)


def swept_at_once(run: Run) -> bool:
    """Whether all sets are swept before anything else; it is noted so."""
    count = run.count
    if count is None or not count.fits(run.deadline.most_bytes):
        return False
    longest_s = tuning.PORTFOLIO_AT_ONCE_S if stretches_short(run, count) else tuning.AT_ONCE_MANY_S
    if not (run.options.member or count.seconds <= min(longest_s, tuning.PORTFOLIO_AT_ONCE * run.left())):
        return False
    run.known.notes.append(f"ideals: {'swept at once' if run.options.member is None else 'asked for'}, {count}")
    run.swept = True
    return True


def proof_suits(run: Run) -> bool:
    """Whether a proof is worth its share; it is noted so."""
    if run.over() or run.count is None or run.swept:
        return False
    if run.options.member or sweep_ends(run) or stretches_short(run, run.count):
        run.known.notes.append(f"ideals: {run.count}")
        return True
    run.known.notes.append(f"ideals: left to the others, {run.count}")
    return False


def proof_share(run: Run) -> float:
    """Seconds for the proof."""
    if run.options.member:
        return run.left()
    small = run.problem.n <= tuning.PORTFOLIO_LONGEST
    return run.left() * (tuning.PROOF_SMALL if small else tuning.PROOF_ZONES if _zones(run) else tuning.PROOF)


def prove(run: Run, share: float) -> None:
    """The ideals, bounded by walks in stages; of a large nest with zones walks take no more, linear programs do."""
    if run.options.member or run.problem.n <= tuning.PORTFOLIO_LONGEST or not _zones(run):
        sweep(run, share)
    else:
        sweep(run, share, tuple(tuning.PROOF / tuning.PROOF_ZONES * stage for stage in ideals.STAGES))


def _zones(run: Run) -> bool:
    return len(series(run.of_sets)) > 1 and ideals.priceable(run.of_sets)


def sweep(run: Run, share: float, stages: tuple[float, ...] = ideals.STAGES) -> None:
    """A proof by sweeps, with a bound by walks in so many stages."""
    known = run.known
    stages = stages[:1] if sweep_ends(run) else stages
    proof = ideals.prove(run.of_sets, known.incumbent, run.deadline.counting(share), stages, known.priced)
    run.deadline.spend(share if proof is None else proof.work)
    known.priced = known.priced if proof is None else proof.priced
    take_proof(run, proof)


def priced_suits(run: Run) -> bool:
    """Whether a nest is so small that the ideals with multipliers of the flow come near its best plan at once."""
    problem = run.problem
    if run.over() or run.options.member is not None or problem.n > tuning.FLOW_FEW or not bounded_well(problem):
        return False
    return ideals.priceable(problem) and ideals.sets_out(problem, run.left() * tuning.PORTFOLIO_PRICED)


def sweep_priced(run: Run, share: float) -> None:
    """The ideals with multipliers of the flow: few sets are left near a good bound."""
    if (plan := run.known.incumbent) is not None:
        proof = ideals.prove_priced(run.problem, plan, run.deadline.within(share))
        run.deadline.spend(share if proof is None else proof.work)
        take_proof(run, proof)


def widening_suits(run: Run) -> bool:
    """Whether hard orders leave few sets, and no better bound comes soon; it is noted so."""
    if run.over() or run.options.member is not None or not dense(run.problem) or ideals.unfit(run.problem):
        return False
    decided = run.problem.order_density
    run.known.notes.append(f"ideals: the most promising sets, orders decide {decided:.0%} of the pairs")
    return True


def widen(run: Run, share: float) -> None:
    """Sweeps of the most promising sets, each wider than the last."""
    proof = ideals.widen(run.problem, run.known.incumbent, run.deadline.within(share))
    run.deadline.spend(proof.work)
    take_proof(run, proof)


def sweep_all(run: Run, share: float) -> None:
    """All sets, without a bound: to find one takes longer than the sweep where that is begun with."""
    sweep(run, share, ())


def take_proof(run: Run, proof: ideals.Proof | None) -> None:
    """Note the plan and the bound of a proof, or that there is none."""
    known, problem = run.known, run.problem
    if proof is not None and proof.better is not None and not broken(problem, proof.better.route):
        route = proof.better.route
        run.offer(Incumbent(route, route_cost(problem, route)), "ideals")
    if proof is None:
        known.notes.append("ideals: too many sets for the limit, nothing is proven")
    elif proof.least is not None:
        known.notes.append(
            f"ideals: too many sets for the limit, {'a bound' if proof.least > 0 else 'nothing'} is proven"
        )
        if proof.least > 0:
            known.raise_bound(proof.least, "ideals")
    elif (best := proof.incumbent) is None:
        known.infeasible = True
    else:  # the best route without what sets cannot tell: a bound, and the answer if it breaks nothing else
        if not broken(problem, best.route):
            run.offer(Incumbent(best.route, route_cost(problem, best.route)), "ideals")
        else:
            known.notes.append("ideals: the best plan breaks what a set cannot tell, it is a bound only")
            if run.options.member is not None:
                known.unable = "what its best plan breaks, a set of contours and the last cut cannot tell"
        known.raise_bound(best.cost, "ideals")


def show_preview(run: Run) -> None:
    """A first plan to be shown while sets are counted; it is no part of what a plan takes."""
    from kerfwise.models.engines.search import Searcher

    searcher, run.shown = Searcher(run.problem, run.options.seed), True
    work = tuning.PREVIEW_WORK
    searcher.run(Deadline(work, run.options.time_s and work, run.deadline.preview))
    run.preview = searcher.best
    run.tell(None if run.preview is None else run.preview.cost, lambda: run.preview)


def search_suits(run: Run) -> bool:
    """Whether there is no plan at all, or time for a better one."""
    known = run.known
    wanting = not known.proven and (known.incumbent is None or not run.deadline.stopped)
    return wanting and run.takes("search", "it finds the first plan")


def look_share(run: Run) -> float:
    """Seconds for the first look."""
    left = run.left()
    return (
        left
        if run.options.member
        else min(tuning.PORTFOLIO_AT_ONCE * left, max(tuning.PORTFOLIO_FIRST * left, tuning.FIRST_S))
    )


def look(run: Run, share: float) -> None:
    """Searches from scratch, as one alone may be caught; that of the best plan is gone on with later."""
    few = run.options.member is None and run.problem.n <= tuning.PORTFOLIO_LONGEST
    looks = tuning.PORTFOLIO_LOOKS if few else 1 + run.wishes_left_out  # one from that plan, one from scratch
    best: Searcher | None = None
    for number in range(looks):
        known = run.known.incumbent
        search(run, share / looks, run.options.seed + number * tuning.SEEDS_APART if number else None)
        if best is None or run.known.incumbent is not known:
            best = run.searcher
        if run.over():
            break
    run.searcher = best


def search(run: Run, share: float, seed: int | None = None) -> None:
    """Search from where it stands, or from the plan of another member if that is the best; anew with a `seed`."""
    from kerfwise.models.engines.search import Searcher  # what most small nests are proven without

    known, first = run.known, run.searcher is None
    if run.searcher is None or seed is not None:
        run.searcher = Searcher(run.problem, run.options.seed if seed is None else seed, earlier=known.tables)
        known.tables = run.searcher.tables
    if known.incumbent is not None and (first or known.found_by != "search"):
        run.searcher.stand_on(known.incumbent.route)
    elif known.incumbent is None and first and run.near is not None:
        run.searcher.stand_near(run.near)
    searcher = run.searcher

    def heard(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        run.tell(cost_um, lambda: searcher.best)
        return run.deadline(engine, cost_um, bound_um)

    searcher.run(run.deadline.within(share, listener=heard))
    run.offer(searcher.best, "search")
    run.deadline.spend(share)


def plan_without_wishes(run: Run, share: float) -> None:
    """The best plan without wishes that tie the whole order together: no limit ends with a worse one."""
    if (fewer := without_wishes(run.problem)) is not None:
        limits = replace(run.options, work=share, time_s=run.options.time_s and share, gap=None, no_improvement_s=None)
        found = run_portfolio(fewer, limits, lambda engine, *_: run.deadline(engine, None, None))
        run.deadline.spend(found.work)
        run.known.take_bound(found)
        if found.incumbent is not None:
            route, run.wishes_left_out = found.incumbent.route, True
            run.offer(Incumbent(route, route_cost(run.problem, route)), found.found_by)
            run.known.notes.append("wishes: the best plan without them is where the search goes on from")


def excuses_suit(run: Run) -> bool:
    """Whether the best plan has excuses that were not shown to be needed."""
    plan = run.known.incumbent
    return in_portfolio(run) and plan is not None and bounds.excused_um(run.problem, plan.route) > run.known.bound_um


def count_excuses(run: Run, share: float) -> None:
    """How many excuses every plan needs, and a plan with fewer; one that breaks other things the search mends."""
    assert run.known.incumbent is not None
    found = bounds.fewest_excuses(run.problem, run.known.incumbent, run.deadline.within(share))
    run.deadline.spend(found.work)
    if found.least_um:
        run.excuses_um = found.least_um
        run.known.notes.append("excuses: sets of contours show how many every plan needs")
        run.known.raise_bound(found.least_um, "cp-sat")
    if found.route is not None:
        if not broken(run.problem, found.route):
            run.offer(Incumbent(found.route, route_cost(run.problem, found.route)), "cp-sat")
        elif run.searcher is not None:
            run.searcher.stand_near(found.route)


def improve_and_bound(run: Run, _: float) -> None:
    """A better plan and a higher bound, where nothing is proven yet."""
    if run.known.priced:
        search(run, run.left() * tuning.SEARCH_PLAIN)
        return
    if bounded_beside(run):
        search(run, run.left() * tuning.SEARCH_ALONE)
        if not run.over() and run.known.incumbent is not None:
            improve_while_bounded(run)
        return
    bounded, held = bounded_well(run.problem), run.problem.further_back is not None
    well = bounded and not held
    few = tuning.FLOW_FIRST if run.problem.n <= tuning.FLOW_FEW else 0.0
    bound_by_flows(run, run.left() * (few if well else tuning.FLOW_CARRIED if bounded else tuning.FLOW_FIRST))
    if not run.over():
        share = tuning.SEARCH_NEST if well else tuning.SEARCH if held else tuning.SEARCH_PLAIN
        if not (well or model_sets_out(run, run.left() * (1.0 - share))):
            share = tuning.SEARCH_LAST
        search(run, run.left() * share)
    if well and not run.over():
        bound_by_flows(run, run.left() * tuning.FLOW)


def bound_by_flows(run: Run, share: float) -> None:
    """A bound by linear programming, where there is a plan."""
    if run.known.incumbent is None or share <= 0.0:
        return
    found = bounds.flow_bound(*beside_excuses(run), run.deadline.within(share))
    run.deadline.spend(found.work)
    take_flow(run, found.bound)


def take_flow(run: Run, bound_um: int) -> None:
    """Note a bound by flows, if there is one."""
    if bound_um > 0:
        run.known.notes.append("flow: a bound by linear programming")
        run.known.raise_bound(run.excuses_um + bound_um, "flow")


def beside_excuses(run: Run) -> tuple[Problem, Incumbent]:
    """What linear programs bound: without excuses, where these are counted already, and what the best plan costs so."""
    plan = run.known.incumbent
    assert plan is not None
    if not run.excuses_um:
        return run.problem, plan
    rest = bounds.without_excuses(run.problem)
    return rest, Incumbent(plan.route, route_cost(rest, plan.route))


def improve_while_bounded(run: Run) -> None:
    """A better plan, and at the same time a higher bound by a thread of its own that knows today's plan alone.

    So neither depends on how far the other has come. A gap that is enough would: then one follows the other.
    """
    plan, left, began, flows = run.known.incumbent, run.left(), run.deadline.spent, beside_excuses(run)
    assert plan is not None
    share, reached = tuning.FLOW * left, Event()

    def overheard(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        run.deadline.overhear(bound_um)
        return not (reached.is_set() or run.deadline.stopped)

    beside = run.deadline.within(share, listener=overheard)

    def bound() -> ideals.Proof | bounds.FlowBound:
        """By flows, and by the ideals with their multipliers where these hold all that is asked."""
        if ideals.priceable(run.problem) and ideals.sets_out(run.problem, tuning.FIRST_BOUNDS * share):
            proof = ideals.prove_priced(run.problem, plan, beside)
            return bounds.FlowBound(0, share) if proof is None else proof
        return bounds.flow_bound(*flows, beside)

    with ThreadPoolExecutor(1) as thread:
        bounding = thread.submit(bound)
        try:
            search(run, tuning.SEARCH_BESIDE * left)
            while not wait([bounding], 0.1).done:  # s between news of the bound
                if not run.deadline("bound", plan.cost, None):
                    reached.set()
        finally:
            reached.set()
    found = bounding.result()
    improving = run.deadline.spent - began
    run.deadline.spend(max(found.work, improving + found.work / 2) - improving)
    if isinstance(found, ideals.Proof):
        take_proof(run, found)
    else:
        take_flow(run, found.bound)


def model_sets_out(run: Run, share: float) -> bool:
    """Whether CP-SAT has time for more than its model."""
    return run.sets_out(solution.cpsat_s(run.problem), share)


def solve_model(run: Run, share: float) -> None:
    """Constraint programming, from the best plan and the bound that are known."""
    known = run.known
    if not model_sets_out(run, share):
        known.notes.append(NOT_BEGUN.format("cp-sat"))
        return
    if not run.takes("cp-sat", "nothing is proven yet"):
        return
    outcome = cpsat.solve_cpsat(
        run.problem, run.deadline.within(share), known.incumbent, known.bound_um, run.options.seed
    )
    run.offer(outcome.incumbent, "cp-sat")
    known.infeasible = outcome.infeasible
    if outcome.bound is not None:
        known.raise_bound(outcome.bound, "cp-sat")
    run.deadline.spend(min(share, outcome.work) if known.proven else share)  # a proof leaves the rest to others


def in_portfolio(run: Run) -> bool:
    """Whether there is time, and all members may run."""
    return not run.over() and run.options.member is None


class Step(NamedTuple):
    """A member, when it suits, how many seconds it has, and what it does with them."""

    suits: Callable[[Run], bool]
    share: Callable[[Run], float]
    work: Callable[[Run, float], None]


STEPS = (
    Step(swept_at_once, Run.left, sweep_all),
    Step(in_portfolio, lambda run: run.left() * tuning.WITHOUT_WISHES, plan_without_wishes),
    Step(search_suits, look_share, look),
    Step(proof_suits, proof_share, prove),
    Step(priced_suits, lambda run: run.left() * tuning.PORTFOLIO_PRICED, sweep_priced),
    Step(widening_suits, lambda run: run.left() * tuning.PORTFOLIO_WIDENED, widen),
    Step(excuses_suit, lambda run: run.left() * tuning.EXCUSES, count_excuses),
    Step(in_portfolio, Run.left, improve_and_bound),
    Step(lambda run: not run.over(), Run.left, solve_model),
)
"""In the order in which they run (see the table above)."""
