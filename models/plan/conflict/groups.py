"""Hard statements as a planner sees them, and sets of them made fewer by asking a solver again and again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import assert_never

from ortools.sat.python.cp_model import CpSolver

from kerfwise.encoder.facts.facts import Facts
from kerfwise.models.engines.deadline import Deadline
from kerfwise.rules.registry import RULES
from kerfwise.rules.statements import (
    About,
    AtLeast,
    Contiguous,
    Crossing,
    Forbid,
    IdleTravel,
    Lag,
    Link,
    Move,
    NoGood,
    Precede,
    Statement,
    by_kind,
    candidates_named,
    contours_named,
)
from kerfwise.rules.stating.feasible_order import ends_of, quiet_solver

# Hard statements as a planner sees them: those with the same rule, contours and sentence are one.

CanClash = Precede | Forbid | AtLeast | Contiguous | Crossing | Lag | NoGood | Move


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
            case Precede() | Forbid() | AtLeast() | Contiguous() | Crossing() | Lag() | NoGood() | Move():
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


def order_groups(groups: Iterable[Group]) -> list[Group]:
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


# The groups about what an operator has locked: a few, among which most contradictions of entries and runs lie.

LAST = frozenset(name for name, rule in RULES.items() if rule.relaxed_last)
"""Rules that give way only where all others together do not help, such as locks."""


def suspects(facts: Facts, groups: Sequence[Group]) -> list[int]:
    """Numbers of the groups that are about locked contours, and about what is cut in one go with them, only.

    A place is about the contour that it is asked of, and about no other. Empty where nothing is locked.
    """
    contour_of = [c.contour for c in facts.candidates]
    of_contours = [_about(facts, group, contour_of) for group in groups]
    locked = {k for group, of in zip(groups, of_contours, strict=True) if group.about.rule in LAST for k in of}
    runs = [set(s.contours) for s in by_kind(s for group in groups for s in group.statements).contiguous]
    near = locked.union(*(run for run in runs if run & locked))
    return [k for k, of in enumerate(of_contours) if of and of <= near]


def _about(facts: Facts, group: Group, contour_of: Sequence[int]) -> set[int]:
    ends = [ends_of(s, facts.n) for s in by_kind(group.statements).at_least]
    if ends and all(ends):
        return {found[0][0] for found in ends}
    return contours_of(group, contour_of)


# CP-SAT as the look for contradictions asks it: small questions, under one deadline for all of them.

DEFAULT_WORK = 200.0
"""Work for all of them, where nobody says how much."""
WORK_PER_STATEMENT = 2e-5
"""What putting a statement to CP-SAT counts for, beside the work of CP-SAT itself."""


class NotAnswered(Exception):
    """The question was too hard for the work allowed."""


class NothingLeft(NotAnswered):
    """No question is answered any more: all work, or time, is spent."""


def solver_within(deadline: Deadline, most: float) -> CpSolver:
    """A solver that stops when `most` work, or what is left, is done. Raises NothingLeft if nothing is left."""
    if deadline.left <= 0:
        raise NothingLeft
    solver = quiet_solver(most)
    if deadline.timed:
        solver.parameters.max_time_in_seconds = deadline.left
    else:
        solver.parameters.max_deterministic_time = min(most, deadline.left)
    return solver


# Groups that cannot all hold made fewer, by asking again and again whether what is left still cannot.

Clash = Callable[[Sequence[Group]], list[int] | None]
"""Numbers of groups that cannot all hold, None if all can; raises NotAnswered where neither is shown."""


def in_time(clash: Clash, deadline: Deadline, paces_s: list[float]) -> Clash:
    """The same, but no question is begun that takes longer than there are seconds left, by the pace of those before.

    Its model alone takes so long: a solver that is told how long it may go on is told too late. `paces_s` are the
    seconds that each took for a group; questions of several kinds may share them.
    """

    def asked(groups: Sequence[Group]) -> list[int] | None:
        had = deadline.left
        if deadline.timed and had < max(paces_s, default=0.0) * len(groups):
            raise NothingLeft
        try:
            return clash(groups)
        finally:
            paces_s.append((had - deadline.left) / max(1, len(groups)))

    return asked


def drop_unneeded_rules(core: list[Group], gives_way: Mapping[str, int], clash: Clash) -> list[Group]:
    """Groups that clash still, without those of every rule that has no part in it, as far as could be answered.

    Rules that give way are left out first, then those that come last among all: what is said of a conflict should be
    firm.
    """
    rules = dict.fromkeys(group.about.rule for group in reversed(core))
    for rule in sorted(rules, key=lambda rule: -gives_way.get(rule, 0)):
        without = [group for group in core if group.about.rule != rule]
        try:
            if clash(without) is not None:
                core = without
        except NothingLeft:
            break
        except NotAnswered:
            continue  # shrinking asks again, of less at a time
    return core


def shrink(core: list[Group], clash: Clash) -> tuple[list[Group], bool]:
    """Groups out of `core` that clash still, and whether none of them can be left out, as far as could be answered."""
    minimal = True
    size = max(1, len(core) // 2)
    while True:
        k = 0
        while k < len(core):
            try:
                left = clash(core[:k] + core[k + size :])
            except NothingLeft:
                return core, False
            except NotAnswered:
                left, minimal = None, minimal and size > 1
            if left is None:
                k += size
                continue
            kept = [m if m < k else m + size for m in left]
            k = sum(m < k for m in kept)
            core = [core[m] for m in kept]
        if size == 1:
            return core, minimal
        size //= 2
