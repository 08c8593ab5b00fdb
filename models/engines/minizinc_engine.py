"""Solves the model by a MiniZinc solver, and puts MiniZinc's answers and errors into kerfwise's words."""

from __future__ import annotations

import asyncio
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import timedelta
from typing import TYPE_CHECKING, Any

from kerfwise.encoder.errors import InputError, RulesConflict
from kerfwise.encoder.facts.facts import Facts
from kerfwise.encoder.files import is_there
from kerfwise.encoder.geometry.tolerances import UM_PER_MM
from kerfwise.models.engines.tuning import MOST_MOVES, NODES_PER_S, POLL_S
from kerfwise.rules.minizinc.installation import driver, solver_named, unusable
from kerfwise.rules.profile.active_rules import ActiveRules
from kerfwise.rules.statements import EXEMPTION_MM, Statement
from kerfwise.rules.stating.state_rules import Stated

from .deadline import Progress
from .minizinc_model import condition_arrays, data_text, model_text
from .solution import Solution, SolveOptions

if TYPE_CHECKING:
    from minizinc import Instance, Solver

    from .solve import Refine

__all__ = ["solve_minizinc"]

NONE_FOUND = "no plan that meets every hard rule was found within the limit (none is proven impossible)"


def solve_minizinc(
    facts: Facts,
    profile: ActiveRules,
    stated: Stated,
    options: SolveOptions,
    solver: str = "gecode",
    refine: Refine | None = None,
    progress: Progress | None = None,
) -> Solution:
    """The best route that a MiniZinc solver finds within the limit, by the rule files over facts.

    `stated` tells what was dropped of cycles and what rules without a file ask; `refine` answers a whole order (contour
    numbers) with statements that geometry has now shown to be missing, as in `models.solve`. The limit is wall-clock
    time: `options.time_s`, else as many seconds as `options.work`; `progress` may end it sooner. The status is optimal
    only where the solver says so; there is no bound otherwise. Raises InputError if MiniZinc or the solver is not
    installed, the nest is too large for it, or there is a mistake in one of the plant's own rule files; RulesConflict
    if no lawful plan exists, or none was found within the limit (the message says which).
    """
    started = time.monotonic()
    limit = options.work if options.time_s is None else options.time_s
    chosen = solver_named(solver)
    _expect_small(facts)
    afterwards: tuple[Statement, ...] = ()
    nodes = 0
    while True:
        left = limit - (time.monotonic() - started)
        if left <= 0:
            raise RulesConflict(NONE_FOUND, tuple(s.about.sentence for s in afterwards))
        arrays = condition_arrays(profile, stated, afterwards)
        data = data_text(facts, profile, stated, options, clock=any(a.most_ms for a in arrays))
        answer = _run(chosen, model_text(arrays) + data, left, progress)
        nodes += answer.nodes
        route = tuple(c - 1 for c in answer.best.stop if c > 0)
        missing = () if refine is None else refine(tuple(facts.candidates[c].contour for c in route))
        if not missing or answer.interrupted:
            break
        afterwards += missing
    objective = answer.best.besides / UM_PER_MM + answer.best.excuses * EXEMPTION_MM
    name = f"minizinc:{solver}"
    return Solution(
        route=route,
        objective=objective,
        bound=objective if answer.proven else None,
        status="optimal" if answer.proven else "feasible",
        found_by=name,
        proved_by=name if answer.proven else "",
        seconds=nodes / NODES_PER_S if options.time_s is None else time.monotonic() - started,
    )


def _expect_small(facts: Facts) -> None:
    ways = len(facts.candidates)
    if ways * ways > MOST_MOVES:
        raise InputError(
            f"the nest has {ways:,} ways to cut its {facts.n:,} contours, {ways * ways:,} moves from one to another; "
            f"the engine minizinc takes {MOST_MOVES:,} at the most: take another engine, or fewer leads.entries"
        )


@dataclass(slots=True)
class _Said:
    """What a solver has said so far."""

    best: Any = None
    proven: bool = False
    infeasible: bool = False
    nodes: int = 0
    interrupted: bool = False


def _run(solver: Solver, text: str, limit_s: float, progress: Progress | None) -> _Said:
    """What the solver makes of a model with its data; there is a solution in it."""
    from minizinc import Instance

    with clear_errors():
        instance = Instance(solver, driver=driver())
        instance.add_string(text)
        answer = asyncio.run(_listened(instance, limit_s, progress))
    if answer.infeasible:
        raise RulesConflict("no plan meets every hard rule")
    if answer.best is None and answer.interrupted:
        raise KeyboardInterrupt
    if answer.best is None:
        raise RulesConflict(NONE_FOUND)
    return answer


async def _listened(instance: Instance, limit_s: float, progress: Progress | None) -> _Said:
    """All that the solver says until it ends, or is ended because whoever listens has had enough."""
    from minizinc import Status

    heard = _Said()

    async def listen() -> None:
        limit = timedelta(seconds=limit_s)
        async for result in instance.solutions(time_limit=limit, intermediate_solutions=True):
            heard.best = result.solution or heard.best
            heard.proven = result.status is Status.OPTIMAL_SOLUTION
            heard.infeasible = result.status is Status.UNSATISFIABLE
            heard.nodes = max(heard.nodes, int(result.statistics.get("nodes", 0)))

    solving = asyncio.create_task(listen())
    while not (await asyncio.wait({solving}, timeout=POLL_S))[0]:
        if progress is not None and not progress("minizinc", None, None):
            heard.interrupted = True
            solving.cancel()
    with suppress(asyncio.CancelledError):
        await solving
    return heard


@contextmanager
def clear_errors() -> Iterator[None]:
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
        if place is None or place.file is None or not is_there(place.file):  # in text that kerfwise wrote itself
            raise InputError(message) from None
        raise InputError(message, file=place.file, line=place.lines[0], column=place.columns[0]) from None
    except OSError as error:  # it has gone since it was asked
        raise unusable(str(driver().executable), f"it cannot be started ({error.strerror or error})") from None
