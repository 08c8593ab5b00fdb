"""The process that runs one engine on one file: a `BenchJob` on standard input, a `BenchResult` on standard output."""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict
from functools import cache
from typing import NamedTuple

import numpy as np

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.models.engines.names import member_of
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.warm_up import load_kernels
from kerfwise.models.routing import Instance, is_instance, judge_tour, read_instance, solve_instance

from .measure import BenchJob, BenchResult
from .memory import peak_mb


class _Outcome(NamedTuple):
    instance: str
    cost: float | None
    bound: float | None
    proven: bool
    fault: str
    tour: tuple[int | str, ...]
    seconds: float
    processor_s: float


class _Stopwatch:
    """Seconds by the clock, and of processor in all threads, since it was made."""

    def __init__(self) -> None:
        self._clock_s, self._processor_s = time.perf_counter(), time.process_time()

    def read(self) -> tuple[float, float]:
        return time.perf_counter() - self._clock_s, time.process_time() - self._processor_s


def run_in_child(job: BenchJob) -> BenchResult:
    """Run a job in this process."""
    options = SolveOptions(
        seed=job.seed, work=job.work, time_s=job.time_s, member=member_of(job.engine), memory_gb=job.memory_gb
    )
    outcome = _route(job, options) if is_instance(job.path) else _nest(job)
    return BenchResult(
        instance=outcome.instance,
        engine=job.engine,
        cost=outcome.cost,
        bound=outcome.bound,
        proven=outcome.proven,
        feasible=outcome.cost is not None and not outcome.fault,
        seconds=round(outcome.seconds, 3),
        memory_mb=round(peak_mb(), 1),
        tour=outcome.tour,
        fault=outcome.fault,
        processor_s=round(outcome.processor_s, 3),
    )


def _route(job: BenchJob, options: SolveOptions) -> _Outcome:
    instance = read_instance(job.path)
    _load_kernels(options)
    spent = _Stopwatch()
    try:
        answer = solve_instance(instance, options)
    except InputError as error:
        raise InputError(error.message, file=job.path) from None
    taken = spent.read()
    if answer.cost is None:
        fault = "no tour keeps the orders" if answer.infeasible else "no tour was found"
        return _Outcome(instance.name, None, answer.bound, answer.proven, fault, (), *taken)
    cost, fault = judge_tour(instance, answer.tour)
    if not fault and cost != answer.cost:
        fault = f"the engine says the tour costs {answer.cost}"
    return _Outcome(instance.name, cost, answer.bound, answer.proven, fault, answer.tour, *taken)


@cache
def _load_kernels(options: SolveOptions) -> None:
    """Solve something small with every engine that has kernels, so that they are loaded when the clock starts."""
    load_kernels(_small().problem)
    solve_instance(_small(), options)


def _small() -> Instance:
    cost = np.arange(36, dtype=np.int64).reshape(6, 6) % 7
    return Instance("small", cost, ((0,), (1, 2), (3,), (4,), (5,)), np.array([[0, 1], [1, 2]]), start=0, closed=True)


def _nest(job: BenchJob) -> _Outcome:
    from pathlib import Path

    from kerfwise.encoder.readers import read_nest
    from kerfwise.jobs.ask import ask, facts_of
    from kerfwise.jobs.produce import produce
    from kerfwise.jobs.solve_options import options_for
    from kerfwise.rules.profile.load import load_profile

    profile = load_profile(job.profile, trust=job.trust) if job.profile else load_profile()
    nest = read_nest(job.path, profile.read_options())
    limits = options_for(
        nest,
        profile,
        work=job.work,
        seed=job.seed,
        time_s=job.time_s,
        engine=job.engine,
        memory_gb=job.memory_gb,
    )
    load_kernels()
    spent = _Stopwatch()
    try:
        made = produce(ask(facts_of(nest, profile), profile), profile, limits)
    except RulesConflict as conflict:
        return _Outcome(Path(job.path).stem, None, None, False, conflict.message, (), *spent.read())
    taken = spent.read()
    solve = made.plan.solve
    fault = "" if made.verdict.ok else "the check finds hard rules broken"
    tour = tuple(planned.cut.contour for planned in made.plan.cuts)
    proven = solve.status == "optimal"
    return _Outcome(Path(job.path).stem, solve.objective, solve.bound, proven, fault, tour, *taken)


if __name__ == "__main__":
    try:
        print(json.dumps(asdict(run_in_child(BenchJob(**json.load(sys.stdin))))))
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
