"""The order of the members, and the share that each has.

Members share incumbents and bounds, run one after the other (each may use every core) and stop as soon as the best
plan is proven. Only where a large nest is bounded by flows, on one core, is its plan improved meanwhile.
"""

from __future__ import annotations

from kerfwise.models.engines import shares
from kerfwise.models.engines.known import Known
from kerfwise.models.engines.solution import Incumbent, SolveOptions
from kerfwise.models.engines.watch import Watch
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.models.problem.problem import Problem

from .beaming import beam_applies, widen_beam
from .bounding import bound_by_flows, improve_while_bounded
from .modelling import model_sets_out, solve_model
from .preview import Preview
from .run import Run
from .searching import Searching
from .suits import bounded_beside, bounded_well, carried, density, priced_first
from .sweeping import Sweeping, sweep_priced


def run_portfolio(
    problem: Problem,
    options: SolveOptions,
    watch: Watch,
    start: tuple[int, ...] | None = None,
    earlier: Known | None = None,
) -> Known:
    """Everything that can be found out about a problem within the limits.

    Parameters
    ----------
    start
        A lawful route to go on from, where one is known.
    earlier
        What is known of the problem with fewer statements: its bound holds here, too.
    """
    run = Run(problem, options, watch)
    if start is not None:
        run.known.offer(Incumbent(start, route_cost(problem, start)), "search")
    if earlier is not None and earlier.proved_by:
        run.known.raise_bound(earlier.bound_um, earlier.proved_by)
    if earlier is not None:
        run.known.priced = earlier.priced
    return _all_members(run)


def _all_members(run: Run) -> Known:
    """Run every member that suits, or the one that was asked for."""
    preview, searching, member = Preview(run), Searching(run), run.options.member
    sweeping = Sweeping(run, preview)
    sweeping.count_sets()
    if sweeping.at_once():
        sweeping.sweep(run.left(), ())
    if run.wanting() and run.takes("search", "it finds the first plan"):
        left = run.left()
        first = min(shares.FIRST_MOST * left, max(shares.FIRST * left, shares.FIRST_S))
        if member:
            searching.go_on(left)
        else:
            searching.look(first, shares.LOOKS if run.problem.n <= shares.LONGEST else 1)
    if not run.over() and sweeping.fit():
        sweeping.prove()
    if not run.over() and priced_first(run):
        sweep_priced(run, run.left() * shares.PRICED)
    if not run.over() and beam_applies(run):
        dense = density(run.problem) >= shares.DENSE and not bounded_beside(run)
        share = run.left() * (shares.BEAM_DENSE if dense else shares.BEAM_SPARSE)
        widen_beam(run, run.left() if member else share)
    if not run.over() and member is None:
        _improve_and_bound(run, searching)
    if not run.over():
        solve_model(run, run.left())
    run.known.offer(preview.plan, "search")  # what was shown is not lost, where the work was ended early
    return run.known


def _improve_and_bound(run: Run, searching: Searching) -> None:
    """A better plan and a higher bound, where nothing is proven yet."""
    if run.known.priced:
        searching.go_on(run.left() * shares.SEARCH_PRICED)
        searching.windows(run.left())
        return
    bounded, held = bounded_well(run.problem), carried(run.problem)
    well = bounded and not held
    if bounded_beside(run):
        searching.go_on(run.left() * shares.SEARCH_ALONE)
        if not run.over() and run.known.incumbent is not None:
            improve_while_bounded(run, searching)
        return
    few = shares.FLOW_FIRST if run.problem.n <= shares.FLOW_FEW else 0.0
    bound_by_flows(run, run.left() * (few if well else shares.FLOW_CARRIED if bounded else shares.FLOW_PLAIN))
    if not run.over():
        share = shares.SEARCH_NEST if well else shares.SEARCH if held else shares.SEARCH_PLAIN
        windows = shares.WINDOWS_NEST if well else shares.WINDOWS
        if not (well or model_sets_out(run, run.left() * (1.0 - share) * (1.0 - windows))):
            share, windows = shares.SEARCH_LAST, 1.0
        searching.go_on(run.left() * share)
        searching.windows(run.left() * windows)
    if well and not run.over():
        bound_by_flows(run, run.left() * shares.FLOW)
