"""How many cuts lie between two contours, once some are out."""

from __future__ import annotations

from itertools import permutations

import pytest

from kerfwise.rules.statements import About, AtLeast, Before, Enough, Literal, Statement, Steps
from kerfwise.rules.stating.reduced_statements import Remainder, by_orders, remaining_statements

ABOUT = About("r", (), "")
SOME = [Steps(0, 1), Steps(1, 0), Steps(2, 0, -1, 1), Steps(1, 3, 2, 3), Steps(3, 1, -2, 2), Steps(0, 3, -3, -2)]


def holds(literal: Literal | AtLeast, order: tuple[int, ...]) -> bool:
    match literal:
        case Before(i, j):
            return order.index(i) < order.index(j)
        case Steps(i, j, least, most):
            return least <= order.index(j) - order.index(i) <= most
        case Enough() | AtLeast():
            terms = zip(literal.literals, literal.weights, strict=True)
            return sum(weight for of, weight in terms if holds(of, order)) >= literal.bound
    raise AssertionError(literal)


@pytest.mark.parametrize("steps", SOME, ids=str)
def test_steps_are_sums_of_orders(steps: Steps) -> None:
    for order in permutations(range(4)):
        assert holds(by_orders(steps, 4), order) == holds(steps, order)
        assert holds(by_orders(steps, 4, holds=False), order) != holds(steps, order)


@pytest.mark.parametrize("steps", SOME, ids=str)
@pytest.mark.parametrize("weight", [1, -1])
@pytest.mark.parametrize("out", [(1,), (0, 1), (3, 0), (2, 1)], ids=str)
def test_what_is_out_was_cut_before_all_that_is_left(steps: Steps, weight: int, out: tuple[int, ...]) -> None:
    left = [k for k in range(4) if k not in out]
    number = [left.index(k) if k in left else -1 for k in range(4)]
    rest = Remainder(number, {k: place for place, k in enumerate(out)})
    statement = AtLeast((steps, Before(left[0], left[1])), (weight, 2), 2 if weight > 0 else 1, ABOUT)
    stated: list[Statement] = list(remaining_statements([statement], rest))
    for order in permutations(range(len(left))):
        whole = (*out, *(left[k] for k in order))
        assert all(isinstance(s, AtLeast) and holds(s, order) for s in stated) == holds(statement, whole)
