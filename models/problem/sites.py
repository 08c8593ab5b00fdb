"""Candidates become sites: those of a contour that nothing tells apart, with the same pierce and end, are one."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from kerfwise.arrays import Bools, Floats, Ints
from kerfwise.encoder.candidates.candidate import Candidate
from kerfwise.rules.statements import AtLeast, Link, Pick, plain

from .conditions import Condition


def sites_of(
    candidates: Sequence[Candidate],
    allowed: Bools,
    costs: Ints,
    conditions: Sequence[Condition],
    general: Sequence[AtLeast],
    links: Sequence[Link] = (),
) -> tuple[Ints, Ints]:
    """The site of every candidate, -1 of one that is not `allowed`, and the candidate that each site stands for.

    A site stands for the first of its candidates, and sites are numbered as these are. `costs` are what candidates
    cost by themselves; the rest are the statements that may be about single candidates.
    """
    leader, lawful = np.arange(len(candidates)), np.flatnonzero(allowed).tolist()
    if alike := [lawful[k] for k in in_one_place(_places([candidates[c] for c in lawful]))]:
        told_apart = _told_apart(frozenset(alike), conditions, general, links)
        first: dict[object, int] = {}
        for number in alike:
            candidate = candidates[number]
            asked = (int(costs[number]), *told_apart[number])
            leader[number] = first.setdefault((candidate.contour, candidate.pierce, candidate.end, asked), number)
    leads = allowed & (leader == np.arange(len(candidates)))
    site = np.cumsum(leads) - 1
    return np.where(allowed, site[leader], -1), np.flatnonzero(leads)


def in_one_place(columns: Sequence[Ints | Floats]) -> list[int]:
    """The rows that are in all columns (k,) like some other row, in rising order.

    Examples
    --------
    >>> in_one_place([np.array([1, 2, 1, 1]), np.array([5, 5, 5, 6])])
    [0, 2]
    """
    order = np.lexsort(columns)
    same = np.ones(max(len(order) - 1, 0), dtype=np.bool_)
    for column in columns:
        same &= column[order[1:]] == column[order[:-1]]
    shared = np.append(False, same) | np.append(same, False) if len(order) else same
    found: list[int] = np.sort(order[shared]).tolist()
    return found


def _places(candidates: Sequence[Candidate]) -> list[Ints | Floats]:
    """Contours, pierces and ends."""
    ends = ([c.pierce for c in candidates], [c.end for c in candidates])
    contours = np.array([c.contour for c in candidates], dtype=np.int64)
    return [contours, *(axis for points in ends for axis in np.array(points, dtype=np.float64).reshape(-1, 2).T)]


def _told_apart(
    asked: frozenset[int], conditions: Sequence[Condition], general: Sequence[AtLeast], links: Sequence[Link]
) -> dict[int, list[object]]:
    """What is said of each of these candidates."""
    found: dict[int, list[object]] = defaultdict(list)
    for condition in conditions:
        if condition.when in asked:
            found[condition.when].append((condition.members, condition.weights, condition.bound, condition.cost))
    for number, s in enumerate(general):
        for c in asked & ({lit.c for lit in plain(s.literals) if isinstance(lit, Pick)} | {s.when}):
            found[c].append(number)
    for number, link in enumerate(links):
        for end, ends in (("leave", link.leave), ("reach", link.reach)):
            for c in ends:
                if c in asked:
                    found[c].append((end, number))
    return found
