"""The search: an anytime ruin and recreate, seeded and deterministic, that finds good lawful routes fast."""

from __future__ import annotations

from kerfwise.models.engines.solution import Incumbent, Progress, SolveOptions
from kerfwise.models.problem.problem import Problem

from .searcher import Searcher

CYCLES = (0.05, 0.2, 0.75)  # shares of the work: a quick answer first, then slower annealings


def search(
    problem: Problem, options: SolveOptions, progress: Progress | None = None, share: float = 1.0
) -> Incumbent | None:
    """The best lawful route found within a share of the limits, or None if none was found."""
    searcher = Searcher(problem, options.seed)
    for part in CYCLES:
        time_s = None if options.time_s is None else options.time_s * share * part
        if not searcher.run(options.work * share * part, time_s, progress):
            break
    return searcher.best


__all__ = ["Searcher", "search"]
