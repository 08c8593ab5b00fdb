"""Solves the model by a MiniZinc solver, and puts MiniZinc's answers and errors into kerfwise's words."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING

from ...encoder.errors import InputError, RulesConflict
from ...encoder.facts.facts import Facts
from ...rules.profile import Profile
from ...rules.state import Stated
from ...rules.statements import EXEMPTION_MM, Statement
from ..problem import UM_PER_MM
from ..solution import Solution, SolveOptions
from .asked import asked
from .data import data_text
from .installation import driver, solver_named
from .model_text import model_text

if TYPE_CHECKING:
    from minizinc import Result, Solver

Refine = Callable[[tuple[int, ...]], tuple[Statement, ...]]
NODES_PER_S = 100_000
"""Search nodes that count as a second of deterministic work."""
NONE_FOUND = "no plan that meets every hard rule was found within the limit (none is proven impossible)"


def solve_minizinc(
    facts: Facts,
    profile: Profile,
    stated: Stated,
    options: SolveOptions,
    solver: str = "gecode",
    refine: Refine | None = None,
) -> Solution:
    """The best route that a MiniZinc solver finds within the limit, by the rule files over facts.

    `stated` tells what was dropped of cycles and what rules without a file ask; `refine` answers a whole order (contour
    numbers) with statements that geometry has now shown to be missing, as in `models.solve`. The limit is wall-clock
    time: `options.time_s`, else as many seconds as `options.work`. The status is optimal only where the solver says
    so; there is no bound otherwise.

    Raises
    ------
    InputError
        If MiniZinc or the solver is not installed, or there is a mistake in one of the plant's own rule files.
    RulesConflict
        If no lawful plan exists, or none was found within the limit (the message says which).
    """
    started = time.monotonic()
    limit = options.work if options.time_s is None else options.time_s
    chosen = solver_named(solver)
    afterwards: tuple[Statement, ...] = ()
    nodes = 0
    while True:
        left = limit - (time.monotonic() - started)
        if left <= 0:
            raise RulesConflict(NONE_FOUND, tuple(s.about.sentence for s in afterwards))
        arrays = asked(profile, stated, afterwards)
        data = data_text(facts, profile, stated, options, clock=any(a.most_ms for a in arrays))
        result = _run(chosen, model_text(arrays) + data, left)
        nodes += int(result.statistics.get("nodes", 0))
        route = tuple(c - 1 for c in result.solution.stop if c > 0)
        missing = () if refine is None else refine(tuple(facts.candidates[c].contour for c in route))
        if not missing:
            break
        afterwards += missing
    proven = str(result.status) == "OPTIMAL_SOLUTION"
    objective = result.solution.besides / UM_PER_MM + result.solution.excuses * EXEMPTION_MM
    name = f"minizinc:{solver}"
    return Solution(
        route=route,
        objective=objective,
        bound=objective if proven else None,
        status="optimal" if proven else "feasible",
        found_by=name,
        proved_by=name if proven else "",
        seconds=nodes / NODES_PER_S if options.time_s is None else time.monotonic() - started,
    )


def _run(solver: Solver, text: str, limit_s: float) -> Result:
    """What the solver makes of a model with its data; the result has a solution."""
    from minizinc import Instance, Status

    with _clear_errors():
        instance = Instance(solver, driver=driver())
        instance.add_string(text)
        result = instance.solve(time_limit=timedelta(seconds=limit_s))
    if result.status is Status.UNSATISFIABLE:
        raise RulesConflict("no plan meets every hard rule")
    if result.solution is None:
        raise RulesConflict(NONE_FOUND)
    return result


@contextmanager
def _clear_errors() -> Iterator[None]:
    """Turn an error of MiniZinc into one message with the file and line that MiniZinc gives."""
    from minizinc import MiniZincError
    from minizinc.error import MiniZincWarning

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MiniZincWarning)
            yield
    except MiniZincError as error:
        place = error.location
        message = f"MiniZinc: {str(error).strip()}"
        if place is None or place.file is None or not Path(place.file).exists():  # in text that kerfwise wrote itself
            raise InputError(message) from None
        raise InputError(message, file=place.file, line=place.lines[0], column=place.columns[0]) from None
