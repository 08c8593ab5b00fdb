"""How soon there is a plan: the first one, one within 5 % and 1 % of the last, and the proof; beside plain strategies.

Usage: python -m kerfwise.benchmarks.first_plans [--contours 16 40 115 308 1000] [--nests FILE…] [--seed 1] [--work 30]
       > first.md, whose table goes into docs/scale.md by hand

Plates of examples/gen_sheet.py, and nests, under the default profile without no-tip-travel, of which a first plan is
not asked. Seconds are by the clock, kernels compiled, from the nest that is read: of the first plan with its program
and the check, as `solve --first` has it, of the others until the engines have reached them. The plain strategies keep
no rule but, of the second, that what lies in a contour is cut before it; their idle travel is beside that of the last
plan. So is that of OR-Tools' routing library (guided local search), as a programmer would set it up: one pierce of each
contour, what lies in it before it, no other rule, as long as the last plan took, up to `PEER_SITES` pierces.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import platform
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from ortools.constraint_solver import pywrapcp, routing_enums_pb2

import kerfwise
from kerfwise.apps.bench.bench_child import load_kernels
from kerfwise.benchmarks.plates import cost, default_without, made_plate
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.nest import Nest
from kerfwise.encoder.readers import read_nest
from kerfwise.jobs.by_engine import Method
from kerfwise.jobs.inputs import Inputs
from kerfwise.jobs.progress import Listener, Reached
from kerfwise.jobs.request import facts_of, options_for
from kerfwise.pipeline import Watchers, plan_nest
from kerfwise.rules.statements import EXEMPTION_MM

NEAR = 0.05, 0.01
"""How far from the last plan, as shares of its cost without excuses."""
HEAD = """\
Made by `python -m kerfwise.benchmarks.first_plans {given}`
with kerfwise {kerfwise}, Python {python}: seconds by the clock from the nest that is read, {work:g} of work, costs in m
(`+ 1`: with an excuse). The last three columns are idle travel of plans that keep no rule: the nearest pierce always;
the same with what lies in a contour before it; and OR-Tools' routing library under that one rule, as long as the last
plan took.

| nest | first, s | its cost | 5 %, s | 1 %, s | proof, s | last plan | idle, m | nearest | inner first | OR-Tools |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|"""
PEER_SITES = 4000


@dataclass(frozen=True)
class Row:
    """What one nest took: seconds by the clock, mm; None where it was not reached."""

    name: str
    first_s: float
    first_mm: float
    near_s: tuple[float | None, ...]
    proof_s: float | None
    last_mm: float
    idle_mm: float
    nearest_mm: float
    inner_mm: float
    peer_mm: float | None

    def __str__(self) -> str:
        seconds = ["–" if s is None else f"{s:.1f}" for s in (*self.near_s, self.proof_s)]
        idle_mm = (self.idle_mm, self.nearest_mm, self.inner_mm, self.peer_mm)
        lengths = ["–" if mm is None else f"{mm / 1000:.2f}" for mm in idle_mm]
        cells = [self.name, f"{self.first_s:.1f}", cost(self.first_mm), *seconds, cost(self.last_mm), *lengths]
        return f"| {' | '.join(cells)} |"


def reached_s(heard: list[tuple[float, float]], last_mm: float, near: float) -> float | None:
    """When a plan was there that is as near to the last one, of all that were heard of: seconds and costs in order.

    Examples
    --------
    >>> reached_s([(1.0, 1200.0), (2.0, 1040.0), (3.0, 1000.0)], 1000.0, 0.05)
    2.0
    """
    most_mm = last_mm + near * (last_mm % EXEMPTION_MM)
    return next((seconds for seconds, mm in heard if mm <= most_mm), None)


def plain_route(facts: Facts, home_mm: tuple[float, float], inner_first: bool) -> list[int]:
    """The candidates of going on to the nearest pierce always; with `inner_first` of what lies in no uncut contour."""
    contour = np.array([candidate.contour for candidate in facts.candidates])
    pierce = np.array([candidate.pierce for candidate in facts.candidates])
    left, at, route = np.ones(facts.n, dtype=np.bool_), np.array(home_mm), []
    while left.any():
        waits = ~left
        if inner_first:
            waits[facts.parent[left & (facts.parent >= 0)]] = True
        chosen = int(np.where(waits[contour], np.inf, np.hypot(*(pierce - at).T)).argmin())
        route.append(chosen)
        left[contour[chosen]] = False
        at = np.array(facts.candidates[chosen].end)
    return route


def idle_mm(facts: Facts, home_mm: tuple[float, float], route: Sequence[int]) -> float:
    """Idle travel of cutting by these candidates, from home and back to it, mm."""
    pierces = np.array([*(facts.candidates[k].pierce for k in route), home_mm])
    ends = np.array([home_mm, *(facts.candidates[k].end for k in route)])
    return float(np.hypot(*(pierces - ends).T).sum())


def searched_route(facts: Facts, home_mm: tuple[float, float], limit_s: float) -> list[int] | None:
    """What OR-Tools' routing library makes of `plain_route` with `inner_first`; None where it is too large for it."""
    sites = len(facts.candidates)
    if sites > PEER_SITES:
        return None
    pierce = np.array([home_mm, *(candidate.pierce for candidate in facts.candidates)])
    end = np.array([home_mm, *(candidate.end for candidate in facts.candidates)])
    away_um = np.hypot(*(pierce[None] - end[:, None]).transpose(2, 0, 1)) * 1000
    manager = pywrapcp.RoutingIndexManager(sites + 1, 1, 0)
    model = pywrapcp.RoutingModel(manager)
    model.SetArcCostEvaluatorOfAllVehicles(model.RegisterTransitMatrix(np.rint(away_um).astype(int).tolist()))
    model.AddDimension(model.RegisterUnaryTransitVector([1] * (sites + 1)), 0, facts.n + 1, True, "order")
    place = model.GetDimensionOrDie("order")
    nodes: list[list[int]] = [[] for _ in range(facts.n)]
    for k, candidate in enumerate(facts.candidates):
        nodes[candidate.contour].append(manager.NodeToIndex(k + 1))
    for among in nodes:
        model.AddDisjunction(among, -1, 1)  # exactly one of them
    for inner, outer in enumerate(facts.parent):
        for h, o in product(nodes[inner], nodes[outer] if outer >= 0 else ()):
            model.solver().Add(place.CumulVar(h) < place.CumulVar(o))
    search = pywrapcp.DefaultRoutingSearchParameters()
    search.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    search.time_limit.FromMilliseconds(max(1000, round(limit_s * 1000)))
    model.CloseModelWithParameters(search)
    known = model.ReadAssignmentFromRoutes([[k + 1 for k in plain_route(facts, home_mm, True)]], True)
    found = model.SolveFromAssignmentWithParameters(known, search)
    route, at = [], found.Value(model.NextVar(model.Start(0)))
    while not model.IsEnd(at):
        route.append(manager.IndexToNode(at) - 1)
        at = found.Value(model.NextVar(at))
    return route


def row(given: tuple[str, Nest, float]) -> Row:
    """Plan a nest twice: until there is a plan, and to the end."""
    name, nest, work = given
    profile = default_without("no-tip-travel")
    inputs, limits = Inputs(nest, profile), options_for(nest, profile, work=work)
    plan_nest(inputs, limits, Method(first=True))  # loads what is loaded once
    began_s = time.monotonic()
    first = plan_nest(inputs, limits, Method(first=True)).made
    first_s = time.monotonic() - began_s
    heard: list[tuple[float, float]] = []
    began_s = time.monotonic()

    def hear(reached: Reached) -> None:
        if reached.objective_mm is not None:
            heard.append((time.monotonic() - began_s, reached.objective_mm))

    ended: list[float] = []
    watchers = Watchers(Listener(hear), planned=lambda _: ended.append(time.monotonic()))
    last = plan_nest(inputs, limits, watchers=watchers).made
    took_s = time.monotonic() - began_s
    solved, facts = last.plan.solve, facts_of(nest, profile)
    heard.append((ended[0] - began_s, solved.objective))
    home = profile.home_on(nest)
    searched = searched_route(facts, home, took_s)
    return Row(
        name,
        first_s,
        first.plan.solve.objective,
        tuple(reached_s(heard, solved.objective, near) for near in NEAR),
        ended[0] - began_s if solved.status == "optimal" else None,
        solved.objective,
        last.plan.totals.idle_mm,
        idle_mm(facts, home, plain_route(facts, home, False)),
        idle_mm(facts, home, plain_route(facts, home, True)),
        None if searched is None else idle_mm(facts, home, searched),
    )


def nests_of(given: argparse.Namespace) -> Iterator[tuple[str, Nest, float]]:
    """What to plan, in order."""
    for contours in given.contours:
        nest = made_plate(contours, given.seed)
        yield f"{len(nest.contours)} contours", nest, given.work
    for file in given.nests:
        yield Path(file).name, read_nest(Path(file)), given.work


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--contours", type=int, nargs="*", default=[16, 40, 115, 308, 1000])
    parser.add_argument("--nests", nargs="*", default=[])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", type=float, default=30.0)
    given = parser.parse_args()
    load_kernels()
    told = json.dumps(given.contours).strip("[]").replace(",", "")
    named = f"--contours {told} --nests {' '.join(given.nests)} --seed {given.seed} --work {given.work:g}"
    print(HEAD.format(given=named, kerfwise=kerfwise.__version__, python=platform.python_version(), work=given.work))
    for one in nests_of(given):
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            print(pool.apply(row, (one,)), flush=True)


if __name__ == "__main__":
    main()
