"""Runs CP-SAT so that it can be watched and stopped, and so that the same model gives the same answer."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass

from ortools.sat.python.cp_model import CpModel, CpSolver, CpSolverSolutionCallback, CpSolverStatus

from kerfwise.models.engines.solution import Progress, SolveOptions

ENGINE = "cp-sat"
POLL_S = 0.1


@dataclass(frozen=True, eq=False, slots=True)
class CpsatRun:
    """A finished run; `interrupted` says that Ctrl-C ended it."""

    solver: CpSolver
    status: CpSolverStatus
    interrupted: bool

    @property
    def work(self) -> float:
        """Deterministic seconds that it took."""
        return float(self.solver.response_proto.deterministic_time)


def run_solver(model: CpModel, options: SolveOptions, progress: Progress) -> CpsatRun:
    """Solve until proven, out of work, told to stop by `progress`, or interrupted; what was found is kept.

    The solver runs in a thread of its own, so that this one can ask `progress` and hear Ctrl-C.
    """
    solver = _solver(options)
    seen = _Seen()
    solver.best_bound_callback = seen.on_bound
    going, interrupted = True, False
    with ThreadPoolExecutor(max_workers=1) as pool:
        running = pool.submit(solver.solve, model, seen)
        while not running.done():
            try:
                wait([running], timeout=POLL_S)
                going = going and progress(ENGINE, seen.cost_um, seen.bound_um)
                if not going:
                    solver.stop_search()  # said again each time: the first may come before the search has begun
            except KeyboardInterrupt:
                going, interrupted = False, True
        return CpsatRun(solver, running.result(), interrupted)


def _solver(options: SolveOptions) -> CpSolver:
    """One worker, so that every run is the same, and linear programs with every cut: by far the fastest proofs here.

    Probing costs more than it finds in these models.
    """
    solver = CpSolver()
    parameters = solver.parameters
    parameters.num_workers = 1
    parameters.random_seed = options.seed
    parameters.linearization_level = 2
    parameters.cp_model_probing_level = 0
    parameters.max_deterministic_time = options.work
    parameters.catch_sigint_signal = False
    return solver


class _Seen(CpSolverSolutionCallback):
    """Notes the best cost and bound seen so far, µm."""

    def __init__(self) -> None:
        super().__init__()
        self.cost_um: int | None = None
        self.bound_um: int | None = None

    def on_solution_callback(self) -> None:
        self.cost_um = round(self.objective_value)

    def on_bound(self, bound: float) -> None:
        self.bound_um = round(bound)
