"""Whether engines find what trying every plan finds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from kerfwise.encoder.errors import RulesConflict
from kerfwise.encoder.geometry.microns import UM_PER_MM
from kerfwise.jobs.ask import ask
from kerfwise.jobs.solve_options import options_for
from kerfwise.models.engines.minizinc import solve_minizinc
from kerfwise.models.engines.names import BUILT_IN, Engine
from kerfwise.models.engines.rounds import solve
from kerfwise.models.engines.solution import Solution
from kerfwise.models.problem.evaluate import route_cost
from kerfwise.rules.stating.lazy import afterthoughts
from kerfwise.rules.stating.state_rules import Stated

from .trial import Trial, lawful, route

WORK, SEARCH_WORK = 3.0, 0.05
"""Deterministic limits; a search that proves nothing takes all of its own."""
NEAR_MM = 1e-6


def against_engines(trials: Sequence[Trial], engines: Sequence[Engine]) -> Iterator[str]:
    """A line for each engine that claims more, or less, than trying every plan of a trial finds."""
    for trial in trials:
        try:
            stated = ask(trial.facts, trial.profile).stated
        except RulesConflict:
            continue  # as in a profile: where a rule asks for what cannot be, no engine is asked
        best_mm = cheapest_mm(trial, stated)
        for engine in engines:
            try:
                found = solved(trial, stated, engine)
            except RulesConflict:
                if best_mm is not None:
                    yield f"{engine} finds no plan of {trial.name}; there is one of {best_mm:.3f} mm"
                continue
            yield from _wrong(engine, trial, found, best_mm)


def _wrong(engine: Engine, trial: Trial, found: Solution, best_mm: float | None) -> Iterator[str]:
    if best_mm is None:
        yield f"{engine} has a plan of {trial.name}; each of them breaks the rule"
    elif found.objective < best_mm - NEAR_MM:
        yield f"{engine} says {found.objective:.3f} mm of {trial.name}; no lawful plan is under {best_mm:.3f}"
    elif found.objective > best_mm + NEAR_MM and (found.status == "optimal" or engine == "portfolio"):
        yield f"{engine} calls {found.objective:.3f} mm the best of {trial.name}; there is a plan of {best_mm:.3f}"


def solved(trial: Trial, stated: Stated, engine: Engine) -> Solution:
    """What an engine finds; RulesConflict where it finds no plan."""
    limits = options_for(trial.nest, trial.profile, work=SEARCH_WORK if engine == "search" else WORK, engine=engine)
    refine = afterthoughts(trial.facts, trial.profile)
    if engine == "minizinc":
        return solve_minizinc(trial.facts, trial.profile, stated, limits, refine=refine)
    return solve(trial.facts, stated.statements, limits, refine=refine)


def cheapest_mm(trial: Trial, stated: Stated) -> float | None:
    """What the cheapest plan costs, mm of idle travel, by trying all; None where each breaks something."""
    try:
        problem = trial.problem(stated.statements)
    except RulesConflict:
        return None
    costs = (route_cost(problem, route(problem, plan)) for plan in trial.plans if lawful(problem, plan))
    best = min(costs, default=None)
    return None if best is None else best / UM_PER_MM


def engines_here(minizinc: bool) -> tuple[Engine, ...]:
    """The engines to ask: those that are built in, and MiniZinc's where it is installed."""
    return (*BUILT_IN, "minizinc") if minizinc else BUILT_IN
