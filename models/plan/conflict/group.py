"""Hard statements as a planner sees them: those with the same rule, contours and sentence are one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import assert_never

from kerfwise.rules.by_kind import by_kind
from kerfwise.rules.named import candidates_named, contours_named
from kerfwise.rules.statements import (
    About,
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

CanClash = Precede | Forbid | AtLeast | Contiguous | Crossing | Lag | NoGood


@dataclass(frozen=True, slots=True)
class Group:
    """Statements that a planner takes for one."""

    about: About
    statements: tuple[CanClash, ...]


def hard_groups(statements: Iterable[Statement]) -> tuple[Group, ...]:
    """The hard statements, grouped, in the order in which they are first met."""
    found: dict[About, list[CanClash]] = {}
    for s in statements:
        match s:
            case Precede() | Forbid() | AtLeast() | Contiguous() | Crossing() | Lag() | NoGood():
                if s.weight is None:
                    found.setdefault(s.about, []).append(s)
            case IdleTravel() | Link():
                pass  # prices: they are never hard
            case _:
                assert_never(s)
    return tuple(Group(about, tuple(members)) for about, members in found.items())


def moves_or_seconds(groups: Iterable[Group]) -> bool:
    """Whether any of them looks at single moves or at the clock: more than an order and its entries can tell."""
    found = by_kind(s for group in groups for s in group.statements)
    return bool(found.crossing) or any(s.seconds > 0 for s in found.lag)


def on_order(groups: Iterable[Group]) -> list[Group]:
    """Those that say something of an order and its entries."""
    known = list(groups)
    if not by_kind(s for group in known for s in group.statements).crossing:
        return known
    return [group for group in known if len(by_kind(group.statements).crossing) < len(group.statements)]


def contours_of(group: Group, contour_of: Sequence[int]) -> set[int]:
    """Numbers of the contours whose place or entry the group is about; `contour_of` maps candidates to contours."""
    of_moves = by_kind(group.statements).crossing
    found: set[int] = set()
    for s in group.statements:
        if s not in of_moves:
            found |= {*contours_named(s), *(contour_of[c] for c in candidates_named(s))}
    return found
