"""What statements come to before candidates become sites: hard orders as pairs, conditions, and what no condition says.

A round of a solve asks for those of the round before and a few more, so that only these are worked out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from operator import is_
from typing import assert_never

import numpy as np

from kerfwise.arrays import Ints
from kerfwise.encoder.geometry.microns import cost_um
from kerfwise.rules.statements import (
    AtLeast,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    NoGood,
    Precede,
    Statement,
)

from .conditions import Condition, of_at_least, of_no_good, of_soft_precede


def _no_pairs() -> Ints:
    return np.empty((0, 2), dtype=np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class Translated:
    """Statements and what they come to: `pairs` (k, 2) of contours of which the first is hard before the second.

    In `conditions`, `when` is a candidate. Other kinds of statements are fields of a problem of their own.
    """

    statements: tuple[Statement, ...] = ()
    pairs: Ints = field(default_factory=_no_pairs)
    conditions: tuple[Condition, ...] = ()
    general: tuple[AtLeast, ...] = ()


def begin_with(statements: tuple[Statement, ...], known: tuple[Statement, ...]) -> bool:
    """Whether they begin with the very statements that are known."""
    return len(statements) >= len(known) and all(map(is_, known, statements))


def translated(statements: tuple[Statement, ...], contour_of: Sequence[int], earlier: Translated) -> Translated:
    """What statements come to; where they begin with those of an `earlier` answer, that is taken over.

    `contour_of` maps candidates to contours, the same ones as for the earlier answer.
    """
    if not begin_with(statements, earlier.statements):
        earlier = Translated()
    before: list[int] = []
    after: list[int] = []
    conditions: list[Condition] = []
    general: list[AtLeast] = []
    for s in statements[len(earlier.statements) :]:
        match s:
            case Precede():
                if s.weight is None:
                    before.append(s.before)
                    after.append(s.after)
                else:
                    conditions.append(of_soft_precede(s, cost_um(s.weight)))
            case NoGood():
                conditions.extend(of_no_good(s, None if s.weight is None else cost_um(s.weight)))
            case AtLeast():
                made = of_at_least(s, contour_of, None if s.weight is None else cost_um(s.weight))
                if made is None:
                    general.append(s)
                else:
                    conditions.append(made)
            case Forbid() | Contiguous() | Lag() | Crossing() | IdleTravel() | Link():
                pass  # `make_problem` reads them
            case _:
                assert_never(s)
    return Translated(
        statements,
        np.concatenate([earlier.pairs, np.array([before, after], dtype=np.int64).T.reshape(-1, 2)]),
        (*earlier.conditions, *conditions),
        (*earlier.general, *general),
    )
