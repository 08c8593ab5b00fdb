"""The bound by flows in a run: alone, or by a thread of its own while the plan is improved."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from threading import Event

from kerfwise.models.engines import bounds, ideals, shares
from kerfwise.models.engines.solution import Incumbent, Progress

from .proof import take_proof
from .run import Run
from .searching import Searching


def bound_by_flows(run: Run, share: float) -> None:
    """A bound by linear programming, where there is a plan."""
    if run.known.incumbent is None or share <= 0.0:
        return
    within, ends_s = run.within(share), run.ends_s(share)
    found = bounds.flow_bound(run.problem, run.known.incumbent, share, within, run.most_bytes, ends_s)
    run.known.work += found.work
    _take_bound(run, found.bound)


def improve_while_bounded(run: Run, searching: Searching) -> None:
    """A better plan, and at the same time a higher bound by a thread of its own that knows today's plan alone.

    So neither depends on how far the other has come. A gap that is enough would: then one follows the other.
    """
    plan, left, began = run.known.incumbent, run.left(), run.known.work
    assert plan is not None
    share = shares.FLOW_BESIDE * left
    reached, within = Event(), run.within(share, lambda *_: not run.watch.stopped)

    def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
        run.watch.overhear(bound_um)
        return not reached.is_set() and within(engine, cost_um, bound_um)

    with ThreadPoolExecutor(1) as thread:
        bounding = thread.submit(_bound_of, run, plan, share, going)
        try:
            searching.go_on(shares.SEARCH_BESIDE * left)
            searching.windows(shares.WINDOWS_BESIDE * left)
            while not wait([bounding], shares.NEWS_S).done:
                if not run.watch("bound", plan.cost, None):
                    reached.set()
        finally:
            reached.set()
    found = bounding.result()
    run.known.work = began + max(found.work, run.known.work - began + found.work / 2)
    if isinstance(found, ideals.Proof):
        take_proof(run, found)
    else:
        _take_bound(run, found.bound)


def _bound_of(run: Run, plan: Incumbent, share: float, going: Progress) -> ideals.Proof | bounds.FlowBound:
    """What is proven by flows, and by the ideals with their multipliers where these hold all that is asked."""
    most_bytes = (1.0 - shares.WINDOWS_BYTES) * run.most_bytes
    if ideals.priceable(run.problem) and ideals.sets_out(run.problem, shares.FIRST_BOUNDS * share):
        proof = ideals.prove_priced(run.problem, plan, share, going, run.limit_s(share), most_bytes)
        return bounds.FlowBound(0, share) if proof is None else proof
    return bounds.flow_bound(run.problem, plan, share, going, most_bytes, run.ends_s(share))


def _take_bound(run: Run, bound_um: int) -> None:
    if bound_um > 0:
        run.known.notes.append("flow: a bound by linear programming")
        run.known.raise_bound(bound_um, "flow")
