"""Kernels are loaded, or compiled where that was never done, before something is measured.

A limit in seconds needs none of this: its clock stands still meanwhile (`kernels.running_s`).
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Kind, Nest, Part, Sheet
from kerfwise.models.engines.ideals.budget import TABLE_BYTES, SweepBudget, TooLarge
from kerfwise.models.engines.ideals.priced import price
from kerfwise.models.engines.ideals.windows import polish
from kerfwise.models.kernels import take_plainly
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.state_rules import state_rules

from . import ideals
from .bounds import flow_bound
from .portfolio import run_portfolio
from .solution import Incumbent, SolveOptions
from .watch import Watch

LOADING_S = 0.05
DEAR_UM = 1 << 40
"""Costs as high as those of plans with excuses are swept by kernels for wider numbers."""


def load_kernels(problem: Problem | None = None) -> None:
    """Let every engine that has kernels look at a small problem, a nest's by the default profile if none is given.

    Takes half a second; the first time after kerfwise was installed, the better part of a minute.
    """
    take_plainly(0)
    problem = problem or _problem()
    watch = Watch(SolveOptions())
    run_portfolio(problem, SolveOptions(work=LOADING_S, member="beam"), watch)
    found = run_portfolio(problem, SolveOptions(work=LOADING_S, member="search"), watch).incumbent
    assert found is not None
    dear = Incumbent(found.route, found.cost + DEAR_UM)
    for known, stages in ((None, ()), (found, ()), (found, ideals.STAGES), (dear, ()), (dear, ideals.STAGES)):
        ideals.prove(problem, known, LOADING_S, watch, stages)
    flow_bound(problem, found, LOADING_S, watch)
    _load_priced(problem, found)
    polish(problem, found, LOADING_S, watch)


def _load_priced(problem: Problem, found: Incumbent) -> None:
    """The sweeps by multipliers of linear programs, which hold no crossings and no groups."""
    bare = replace(problem, crossings=Crossings(), soft_groups=(), general=())
    stretches = price(bare, found, LOADING_S, None, TABLE_BYTES)
    if stretches is None:
        return
    with ThreadPoolExecutor(1) as thread:
        for limit in (found.cost, found.cost + DEAR_UM):
            with suppress(TooLarge):
                stretches.sweep(limit, SweepBudget.of(LOADING_S, lambda: True), thread)


def _problem() -> Problem:
    profile = load_profile()
    plate = Part("A", _square("A", "outer", (40, 40), 60), (_square("A", "hole", (60, 60), 20),))
    beside = (Part(name, _square(name, "outer", (x, 40), 50)) for name, x in (("B", 110.0), ("C", 170.0)))
    nest = Nest(Sheet.rectangle(260, 140), (plate, *beside))
    facts = compute_facts(nest, profile.fact_options(nest), build_candidates(nest, profile.lead_options()))
    return make_problem(facts, state_rules(facts, profile).statements, profile.home_on(nest))


def _square(part: str, kind: Kind, corner_mm: Point, side_mm: float) -> Contour:
    x, y = corner_mm
    corners = [(x, y), (x + side_mm, y), (x + side_mm, y + side_mm), (x, y + side_mm)]
    return Contour(f"{part}.{kind}", part, kind, Curve.of(corners))
