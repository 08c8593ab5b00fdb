"""The portfolio: search finds, the ideals prove where they fit, CP-SAT carries what a state cannot hold.

Members share incumbents and bounds, run one after the other (each may use every core) and stop as soon as the best
plan is proven. Only where a large nest is bounded by flows, on one core, is its plan improved meanwhile.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace
from math import inf
from threading import Event
from typing import TYPE_CHECKING

from kerfwise.models.engines.ideals.series import series
from kerfwise.models.engines.ideals.windows import polish
from kerfwise.models.kernels import running_s
from kerfwise.models.problem.evaluate import broken, route_cost
from kerfwise.models.problem.problem import Problem

from . import beam, bounds, cpsat, ideals, setting_out, shares
from .known import Known
from .names import Member
from .solution import Incumbent, Progress, SolveOptions, table_bytes
from .watch import Watch

if TYPE_CHECKING:
    from .search import Searcher

NOT_BEGUN = "{}: not begun, its tables alone take longer than what is left for it"


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
    run = _Run(problem, options, watch)
    if start is not None:
        run.known.offer(Incumbent(start, route_cost(problem, start)), "search")
    if earlier is not None and earlier.proved_by:
        run.known.raise_bound(earlier.bound_um, earlier.proved_by)
    if earlier is not None:
        run.known.priced = earlier.priced
    return run.whole()


class _Run:
    def __init__(self, problem: Problem, options: SolveOptions, watch: Watch) -> None:
        self.problem, self.options, self.watch = problem, options, watch
        self.of_sets = replace(problem, general=())  # all but what a set and the last site cannot tell
        self.most_bytes = table_bytes(options.memory_gb, setting_out.crossed_bytes(problem))
        self.known = Known()
        self.searcher: Searcher | None = None
        self.preview: Incumbent | None = None
        self.preview_done = False
        self.tried = False
        self.began_s = watch.seconds

    def whole(self) -> Known:
        self._count()
        if self._at_once():
            self._ideals(self._left(), ())
        if self._wanting() and self._takes("search", "it finds the first plan"):
            left = self._left()
            first = min(shares.FIRST_MOST * left, max(shares.FIRST * left, shares.FIRST_S))
            if self.options.member:
                self._search(left)
            else:
                self._look(first, shares.LOOKS if self.problem.n <= shares.LONGEST else 1)
        if not self._over() and self._ideals_fit():
            self._prove()
        if not self._over() and self._priced_first():
            self._priced(self._left() * shares.PRICED)
        if not self._over() and self._beam_applies():
            dense = self._density() >= shares.DENSE and not self._bounded_beside()
            share = self._left() * (shares.BEAM_DENSE if dense else shares.BEAM_SPARSE)
            self._beam(self._left() if self.options.member else share)
        if not self._over() and self.options.member is None:
            self._improve_and_bound()
        if not self._over():
            self._cpsat(self._left())
        self.known.offer(self.preview, "search")  # what was shown is not lost, where the work was ended early
        return self.known

    def _improve_and_bound(self) -> None:
        """A better plan and a higher bound, where nothing is proven yet."""
        if self.known.priced:
            self._search(self._left() * shares.SEARCH_PRICED)
            self._windows(self._left())
            return
        well = self._bounded_well() and not self._carried()
        if self._bounded_beside():
            self._search(self._left() * shares.SEARCH_ALONE)
            if not self._over() and self.known.incumbent is not None:
                self._improve_while_bounded()
            return
        few = shares.FLOW_FIRST if self.problem.n <= shares.FLOW_FEW else 0.0
        self._flow(self._left() * (few if well else shares.FLOW_CARRIED if self._bounded_well() else shares.FLOW_PLAIN))
        if not self._over():
            share = shares.SEARCH_NEST if well else shares.SEARCH if self._carried() else shares.SEARCH_PLAIN
            windows = shares.WINDOWS_NEST if well else shares.WINDOWS
            if not (well or self._cpsat_sets_out(self._left() * (1.0 - share) * (1.0 - windows))):
                share, windows = shares.SEARCH_LAST, 1.0
            self._search(self._left() * share)
            self._windows(self._left() * windows)
        if well and not self._over():
            self._flow(self._left() * shares.FLOW)

    def _improve_while_bounded(self) -> None:
        """A better plan, and at the same time a higher bound by a thread of its own that knows today's plan alone.

        So neither depends on how far the other has come. A gap that is enough would: then one follows the other.
        """
        plan, left, began = self.known.incumbent, self._left(), self.known.work
        assert plan is not None
        share = shares.FLOW_BESIDE * left
        reached, within = Event(), self._within(share, lambda *_: not self.watch.stopped)

        def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
            self.watch.overhear(bound_um)
            return not reached.is_set() and within(engine, cost_um, bound_um)

        with ThreadPoolExecutor(1) as thread:
            bounding = thread.submit(self._bound_of, plan, share, going)
            try:
                self._search(shares.SEARCH_BESIDE * left)
                self._windows(shares.WINDOWS_BESIDE * left)
                while not wait([bounding], shares.NEWS_S).done:
                    if not self.watch("bound", plan.cost, None):
                        reached.set()
            finally:
                reached.set()
        found = bounding.result()
        self.known.work = began + max(found.work, self.known.work - began + found.work / 2)
        if isinstance(found, ideals.Proof):
            self._proved(found)
        else:
            self._bounded(found.bound)

    def _bound_of(self, plan: Incumbent, share: float, going: Progress) -> ideals.Proof | bounds.FlowBound:
        """What is proven by flows, and by the ideals with their multipliers where these hold all that is asked."""
        most_bytes = (1.0 - shares.WINDOWS_BYTES) * self.most_bytes
        if ideals.priceable(self.problem) and ideals.sets_out(self.problem, shares.FIRST_BOUNDS * share):
            limit_s = None if self.options.time_s is None else share
            proof = ideals.prove_priced(self.problem, plan, share, going, limit_s, most_bytes)
            return bounds.FlowBound(0, share) if proof is None else proof
        return bounds.flow_bound(self.problem, plan, share, going, most_bytes, self._ends_s(share))

    def _sets_out(self, took_s: float, share: float) -> bool:
        """Whether an engine has time for more than its tables; where there is no plan yet, or it was asked for, so."""
        return self.options.member is not None or self.known.incumbent is None or took_s <= share

    def _cpsat_sets_out(self, share: float) -> bool:
        return self._sets_out(setting_out.cpsat_s(self.problem), share)

    def _takes(self, member: Member, why: str) -> bool:
        forced = self.options.member
        if forced is not None and forced != member:
            return False
        self.known.notes.append(f"{member}: {why if forced is None else 'asked for'}")
        return True

    def _leave_out(self, member: Member, why: str) -> None:
        self.known.notes.append(f"{member}: left out, {why}")
        self.known.unable = why if self.options.member == member else ""

    def _wanting(self) -> bool:
        """Whether there is no plan at all, or time for a better one."""
        return not self.known.proven and (self.known.incumbent is None or not self.watch.stopped)

    def _over(self) -> bool:
        return self.known.proven or self.watch.stopped or self._late()

    def _late(self) -> bool:
        """Whether there is a plan, and no time for another member to set out in; none looks at the clock at work."""
        return self.options.time_s is not None and self.known.incumbent is not None and self._left() < shares.SET_OUT_S

    def _left(self) -> float:
        if self.options.time_s is None:
            return max(0.0, self.options.work - self.known.work)
        return max(0.0, self.options.time_s - (self.watch.seconds - self.began_s))

    def _look(self, share: float, looks: int) -> None:
        """Searches from scratch, as one alone may be caught; that of the best plan is gone on with later."""
        from .search import Searcher  # what most small nests are proven without

        best: Searcher | None = None
        for look in range(looks):
            known = self.known.incumbent
            self.searcher = Searcher(self.problem, self.options.seed + look * shares.SEEDS_APART) if look else None
            self._search(share / looks)
            if best is None or self.known.incumbent is not known:
                best = self.searcher
            if self._over():
                break
        self.searcher = best

    def _search(self, share: float) -> None:
        from .search import Searcher

        if self.searcher is None:
            self.searcher = Searcher(self.problem, self.options.seed)
            if self.known.incumbent is not None:
                self.searcher.stand_on(self.known.incumbent.route)
        elif self.known.incumbent is not None and self.known.found_by != "search":
            self.searcher.stand_on(self.known.incumbent.route)
        self.searcher.run(share, self.options.time_s and share, self.watch)
        self.known.offer(self.searcher.best, "search")
        self.known.work += share

    def _count(self) -> None:
        """Count the sets that can occur, as far as there is a use for it."""
        self.count: ideals.Count | None = None
        if self.options.member not in (None, "ideals"):
            return
        if why := ideals.unfit(self.of_sets):
            self._leave_out("ideals", why)
            return
        most = shares.COUNTED_FEW if self.problem.n <= shares.LONGEST else shares.COUNTED
        most *= min(1.0, self._left() / shares.COUNTED_S)
        self.count = ideals.count_sets(self.of_sets, most, self._counting)
        self.known.work += self.count.work

    def _counting(self, entries: int) -> bool:
        """Whether to go on counting; where it takes long, there is a first plan to be shown."""
        few = entries < shares.PREVIEW_AFTER_ENTRIES or self.problem.n > shares.PREVIEW_MOST_CONTOURS
        if not (few or self.preview_done or self.options.member):
            self._show_preview()
        return self.watch("ideals", None, None)

    def _show_preview(self) -> None:
        """A first plan to be shown; no engine goes on from it."""
        from .search import Searcher

        self.preview_done = True
        searcher = Searcher(self.problem, self.options.seed)
        searcher.run(shares.PREVIEW_WORK, self.options.time_s and shares.PREVIEW_WORK, self.watch.preview)
        self.preview = searcher.best

    def _at_once(self) -> bool:
        count = self.count
        if count is None or not count.fits(self.most_bytes):
            return False
        longest_s = shares.AT_ONCE_S if self._few(count) else shares.AT_ONCE_MANY_S
        if not (self.options.member or count.seconds <= min(longest_s, shares.AT_ONCE * self._left())):
            return False
        self.known.notes.append(f"ideals: {'swept at once' if self.options.member is None else 'asked for'}, {count}")
        self.tried = True
        return True

    def _ideals_fit(self) -> bool:
        if self.count is None or self.tried:
            return False
        if not (self.options.member or self._sure() or self._few(self.count)):
            self.known.notes.append(f"ideals: left to the others, {self.count}")
            return False
        self.known.notes.append(f"ideals: {self.count}")
        return True

    def _few(self, count: ideals.Count) -> bool:
        """Whether stretches are so short that a bound may make the sets few."""
        longest = count.longest
        return longest <= shares.LONGEST or (longest <= shares.LONGEST_ZONE and longest <= self.problem.n / 2)

    def _sure(self) -> bool:
        """Whether a sweep over all sets fits well into what is left."""
        count, most_s = self.count, shares.SURE * self._left()
        return count is not None and count.fits(self.most_bytes) and count.seconds <= most_s

    def _prove(self) -> None:
        """The ideals, with their share; walks take no more of a larger one."""
        small, zones = self.problem.n <= shares.LONGEST, len(series(self.of_sets)) > 1
        if self.options.member or small or not (zones and ideals.priceable(self.of_sets)):
            share = 1.0 if self.options.member else shares.PROOF_SMALL if small else shares.PROOF
            self._ideals(self._left() * share)
            return
        part = shares.PROOF / shares.PROOF_ZONES
        self._ideals(self._left() * shares.PROOF_ZONES, tuple(part * stage for stage in ideals.STAGES))

    def _ideals(self, share: float, stages: tuple[float, ...] = ideals.STAGES) -> None:
        before = self.known.work
        limit_s = None if self.options.time_s is None else share
        stages = stages[:1] if self._sure() else stages
        going = self._within(max(share, self._left()))
        proof = ideals.prove(
            self.of_sets, self.known.incumbent, share, going, stages, limit_s, self.most_bytes, self.known.priced
        )
        self.known.work = before + (share if proof is None else proof.work)
        self.known.priced = self.known.priced if proof is None else proof.priced
        self._proved(proof)

    def _proved(self, proof: ideals.Proof | None) -> None:
        if proof is not None and proof.better is not None and not broken(self.problem, proof.better.route):
            route = proof.better.route
            self.known.offer(Incumbent(route, route_cost(self.problem, route)), "ideals")
        if proof is None:
            self.known.notes.append("ideals: too many sets for the limit, nothing is proven")
        elif proof.least is not None:
            self.known.notes.append("ideals: too many sets for the limit, a bound is proven")
            self.known.raise_bound(proof.least, "ideals")
        elif proof.incumbent is None:
            self.known.infeasible = True
        else:
            self._proven_of_sets(proof.incumbent)

    def _proven_of_sets(self, best: Incumbent) -> None:
        """The best route without what sets cannot tell: a bound, and the answer if nothing else is broken by it."""
        route = best.route
        if not self.problem.general:
            self.known.offer(best, "ideals")
        elif not broken(self.problem, route):
            self.known.offer(Incumbent(route, route_cost(self.problem, route)), "ideals")
        else:
            self.known.notes.append("ideals: the best plan breaks what a set cannot tell, it is a bound only")
            if self.options.member is not None:
                self.known.unable = "what its best plan breaks, a set of contours and the last cut cannot tell"
        self.known.raise_bound(best.cost, "ideals")

    def _priced_first(self) -> bool:
        """Whether a nest is so small that the ideals with multipliers of the flow come near its best plan at once."""
        if self.options.member is not None or self.problem.n > shares.FLOW_FEW or not self._bounded_well():
            return False
        return ideals.priceable(self.problem) and ideals.sets_out(self.problem, self._left() * shares.PRICED)

    def _density(self) -> float:
        """Share of the pairs of contours that hard orders decide."""
        n = self.problem.n
        return float(self.problem.before.sum()) / max(1, n * (n - 1) // 2)

    def _bounded_well(self) -> bool:
        """Whether the bound by flows is worth its time: a nest, with all its sites in it."""
        return self.problem.m <= bounds.MOST_SITES and bool(self.problem.conditions or self.problem.lags)

    def _bounded_beside(self) -> bool:
        """Whether the bound by flows is looked for at the same time as a better plan."""
        many = self.problem.n > shares.FLOW_FEW
        return many and self._bounded_well() and not self._carried() and self.options.gap is None

    def _carried(self) -> bool:
        """Whether CP-SAT alone can hold all that is asked."""
        return self.problem.further_back is not None

    def _beam_applies(self) -> bool:
        if self.options.member not in (None, "beam"):
            return False
        if why := beam.unfit(self.problem):
            self._leave_out("beam", why)
            return False
        return self._takes("beam", f"hard orders decide {self._density():.0%} of the pairs")

    def _beam(self, share: float) -> None:
        if not self._sets_out(setting_out.beam_s(self.problem), share):
            self.known.notes.append(NOT_BEGUN.format("beam"))
            return
        limit_s = None if self.options.time_s is None else share
        outcome = beam.beam(self.problem, self.known.incumbent, share, limit_s, self.watch, most_bytes=self.most_bytes)
        self.known.offer(outcome.incumbent, "beam")
        self.known.work += outcome.work
        if outcome.proven and outcome.incumbent is None:
            self.known.infeasible = True
        elif outcome.bound is not None:
            self.known.raise_bound(outcome.bound, "beam")

    def _flow(self, share: float) -> None:
        if self.known.incumbent is None or share <= 0.0:
            return
        within = self._within(share)
        ends_s = self._ends_s(share)
        found = bounds.flow_bound(self.problem, self.known.incumbent, share, within, self.most_bytes, ends_s)
        self.known.work += found.work
        self._bounded(found.bound)

    def _priced(self, share: float) -> None:
        """The ideals with multipliers of the flow: few sets are left near a good bound."""
        plan = self.known.incumbent
        if plan is None:
            return
        limit_s = None if self.options.time_s is None else share
        proof = ideals.prove_priced(self.problem, plan, share, self._within(share), limit_s, self.most_bytes)
        self.known.work += share if proof is None else proof.work
        self._proved(proof)

    def _bounded(self, bound_um: int) -> None:
        if bound_um > 0:
            self.known.notes.append("flow: a bound by linear programming")
            self.known.raise_bound(bound_um, "flow")

    def _ends_s(self, share: float) -> float:
        """When so many seconds will be over, by `running_s`; never where no seconds are counted."""
        return inf if self.options.time_s is None else running_s() + share

    def _windows(self, share: float) -> None:
        if self.known.incumbent is None or self._over() or setting_out.windows_s(self.problem) > share:
            return
        own = shares.WINDOWS_BYTES * self.most_bytes
        polished = polish(self.problem, self.known.incumbent, share, self._within(share), own)
        self.known.offer(polished.incumbent, "windows")
        self.known.work += polished.work

    def _within(self, share: float, asked: Progress | None = None) -> Progress:
        """To be asked whether to go on, no longer than so many seconds where seconds are counted."""
        limited, until_s = self.options.time_s is not None, self.watch.seconds + share
        asked = asked or self.watch

        def going(engine: str, cost_um: int | None, bound_um: int | None) -> bool:
            return asked(engine, cost_um, bound_um) and not (limited and self.watch.seconds >= until_s)

        return going

    def _cpsat(self, share: float) -> None:
        if not self._cpsat_sets_out(share):
            self.known.notes.append(NOT_BEGUN.format("cp-sat"))
            return
        if not self._takes("cp-sat", "nothing is proven yet"):
            return
        limits = replace(self.options, work=share, time_s=self.options.time_s and share)
        outcome = cpsat.solve_cpsat(self.problem, limits, self.known.incumbent, self.known.bound_um, self.watch)
        self.known.offer(outcome.incumbent, "cp-sat")
        self.known.infeasible = outcome.infeasible
        if outcome.bound is not None:
            self.known.raise_bound(outcome.bound, "cp-sat")
        self.known.work += min(share, outcome.work) if self.known.proven else share  # a proof leaves the rest to others
