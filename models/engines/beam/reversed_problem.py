"""The same problem from the end to the start: some are far easier to prove that way round."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kerfwise.models.problem.conditions import Condition
from kerfwise.models.problem.problem import Problem


def can_reverse(problem: Problem) -> bool:
    """Whether it can be said backwards.

    Crossings ask what is already out, not what is still in; a link saves a pierce that must be paid for before it.
    """
    return not len(problem.crossings) and not len(problem.links)


def reversed_problem(problem: Problem) -> Problem:
    """A problem whose routes are those of the given one backwards, at the same cost.

    It `applies` to the beam, and can turn.
    """
    return replace(
        problem,
        pierce_um=problem.end_um,
        end_um=problem.pierce_um,
        before=np.ascontiguousarray(problem.before.T),
        conditions=tuple(_reversed(condition) for condition in problem.conditions),
        matrix=None if problem.matrix is None else np.ascontiguousarray(problem.matrix.T),
    )


def _reversed(condition: Condition) -> Condition:
    """Who is out before the contour one way is not out the other way, and the contour itself never is."""
    pairs = [(k, w) for k, w in zip(condition.members, condition.weights, strict=True) if k != condition.contour]
    return replace(
        condition,
        members=tuple(k for k, _ in pairs),
        weights=tuple(-w for _, w in pairs),
        bound=condition.bound - sum(w for _, w in pairs),
    )
