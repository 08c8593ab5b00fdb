"""The table of docs/architecture.md: each kind of statement, what it becomes, and what each engine does with it alone.

Nothing in it is written by hand: each example of `tests/models/every_kind.py` is compiled and given to every engine.
`python -m kerfwise.tests.docs.statement_table` prints it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

import numpy as np

from kerfwise import InputError, RulesConflict
from kerfwise.models.engines import ENGINES, Engine, member_of
from kerfwise.models.engines.minizinc_engine import solve_minizinc
from kerfwise.models.engines.solution import SolveOptions
from kerfwise.models.engines.solve import solve
from kerfwise.models.problem.compile import make_problem
from kerfwise.rules.stating.state_rules import Stated
from kerfwise.tests.models.every_kind import FEEDS, HOME, NEAR_MM, PARTS, PROFILE, Example, examples, way_of
from kerfwise.tests.models.plan.conflict.statements import row

PROVES, FINDS, NOT_ALONE, REFUSES = "proves", "finds", "–", "refuses"
FACTS = row(PARTS)
OF_SITES = {"first", "site_contour", "candidate_site", "pierce_um", "end_um", "pace"}
"""Fields of a problem that only follow from its sites."""
OF_STATEMENTS = {"told"}
"""What any statement comes to, kept for the next round: no form of its own."""


def table() -> str:
    """The table in Markdown."""
    rows = [["statement", "example", "held in `Problem` as", *(f"`{engine}`" for engine in ENGINES)]]
    for hard, soft in _pairs():
        some = hard or soft
        cells = []
        for engine in ENGINES:
            found = list(dict.fromkeys(answer(example, engine) for example in (hard, soft) if example))
            cells.append(", soft: ".join(found))
        rows.append([f"`{type(some.statement).__name__}`", some.name, _held_as(hard, soft), *cells])
    lines = [f"| {' | '.join(cells)} |" for cells in rows]
    return "\n".join([lines[0], f"|{'---|' * len(rows[0])}", *lines[1:]]) + "\n"


def answer(example: Example, engine: Engine) -> str:
    """What an engine does with an example: proves the best plan, finds it, has no answer of its own, or refuses.

    A plan that is worse, or that breaks the statement, and is called the best all the same is an AssertionError.
    """
    try:
        if engine == "minizinc":
            options = SolveOptions(work=20.0, home_mm=HOME, feeds=FEEDS)
            found = solve_minizinc(FACTS, PROFILE, Stated(example.statements, ()), options)
        else:
            options = SolveOptions(work=0.1, home_mm=HOME, feeds=FEEDS, member=member_of(engine))
            found = solve(FACTS, example.statements, options)
    except InputError:
        return REFUSES
    except RulesConflict:
        return NOT_ALONE
    best = abs(found.objective - example.best_mm) < NEAR_MM
    kept = abs(found.objective - example.price_mm(way_of(FACTS, found.route))) < NEAR_MM
    assert kept, f"{engine} ignores {example}"
    if found.status == "optimal":
        assert best, f"{engine} calls a plan the best that is not: {example}"
        return PROVES
    return FINDS if best else NOT_ALONE


def _pairs() -> Iterator[tuple[Example, Example | None] | tuple[None, Example]]:
    """Each example as (hard, soft)."""
    hard = {example.name: example for example in examples() if example.hard}
    soft = {example.name: example for example in examples() if not example.hard}
    for name, example in hard.items():
        yield example, soft.get(name)
    for name, example in soft.items():
        if name not in hard:
            yield None, example


def _held_as(hard: Example | None, soft: Example | None) -> str:
    by_hard, by_soft = _fields(hard), _fields(soft)
    if hard is None or soft is None or by_hard == by_soft:
        return by_hard or by_soft
    return f"{by_hard}; soft: {by_soft}"


def _fields(example: Example | None) -> str:
    """The fields of the problem that the statement changes."""
    if example is None:
        return ""
    with_it = make_problem(FACTS, example.statements, HOME, FEEDS)
    without = make_problem(FACTS, example.others, HOME, FEEDS)
    changed = [f.name for f in fields(with_it) if _differ(getattr(with_it, f.name), getattr(without, f.name))]
    return ", ".join(f"`{name}`" for name in changed if name not in OF_SITES | OF_STATEMENTS)


def _differ(one: object, other: object) -> bool:
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return not np.array_equal(one, other)
    if hasattr(one, "__dataclass_fields__"):
        return any(_differ(getattr(one, name), getattr(other, name)) for name in one.__dataclass_fields__)
    return bool(one != other)


if __name__ == "__main__":
    print(table(), end="")
