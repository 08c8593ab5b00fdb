"""What is learnt of a proof by ideals."""

from __future__ import annotations

from kerfwise.models.engines import ideals
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.problem.evaluate import broken, route_cost

from .run import Run


def take_proof(run: Run, proof: ideals.Proof | None) -> None:
    """Note the plan and the bound of a proof, or that there is none."""
    known, problem = run.known, run.problem
    if proof is not None and proof.better is not None and not broken(problem, proof.better.route):
        route = proof.better.route
        known.offer(Incumbent(route, route_cost(problem, route)), "ideals")
    if proof is None:
        known.notes.append("ideals: too many sets for the limit, nothing is proven")
    elif proof.least is not None:
        known.notes.append("ideals: too many sets for the limit, a bound is proven")
        known.raise_bound(proof.least, "ideals")
    elif proof.incumbent is None:
        known.infeasible = True
    else:
        _take_best_of_sets(run, proof.incumbent)


def _take_best_of_sets(run: Run, best: Incumbent) -> None:
    """The best route without what sets cannot tell: a bound, and the answer if nothing else is broken by it."""
    known, route = run.known, best.route
    if not run.problem.general:
        known.offer(best, "ideals")
    elif not broken(run.problem, route):
        known.offer(Incumbent(route, route_cost(run.problem, route)), "ideals")
    else:
        known.notes.append("ideals: the best plan breaks what a set cannot tell, it is a bound only")
        if run.options.member is not None:
            known.unable = "what its best plan breaks, a set of contours and the last cut cannot tell"
    known.raise_bound(best.cost, "ideals")
