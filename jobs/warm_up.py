"""Compile what plans need, once for a machine: all of it ahead, for images and batches, or the search beside a plan.

Kernels are kept on disk (`models/numba_cache.py`), by processor, versions and source. A first `solve` of a nest that
the search is needed for has a second process compile that, which is half of the whole, while it works out facts and
sweeps sets itself.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from typing import NamedTuple, cast

from kerfwise.models import jit
from kerfwise.models.engines import ideals
from kerfwise.models.engines.deadline import Deadline
from kerfwise.models.engines.solution import Incumbent
from kerfwise.models.engines.tuning import SEARCHED
from kerfwise.models.engines.tuning import WARM_UP_COLUMNS as COLUMNS
from kerfwise.models.engines.tuning import WARM_UP_FEW as FEW
from kerfwise.models.engines.tuning import WARM_UP_ROWS as ROWS
from kerfwise.models.physics.time_and_cost import feeds_of
from kerfwise.models.problem.compile import make_problem
from kerfwise.models.problem.problem import Problem
from kerfwise.rules.profile.load import load_profile

from .process_beside import Beside, Hear
from .request import facts_of, make_request


class Warmed(NamedTuple):
    """How many kernels were compiled, in how many seconds, and where they are kept, "" for nowhere."""

    kernels: int
    seconds: float
    folder: str


def warm_up() -> Warmed:
    """Compile, or load, all that plans of nests take."""
    jit.take_plainly(0)
    try:
        problem = _problem()
        _sweeps(problem, _search(problem))
    finally:
        jit.take_plainly(jit.PLAIN_STEPS)
    from kerfwise.models.numba_cache import compiled_and_kept

    kernels, folder = compiled_and_kept()
    return Warmed(kernels, jit.compiled_s(), folder)


def _compile_search(_: Hear) -> Iterator[None]:
    """What the process beside a first `solve` does: what else its small problem takes is not compiled for it."""
    warnings.simplefilter("ignore")  # the other one says it
    _search(_problem(FEW, FEW))
    yield None


def search_beside(contours: int) -> None:
    """Have the search compiled by a process beside this one, if it will be needed and is not kept.

    The process ends with this one, and says nothing; what it does not do is done here.
    """
    if contours < SEARCHED or not sys.executable:
        return
    from kerfwise.models.engines.search.anneal import walk
    from kerfwise.models.numba_cache import compiled_beside, is_kept

    kernel = cast(jit.Kernel, walk)
    if is_kept(kernel.dispatcher):
        return
    if (process := Beside(_compile_search).__enter__().process) is not None:
        compiled_beside(kernel.py_func, process.is_alive)


def _problem(columns: int = COLUMNS, rows: int = ROWS) -> Problem:
    """A plate of parts with holes, under the default profile."""
    from kerfwise.rules.case import nest, part, rect

    profile = load_profile()
    parts = (
        part(f"P{rows * x + y}", rect(130 * x + 10, 100 * y + 10, 110, 80), [rect(130 * x + 40, 100 * y + 35, 25, 25)])
        for x in range(columns)
        for y in range(rows)
    )
    plate = nest(130.0 * columns + 20, 100.0 * rows + 20, *parts)
    facts = facts_of(plate, profile)
    stated = make_request(facts, profile).stated
    return make_problem(facts, stated.statements, profile.home_on(facts.nest), feeds_of(profile))


def _search(problem: Problem) -> Incumbent:
    from kerfwise.models.engines.search import Searcher

    searcher = Searcher(problem)
    searcher.run(Deadline(0.01))
    assert searcher.best is not None
    return searcher.best


def _sweeps(problem: Problem, plan: Incumbent) -> None:
    ideals.count_sets(problem, 1e4)
    ideals.prove(problem, plan, Deadline(0.2))
    ideals.widen(problem, plan, Deadline(0.01))
