"""The process that runs one engine on one file: a `BenchJob` on standard input, a `BenchResult` on standard output."""

from __future__ import annotations

import contextlib
import json
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, replace
from functools import cache

import numpy as np

from kerfwise.encoder.candidates import build_candidates
from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts import compute_facts
from kerfwise.encoder.geometry.curve import Curve
from kerfwise.encoder.geometry.segment import Point
from kerfwise.encoder.nest import Contour, Kind, Nest, Part, Sheet
from kerfwise.models.engines import ideals, member_of
from kerfwise.models.engines.bounds import flow_bound
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.ideals.lattice import TooLarge, sweeping
from kerfwise.models.engines.ideals.priced import price
from kerfwise.models.engines.portfolio import run_portfolio
from kerfwise.models.engines.solution import Incumbent, SolveOptions
from kerfwise.models.jit import take_plainly
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.crossings import Crossings
from kerfwise.models.problem.problem import Problem
from kerfwise.models.routing import Instance, is_instance, judge_tour, read_instance, solve_instance
from kerfwise.rules.profile.load import load_profile
from kerfwise.rules.stating.state_rules import state_rules

from .bench import BenchJob, BenchResult

# The most memory that this process has held, on every system.

if sys.platform == "win32":
    import ctypes
    from ctypes import wintypes

    class _Counters(ctypes.Structure):
        """PROCESS_MEMORY_COUNTERS of the Windows API, bytes."""

        _fields_ = (
            ("cb", wintypes.DWORD),
            ("PageFaultCount", wintypes.DWORD),
            ("PeakWorkingSetSize", ctypes.c_size_t),
            ("WorkingSetSize", ctypes.c_size_t),
            ("QuotaPeakPagedPoolUsage", ctypes.c_size_t),
            ("QuotaPagedPoolUsage", ctypes.c_size_t),
            ("QuotaPeakNonPagedPoolUsage", ctypes.c_size_t),
            ("QuotaNonPagedPoolUsage", ctypes.c_size_t),
            ("PagefileUsage", ctypes.c_size_t),
            ("PeakPagefileUsage", ctypes.c_size_t),
        )

    def _peak_bytes() -> int:
        counters = _Counters(cb=ctypes.sizeof(_Counters))
        kernel = ctypes.WinDLL("kernel32")
        kernel.GetCurrentProcess.restype = wintypes.HANDLE
        ask = kernel.K32GetProcessMemoryInfo
        ask.argtypes = (wintypes.HANDLE, ctypes.POINTER(_Counters), wintypes.DWORD)
        ask(kernel.GetCurrentProcess(), ctypes.byref(counters), counters.cb)
        return int(counters.PeakWorkingSetSize)

else:
    import resource

    def _peak_bytes() -> int:
        """Linux keeps in `ru_maxrss` what the process held that began this one; `VmHWM` is of this one alone."""
        if sys.platform == "linux":
            with contextlib.suppress(OSError, StopIteration), open("/proc/self/status", encoding="ascii") as status:
                return int(next(line for line in status if line.startswith("VmHWM:")).split()[1]) * 1024
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return peak if sys.platform == "darwin" else peak * 1024


def peak_mb() -> float:
    """The peak of what this process has held in memory so far, MB of 1024 × 1024 bytes.

    Examples
    --------
    >>> 1 < peak_mb() < 1_000_000
    True
    """
    return _peak_bytes() / (1024 * 1024)


# Kernels are loaded, or compiled where that was never done, before something is measured.
#
# A limit in seconds needs none of this: its clock stands still meanwhile (`kernels.running_s`).

LOADING_S = 0.05
DEAR_UM = 1 << 40
"""Costs as high as those of plans with excuses are swept by kernels for wider numbers."""


def load_kernels(problem: Problem | None = None) -> None:
    """Let every engine that has kernels look at a small problem, a nest's by the default profile if none is given.

    Takes half a second; the first time after kerfwise was installed, the better part of a minute.
    """
    take_plainly(0)
    problem = problem or _problem()
    found = run_portfolio(problem, SolveOptions(work=LOADING_S, member="search")).incumbent
    assert found is not None
    dear = Incumbent(found.route, found.cost + DEAR_UM)
    for known, stages in ((None, ()), (found, ()), (found, ideals.STAGES), (dear, ()), (dear, ideals.STAGES)):
        ideals.prove(problem, known, Deadline(LOADING_S), stages)
    flow_bound(problem, found, Deadline(LOADING_S))
    _load_priced(problem, found)


def _load_priced(problem: Problem, found: Incumbent) -> None:
    """The sweeps by multipliers of linear programs, which hold no crossings and no groups."""
    bare = replace(problem, crossings=Crossings(), soft_groups=(), general=())
    stretches = price(bare, found, Deadline(LOADING_S))
    if stretches is None:
        return
    with ThreadPoolExecutor(1) as thread:
        for limit in (found.cost, found.cost + DEAR_UM):
            with suppress(TooLarge):
                stretches.sweep(limit, sweeping(Deadline(), LOADING_S), thread)


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
    name, cost, bound, proven, fault, tour, taken = _route(job, options) if is_instance(job.path) else _nest(job)
    seconds, processor_s = (round(s, 3) for s in taken)
    feasible, memory_mb = cost is not None and not fault, round(peak_mb(), 1)
    return BenchResult(name, job.engine, cost, bound, proven, feasible, seconds, memory_mb, tour, fault, processor_s)


_Outcome = tuple[str, float | None, float | None, bool, str, tuple[int | str, ...], tuple[float, float]]
"""Name, cost, bound, whether it is proven, fault, tour, and seconds by the clock and of processor."""


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
        return instance.name, None, answer.bound, answer.proven, fault, (), taken
    cost, fault = judge_tour(instance, answer.tour)
    if not fault and cost != answer.cost:
        fault = f"the engine says the tour costs {answer.cost}"
    return instance.name, cost, answer.bound, answer.proven, fault, answer.tour, taken


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
    from kerfwise.jobs.request import facts_of, make_request, options_for
    from kerfwise.pipeline import solve_and_verify

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
        verified = solve_and_verify(make_request(facts_of(nest, profile), profile), profile, limits)
    except RulesConflict as conflict:
        return Path(job.path).stem, None, None, False, conflict.message, (), spent.read()
    taken = spent.read()
    solve = verified.plan.solve
    fault = "" if verified.verdict.ok else "the check finds hard rules broken"
    tour = tuple(planned.cut.contour for planned in verified.plan.cuts)
    proven = solve.status == "optimal"
    return Path(job.path).stem, solve.objective, solve.bound, proven, fault, tour, taken


if __name__ == "__main__":
    try:
        print(json.dumps(asdict(run_in_child(BenchJob(**json.load(sys.stdin))))))
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
